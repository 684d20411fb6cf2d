// The name saved with corrections; the browser remembers it.

import { h, render } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { setWho, who } from "../core/workspace.js";
import { button, field, text } from "./forms.js";

export function whoButton() {
  const shown = button("", askName, { kind: "small", title: "Saved with each correction" });
  const show = () => render(shown, h("span.soft", "Corrections by"), h("strong", who() || "…"));
  async function askName() {
    const name = text({ value: who() });
    const body = field("Name or initials", name, { hint: "Saved with each correction." });
    if (await ask("Your name", body, "Save")) setWho(name.value);
    show();
  }
  show();
  return shown;
}
