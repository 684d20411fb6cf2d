// The table of contacts: whose they are, wedge, load and scale.

import { h } from "../core/dom.js";
import { describeCode, workspace } from "../core/workspace.js";
import { button, chip, choose, number, synthetic } from "../parts/forms.js";
import { scaleChoice } from "../parts/scale_choice.js";
import { card, cell, row, statusChip, table } from "../parts/tables.js";

const PAGE = 50;

export class ContactTable {
  /** @param {import("./study_tables.js").StudyTables} tables */
  constructor(tables) {
    this.tables = tables;
    this.page = 0;
  }

  /** @param {Observation[]} observations */
  draw(observations) {
    const rolled =
      observations.some(({ roll_angle_deg: roll }) => roll) ||
      workspace.study.uncertainty.roll_angle_deg_std > 0;
    const pages = Math.max(1, Math.ceil(observations.length / PAGE));
    this.page = Math.min(this.page, pages - 1);
    const shown = observations.slice(this.page * PAGE, (this.page + 1) * PAGE);
    return card(
      "Contacts",
      `${observations.length} in all`,
      pages > 1 && this.#pager(pages),
      observations.length
        ? table(
            "Contacts",
            [
              "Contact",
              "Finger",
              "Wedge, °",
              ...(rolled ? ["Roll, °"] : []),
              "Load, N",
              "Scale",
              "Status",
              "",
            ],
            shown.map((observation) => this.#observation(observation, rolled)),
          )
        : h("p.soft", "No contacts yet. Drop contact images above; each is one contact at one load."),
    );
  }

  #pager(pages) {
    const go = (by) => () => {
      this.page += by;
      this.tables.draw();
    };
    return [
      button("‹", go(-1), { kind: "small", disabled: this.page === 0, label: "Previous page" }),
      h("span.number", `${this.page + 1} of ${pages}`),
      button("›", go(1), { kind: "small", disabled: this.page === pages - 1, label: "Next page" }),
    ];
  }

  /**
   * @param {Observation} one
   * @param {boolean} rolled
   */
  #observation(one, rolled) {
    const set = (key) => (value) => this.tables.change("observation", one.item, { [key]: value });
    const num = (key, words, more) =>
      h(
        "td",
        { "data-empty": (one[key] === null || one[key] === undefined) && key !== "roll_angle_deg" },
        number({ value: one[key], min: 0, label: `${words} of ${one.item}`, onset: set(key), ...more }),
      );
    return row(
      cell(
        one.file ? h("a", { href: `#/contacts/images/${encodeURIComponent(one.item)}` }, one.item) : one.item,
        " ",
        synthetic(one.synthetic),
        one.flags.length > 0 && [" ", chip("flagged", "warn", one.flags.map(describeCode).join("; "))],
      ),
      cell(
        choose({
          value: one.finger ?? "",
          options: [
            ...(one.finger ? [] : [["", "– select –"]]),
            ...workspace.study.fingers.map(({ name }) => name),
          ],
          label: `Finger of ${one.item}`,
          onset: set("finger"),
        }),
      ),
      num("wedge_angle_deg", "Wedge angle", { max: 90 }),
      rolled && num("roll_angle_deg", "Roll angle", { min: undefined }),
      num("load_N", "Load"),
      one.file
        ? h(
            "td",
            { "data-empty": !one.scale },
            scaleChoice({ value: one.scale, label: `Scale of ${one.item}`, onset: set("scale") }),
          )
        : h("td.soft", "ellipse given"),
      cell(statusChip(one)),
      cell(this.tables.removal("observation", one.item, one.item, one.item)),
    );
  }
}
