// The table of contacts: whose they are, wedge, load and scale.

import { h } from "../core/dom.js";
import { describeCode, workspace } from "../core/workspace.js";
import { chip, synthetic } from "../parts/forms.js";
import { card, cell, paged, row, statusChip, table } from "../parts/tables.js";

const PAGE = 50;
// So few are found at a glance.
const FEW = 15;

export class ContactTable {
  /** @param {import("./study_tables.js").StudyTables} tables */
  constructor(tables) {
    this.tables = tables;
    this.page = 0;
    this.wanted = "";
  }

  #find() {
    const oninput = ({ currentTarget }) => {
      this.wanted = currentTarget.value.trim().toLowerCase();
      this.#turn(0);
    };
    const words = { placeholder: "name or finger", "aria-label": "Find contacts" };
    return h("input", { type: "search", ...words, oninput });
  }

  #turn(page) {
    this.page = page;
    this.tables.draw();
  }

  /** @param {Observation[]} observations */
  draw(observations) {
    const rolled =
      observations.some(({ roll_angle_deg: roll }) => roll) ||
      workspace.study.uncertainty.roll_angle_deg_std > 0;
    const many = observations.length > FEW;
    const wanted = many ? this.wanted : "";
    const found = observations.filter((one) =>
      [one.item, one.finger ?? ""].some((words) => words.toLowerCase().includes(wanted)),
    );
    const { shown, pager } = paged(found, this.page, PAGE, (page) => this.#turn(page));
    return card(
      "Contacts",
      wanted ? `${found.length} of ${observations.length}` : `${observations.length} in all`,
      (many || pager) && [many && this.#find(), pager],
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

  /** @param {Observation} one @param {boolean} rolled */
  #observation(one, rolled) {
    const cells = this.tables.cells("observation", one.item, one);
    return row(
      cell(
        one.file ? h("a", { href: `#/contacts/images/${encodeURIComponent(one.item)}` }, one.item) : one.item,
        " ",
        synthetic(one.synthetic),
        one.flags.length > 0 && [" ", chip("flagged", "warn", one.flags.map(describeCode).join("; "))],
      ),
      cells.finger(),
      cells.number("wedge_angle_deg", "Wedge angle", { max: 90 }),
      rolled && cells.number("roll_angle_deg", "Roll angle", { min: undefined }, false),
      cells.number("load_N", "Load"),
      one.file ? cells.scale() : h("td.soft", "ellipse given"),
      cell(statusChip(one)),
      cell(this.tables.removal("observation", one.item, one.item, one.item)),
    );
  }
}
