// Whose corrections these are: asked once, kept by this browser, said with every correction.

import { h, render } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { setWho, who } from "../core/workspace.js";
import { button, field, text } from "./forms.js";

export function whoButton() {
  const shown = button("", askName, { kind: "small", title: "Kept with every correction" });
  const show = () => render(shown, h("span.soft", null, "Corrections by"), h("strong", null, who() || "…"));
  async function askName() {
    const name = text({ value: who() });
    name.addEventListener(
      "keydown",
      (event) => event.key === "Enter" && name.closest("dialog").close("keep"),
    );
    const answer = await ask(
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
