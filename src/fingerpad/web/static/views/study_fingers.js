// The table of fingers: semi-axes, thickness and photographs.

import { h } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import {
  button,
  chip,
  field,
  namePattern,
  number,
  numberIn,
  synthetic,
  text,
  thumbnail,
} from "../parts/forms.js";
import { AXES, missingList, missingOf } from "../parts/missing_fields.js";
import { staleChip } from "../parts/notes.js";
import { cell, incompleteChip, paged, row, tableCard } from "../parts/tables.js";

const PAGE = 12;

/** A length, and its uncertainty. */
const quantityFields = (words, value, std) => [
  field(words, value, { unit: "mm" }),
  field("± (standard uncertainty)", std, { unit: "mm" }),
];

export class FingerTable {
  /** @param {import("./study_tables.js").StudyTables} tables */
  constructor(tables) {
    this.tables = tables;
    this.page = 0;
  }

  /** @param {Finger[]} fingers */
  draw(fingers) {
    const { shown, pager } = paged(fingers, this.page, PAGE, (page) => {
      this.page = page;
      this.tables.draw();
    });
    const thickness = { words: "Thickness, mm", title: "effective thickness of the tissue over bone" };
    const axes = AXES.map(([, words]) => ({ words: `${words}, mm` }));
    return tableCard("Fingers", {
      words: "semi-axes from photographs or entered",
      actions: [pager, button("Add a finger", () => this.#addFinger(), { kind: "small" })],
      headings: ["Finger", ...axes, thickness, "Photographs", ""],
      rows: shown.map((finger) => this.#finger(finger)),
      none: "No fingers yet. Add a photograph, or enter the semi-axes.",
    });
  }

  /** @param {Finger} finger */
  #finger(finger) {
    const { name, photographs, semi_axes_mm: axes, effective_thickness_mm: thickness } = finger;
    const chips = [synthetic(finger.synthetic), incompleteChip(finger), staleChip(name, "out of date")];
    return row(
      cell(
        h("strong", name),
        chips.map((one) => [" ", one]),
      ),
      AXES.map(([axis]) => h("td.number", axes?.[axis].words ?? "–")),
      h("td.number", [
        button(thickness.value === null ? "Enter" : thickness.words, () => this.#thickness(finger), {
          kind: "small",
          label: `Thickness of ${name}`,
          title: "Effective thickness over bone",
        }),
      ]),
      cell(
        photographs?.length
          ? h("div.faces", [photographs.map((photograph) => this.#face(photograph))])
          : h("span.soft", finger.table.semi_axes_mm ? "entered" : "none"),
      ),
      cell(
        h("div.actions", [
          !photographs?.length &&
            button("Semi-axes", () => this.#semiAxes(finger), {
              kind: "small",
              label: `Semi-axes of ${name}`,
            }),
          button("✎", () => this.#rename(finger), { kind: "icon", label: `Rename ${name}`, title: "Rename" }),
          this.tables.removal("finger", name, name),
        ]),
      ),
    );
  }

  /** @param {Finger["photographs"][number]} photograph */
  #face(photograph) {
    const words = [photograph.face, photograph.outline && "outline"].filter(Boolean).join(", ");
    const kind = photograph.rejected ? "warn" : photograph.accepted ? "good" : "";
    const name = photograph.file?.split("/").at(-1);
    const mark = words && chip(words, kind);
    const link = {
      href: `#/photographs/${encodeURIComponent(photograph.item)}`,
      title: photograph.file,
      "aria-label": `Photograph ${name}`,
    };
    return h("div.face", [
      photograph.outline ? mark : h("a.face-link", link, [thumbnail(photograph.item), mark]),
      missingList(missingOf("photograph", photograph.item)),
      this.tables.removal("photograph", photograph.item, `the photograph ${name}`),
    ]);
  }

  /** Ask for the name of a finger; empty if cancelled. */
  async #askName(words, doing, value = "") {
    const name = text({ placeholder: "left_index", value, pattern: namePattern() });
    const body = field("Name of the finger", name, { hint: "Letters, digits, - and _. A space becomes _." });
    return (await ask(words, body, doing)) ? name.value.trim() : "";
  }

  async #addFinger() {
    const name = await this.#askName("Add a finger", "Add");
    if (!name) return;
    this.page = Infinity; // the last page, where it stands
    await this.tables.change("finger", name, {});
    const made = workspace.study.fingers.find((finger) => finger.name === name);
    if (made && !made.photographs?.length) this.#semiAxes(made);
  }

  /** @param {Finger} finger */
  async #rename(finger) {
    const name = await this.#askName(`Rename ${finger.name}`, "Rename", finger.name);
    if (name && name !== finger.name) this.tables.change("finger", finger.name, { name });
  }

  /** Ask for the semi-axes of a finger by its name. */
  askSemiAxes(name) {
    const finger = workspace.study.fingers.find((each) => each.name === name);
    if (finger) this.#semiAxes(finger);
  }

  /** @param {Finger} finger */
  async #semiAxes(finger) {
    const { semi_axes_mm: now = {}, semi_axes_mm_std: std = {} } = finger.table ?? {};
    const inputs = AXES.map(([axis, words]) => [
      axis,
      words,
      number({ value: now[axis], above: 0 }),
      number({ value: std[axis], above: 0 }),
    ]);
    const fields = inputs.flatMap(([, , value, its]) => [value, its]);
    const requireAll = () => {
      const some = fields.some(({ value }) => value !== "");
      for (const input of fields) input.required = some;
    };
    const body = h("div.stack", { oninput: requireAll }, [
      h(
        "p",
        "Semi-axes of the pad, each with its standard uncertainty. Leave all empty if photographs follow.",
      ),
      h("div.fields.two", [inputs.map(([, ...its]) => quantityFields(...its))]),
    ]);
    requireAll();
    const save = await ask(`Semi-axes of ${finger.name}`, body, "Save");
    if (!save || fields.every(({ value }) => value === "")) return;
    this.tables.change("finger", finger.name, {
      semi_axes_mm: Object.fromEntries(inputs.map(([axis, , value]) => [axis, numberIn(value)])),
      semi_axes_mm_std: Object.fromEntries(inputs.map(([axis, , , its]) => [axis, numberIn(its)])),
    });
  }

  /** @param {Finger} finger */
  async #thickness(finger) {
    /** @type {Record<string, any>} */
    const { effective_thickness_mm: now, effective_thickness_mm_std: std } = finger.table;
    const [value, its] = [now, std].map((each) => number({ value: each, min: 0 }));
    const body = h("div.stack", [
      h(
        "p",
        "Effective thickness of the tissue over bone: that of a flat layer which acts like this finger's " +
          "narrow and curved bone. Results then show the whole pad on that layer beside Hertz theory. " +
          "Without an uncertainty it is taken as exact; empty fields remove it.",
      ),
      h("div.fields.two", quantityFields("Effective thickness", value, its)),
    ]);
    if (!(await ask(`Thickness of ${finger.name}`, body, "Save"))) return;
    this.tables.change("finger", finger.name, {
      effective_thickness_mm: numberIn(value),
      effective_thickness_mm_std: numberIn(its),
    });
  }
}
