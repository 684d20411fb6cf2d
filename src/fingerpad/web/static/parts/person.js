// The name saved with corrections; the browser remembers it.

import { h, render } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { setWho, who } from "../core/workspace.js";
import { button, field, text } from "./forms.js";

export function whoButton() {
  const shown = button("", askName, { kind: "small", title: "Saved with each correction" });
  const show = () => render(shown, h("span.soft", null, "Corrections by"), h("strong", null, who() || "…"));
  async function askName() {
    const name = text({ value: who() });
    name.addEventListener(
      "keydown",
      (event) => event.key === "Enter" && name.closest("dialog").close("keep"),
    );
    const answer = await ask(
      "Your name",
      field("Name or initials", name, { hint: "Saved with each correction." }),
      [
        ["", "Cancel"],
        ["keep", "Save", "primary"],
      ],
    );
    if (answer === "keep") setWho(name.value);
    show();
  }
  show();
  return shown;
}
