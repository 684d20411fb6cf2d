// Tables of fingers, contacts, sequences and loading data, edited in place.

import { h, render, reset, update } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import { button, choose, faultList, number } from "../parts/forms.js";
import { scaleChoice } from "../parts/scale_ways.js";
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

  /**
   * Cells that change keys of an entry, each named by its words and those of the entry.
   *
   * @param {Edit["kind"]} kind
   * @param {string} key
   * @param {any} one
   */
  cells(kind, key, one, named = key) {
    const set = (name) => (value) => this.change(kind, key, { [name]: value });
    const of = (name, control, needed = true) =>
      h("td", { "data-empty": needed && (one[name] ?? null) === null }, control);
    return {
      set,
      /**
       * @type {(
       *   name: string, words: string, more?: Parameters<typeof number>[0], needed?: boolean
       * ) => any}
       */
      number: (name, words, more, needed = true) => {
        const label = `${words} of ${named}`;
        return of(name, number({ value: one[name], min: 0, label, onset: set(name), ...more }), needed);
      },
      finger: () => {
        const names = workspace.study.fingers.map(({ name }) => name);
        const options = one.finger ? names : [["", "– select –"], ...names];
        return of(
          "finger",
          choose({ value: one.finger ?? "", options, label: `Finger of ${named}`, onset: set("finger") }),
          false,
        );
      },
      scale: () => {
        const { scale: value, scale_words: words } = one;
        return of("scale", scaleChoice({ value, words, label: `Scale of ${named}`, onset: set("scale") }));
      },
    };
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
