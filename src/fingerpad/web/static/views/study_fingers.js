// The table of fingers: semi-axes, thickness and photographs.

import { button, h, small } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import { chip, field, namePattern, number, numberIn, synthetic, text, thumbnail } from "../parts/forms.js";
import { AXES, missingList, missingOf, staleChip } from "../parts/missing_fields.js";
import { cell, incompleteChip, paged, row, tableCard } from "../parts/tables.js";

const PAGE = 12;

/** The fields of a length and its uncertainty. @param {{ min?: number, above?: number }} limits of both */
export function quantity(words, now, std, limits, ofStd = "± (standard uncertainty)") {
  const [value, its] = [now, std].map((each) => number({ value: each, ...limits }));
  const unit = "mm";
  return { value, its, fields: [field(words, value, { unit }), field(ofStd, its, { unit })] };
}

/** Ask for quantities; whether they are to be saved. */
const askFor = (title, words, quantities, oninput = undefined) => {
  const fields = h("div.fields.two", [quantities.map((one) => one.fields)]);
  return ask(title, h("div.stack", { oninput }, [h("p", words), fields]), "Save");
};

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
      actions: [pager, small("Add a finger", () => this.#addFinger())],
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
      name,
      cell([h("strong", name), chips.map((one) => [" ", one])]),
      AXES.map(([axis]) => h("td.number", axes?.[axis].words ?? "–")),
      h("td.number", [
        small(thickness.value === null ? "Enter" : thickness.words, () => this.#thickness(finger), {
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
            small("Semi-axes", () => this.#semiAxes(finger), { label: `Semi-axes of ${name}` }),
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
    const { semi_axes_mm: now, semi_axes_mm_std: std } = finger.table ?? {};
    const asked = AXES.map(([axis, words], at) =>
      quantity(words, now?.[axis], std?.[axis], { above: 0 }, at ? "± (if empty, the first)" : "± (needed)"),
    );
    const isEmpty = () => asked.every(({ value }) => value.value === "");
    const requireAll = () => {
      for (const input of [asked[0].its, ...asked.map(({ value }) => value)]) input.required = !isEmpty();
    };
    requireAll();
    const words =
      "Semi-axes of the pad with their standard uncertainties." +
      (now ? " To give photographs instead, empty the semi-axes." : "");
    if (!(await askFor(`Semi-axes of ${finger.name}`, words, asked, requireAll))) return;
    const entered = (of) =>
      isEmpty() ? null : Object.fromEntries(AXES.map(([axis], at) => [axis, numberIn(of(asked[at]))]));
    this.tables.change("finger", finger.name, {
      semi_axes_mm: entered(({ value }) => value),
      semi_axes_mm_std: entered(({ its }) => (its.value ? its : asked[0].its)),
    });
  }

  /** @param {Finger} finger */
  async #thickness(finger) {
    const { effective_thickness_mm: now, effective_thickness_mm_std: std } = finger.table;
    const asked = quantity("Effective thickness", now, std, { min: 0 });
    const words =
      "Effective thickness of the tissue over bone: that of a flat layer which acts like this finger's " +
      "narrow and curved bone. Results then show the whole pad on that layer beside Hertz theory. " +
      "Without an uncertainty it is taken as exact; empty fields remove it.";
    if (!(await askFor(`Thickness of ${finger.name}`, words, [asked]))) return;
    this.tables.change("finger", finger.name, {
      effective_thickness_mm: numberIn(asked.value),
      effective_thickness_mm_std: numberIn(asked.its),
    });
  }
}
