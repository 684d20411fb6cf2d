// Tables of fingers, contacts, sequences and loading data, edited in place.

import { h, render, reset, update } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import { button, faultList } from "../parts/forms.js";
import { ContactTable } from "./study_contacts.js";
import { CurveTable } from "./study_curves.js";
import { FingerTable } from "./study_fingers.js";
import { sequenceTable } from "./study_sequences.js";

export class StudyTables {
  constructor() {
    this.problem = h("div");
    this.root = h("div.stack");
    this.fingers = new FingerTable(this);
    this.contacts = new ContactTable(this);
    this.curves = new CurveTable(this);
  }

  draw() {
    const { fingers, observations, sequences, curves } = workspace.study;
    update(
      this.root,
      this.problem,
      this.fingers.draw(fingers),
      this.contacts.draw(observations),
      sequences.length > 0 && sequenceTable(this, sequences),
      this.curves.draw(curves),
    );
  }

  async change(kind, key, set) {
    render(this.problem);
    try {
      await workspace.edit({ kind, key, set });
    } catch (error) {
      reset(this.root);
      this.draw();
      render(this.problem, faultList(error));
      this.problem.scrollIntoView({ block: "nearest" });
    }
  }

  /** A button that removes an entry, once that is confirmed. */
  removal(kind, key, label, words) {
    const remove = async () => {
      const body = h("p", "Its file stays in the study folder.");
      if (await ask(`Remove ${words} from the study?`, body, "Remove", { kind: "bad" }))
        this.change(kind, key, null);
    };
    return button("×", remove, { kind: "icon", label: `Remove ${label}` });
  }
}
