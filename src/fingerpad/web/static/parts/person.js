// Whose corrections these are: asked once, kept by this browser, said with every correction.

import { h, place } from "../core/dom.js";
import { question } from "../core/messages.js";
import { setWho, who } from "../core/workspace.js";
import { button, field, text } from "./forms.js";

export function whoButton() {
  const shown = button("", ask, { kind: "small", title: "Kept with every correction" });
  const show = () => place(shown, h("span.soft", null, "Corrections by"), h("strong", null, who() || "…"));
  async function ask() {
    const name = text({ value: who() });
    name.addEventListener(
      "keydown",
      (event) => event.key === "Enter" && name.closest("dialog").close("keep"),
    );
    const answer = await question(
      "Who corrects?",
      field("Your name or initials", name, { hint: "Stands beside every correction, with the time." }),
      [
        ["", "Cancel"],
        ["keep", "Keep", "primary"],
      ],
    );
    if (answer === "keep") setWho(name.value);
    show();
  }
  show();
  return shown;
}
