// The table of loading data: curves, and radii from elsewhere.

import { h } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { ask } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import { button, choose, field, number, numberIn, synthetic } from "../parts/forms.js";
import { card, cell, row, statusChip, table } from "../parts/tables.js";

export class CurveTable {
  /** @param {import("./study_tables.js").StudyTables} tables */
  constructor(tables) {
    this.tables = tables;
  }

  /** @param {State["curves"]} curves */
  draw(curves) {
    const words = h("span", "Add ", symbol("R_g", { inControl: true }), " from elsewhere");
    return card(
      "Loading data",
      ["force–displacement curves, or ", symbol("R_g"), " from elsewhere"],
      button(words, () => this.#addRadius(), { kind: "small", disabled: !workspace.study.fingers.length }),
      curves.length
        ? table(
            "Loading data",
            ["Source", "Finger", "Wedge, °", { words: [symbol("R_g"), ", mm"] }, "Status", ""],
            curves.map((one) => this.#curve(one)),
          )
        : h(
            "p.soft",
            "None. The study runs without them; ",
            symbol("R_g"),
            " is then not compared with the corrected radius.",
          ),
    );
  }

  /** @param {State["curves"][number]} one */
  #curve(one) {
    return row(
      cell(one.file ?? "from elsewhere", " ", synthetic(one.synthetic)),
      cell(one.finger ?? "–"),
      this.tables
        .cells("curve", one.key, one, `curve ${one.key}`)
        .number("wedge_angle_deg", "Wedge angle", { max: 90 }),
      h("td.number", one.loading_radius_mm ? one.words.loading_radius_mm : one.file ? "from the curve" : "–"),
      cell(statusChip(one)),
      cell(this.tables.removal("curve", one.key, `curve ${one.key}`, one.file ?? "this radius")),
    );
  }

  async #addRadius() {
    const finger = choose({
      value: workspace.study.fingers[0].name,
      options: workspace.study.fingers.map(({ name }) => name),
    });
    const wedge = number({ min: 0, max: 90 });
    const radius = number({ min: 0 });
    const std = number({ min: 0 });
    const add = await ask(
      "R_g from loading data",
      h(
        "div.fields",
        field("Finger", finger),
        field("Wedge angle", wedge, { unit: "°" }),
        field("R_g", radius, { unit: "mm" }),
        field("± (standard uncertainty)", std, { unit: "mm" }),
      ),
      "Add",
    );
    if (!add || numberIn(radius) === null) return;
    const entered = {
      finger: finger.value,
      loading_radius_mm: numberIn(radius),
      wedge_angle_deg: numberIn(wedge),
      loading_radius_mm_std: numberIn(std),
    };
    const set = Object.fromEntries(Object.entries(entered).filter(([, value]) => value !== null));
    this.tables.change("curve", String(workspace.study.curves.length), set);
  }
}
