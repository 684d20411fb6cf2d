// The results as a table that can be filtered and sorted.

import { contactAddress, download, get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { symbol, symbolParts } from "../core/glossary.js";
import { describeCode, workspace } from "../core/workspace.js";
import { button, check, chip, choiceField, field, synthetic } from "../parts/forms.js";
import { tableOf } from "../parts/tables.js";

const LIMIT = 100;
// Shown where a finger's thickness is stated.
const ON_LAYER = [
  "youngs_modulus_on_layer_kpa",
  "indentation_on_layer_mm",
  "loading_radius_on_layer_mm",
  "layer_flag",
];
const SHOWN = [
  "finger",
  "wedge_angle_deg",
  "load_N",
  "status",
  "radius_from_indentation_mm",
  "semi_major_mm",
  "semi_minor_mm",
  "gross_area_mm2",
  "ridge_area_mm2",
  "indentation_mm",
  "youngs_modulus_kpa",
  ...ON_LAYER,
  "radius_from_compliance_mm",
  "mean_curvature_radius_mm",
  "contact_radius_ratio",
  "measured_by",
];
/** A label whose first word is a symbol, with its subscript. */
function labelParts(label) {
  const [first] = /^[^ ,]+/.exec(label) ?? [""];
  return /^.$|_/.test(first) ? [symbolParts(first), label.slice(first.length)] : label;
}

/** @typedef {Record<string, any>} Row */

/** Whether a cell holds a count or a quantity. */
const isNumber = (value) => typeof value === "number" || value?.words !== undefined;

const KIND = { measured: "good", failed: "bad", rejected: "bad" };

export class Table {
  constructor(root) {
    this.root = root;
    /** @type {Record<string, any>} */
    this.asked = { offset: 0, limit: LIMIT };
    this.all = false;
  }

  async load() {
    const { study } = workspace;
    const set = (key) => (value) => this.#ask({ [key]: value, offset: 0 });
    const placed = [...study.observations, ...study.sequences].map(({ wedge_angle_deg: wedge }) => wedge);
    const angles = [...new Set(placed)]
      .filter((wedge) => wedge !== null)
      .sort((a, b) => a - b)
      .map((wedge) => [String(wedge), `${wedge}°`]);
    const names = study.fingers.map(({ name }) => name);
    const flags = ["contact", "scale", "frame"]
      .flatMap((kind) => Object.keys(study.words?.flags[kind] ?? {}))
      .map((code) => [code, code.replaceAll("_", " ")]);
    const filter = (label, key, none, options) =>
      choiceField(label, { options: [["", none], ...options], onset: set(key) });
    const find = () => set("text")(this.searchField.value);
    this.searchField = h("input", {
      type: "search",
      placeholder: "name, reason …",
      oninput: () => {
        clearTimeout(this.timer);
        this.timer = setTimeout(find, 250);
      },
    });
    this.count = h("span.soft.number", { role: "status" });
    this.table = h("div.table-wrap.results-table", { tabindex: 0, role: "region", "aria-label": "Rows" });
    this.pager = h("div.actions");
    this.more = h("span.soft", { hidden: true }, "More columns to the right: scroll sideways.");
    this.size = new ResizeObserver(() => this.#showMore());
    this.size.observe(this.table);
    render(this.root, [
      h("div.filters", [
        field("Search", this.searchField),
        filter("Finger", "finger", "all", names),
        filter("Wedge", "wedge_angle_deg", "all", angles),
        filter("Status", "status", "all", ["measured", "failed", "rejected"]),
        filter("Flag", "flag", "any", flags),
        check("All columns", { onset: (on) => ((this.all = on), this.#draw()) }),
        h("span.grow"),
        h("a.button", { href: download("results.csv?attachment=1") }, "CSV"),
      ]),
      h("div.table-head", [this.count, h("div.actions", [this.more, this.pager])]),
      this.table,
    ]);
    await this.#ask({});
  }

  search() {
    this.searchField?.focus();
  }

  async #ask(change) {
    Object.assign(this.asked, change);
    const number = (this.number = (this.number ?? 0) + 1);
    this.table.classList.add("waiting");
    const answer = await get("/results/rows", this.asked);
    if (number !== this.number) return;
    this.answer = answer;
    this.table.classList.remove("waiting");
    this.#draw();
  }

  #draw() {
    const { columns, rows, matching, total } = this.answer;
    const { offset } = this.asked;
    const known = new Map(columns.map((column) => [column.key, column]));
    const layered = workspace.study.fingers.some(({ table }) => table.effective_thickness_mm !== undefined);
    const shown = this.all
      ? columns.filter(({ key }) => key !== "observation")
      : SHOWN.filter((key) => layered || !ON_LAYER.includes(key))
          .map((key) => known.get(key))
          .filter(Boolean);
    const range = `, ${offset + 1} to ${Math.min(matching, offset + LIMIT)} shown`;
    this.count.textContent = `${matching} of ${total} rows${matching > LIMIT ? range : ""}`;
    const turn = (words, to, label) =>
      button(words, () => this.#ask({ offset: to }), {
        kind: "small",
        disabled: to < 0 || to >= matching,
        label,
      });
    render(this.pager, [
      matching > LIMIT && [
        turn("‹", offset - LIMIT, "Previous rows"),
        turn("›", offset + LIMIT, "Next rows"),
      ],
    ]);
    if (!rows.length) {
      render(this.table, h("p.soft.no-rows", "No rows match the filters."));
      return;
    }
    const numeric = (key) => rows.some((row) => isNumber(row[key]));
    render(this.table, [
      tableOf(
        "table.tight",
        [
          this.#header({ key: "observation", label: "Contact", words: "name of the observation" }, false),
          ...shown.map((column) => this.#header(column, numeric(column.key))),
        ],
        rows.map((row) =>
          h("tr", [
            h("th", { scope: "row" }, [
              this.#link(row),
              " ",
              synthetic(row.synthetic),
              " ",
              String(row.flags ?? "")
                .split(" ")
                .filter(Boolean)
                .map((flag) => chip(flag.replaceAll("_", " "), "warn", describeCode(flag))),
            ]),
            shown.map(({ key }) => this.#cell(row, key, numeric(key))),
          ]),
        ),
      ),
    ]);
    this.#showMore();
  }

  #showMore() {
    const { scrollWidth, clientWidth } = this.table;
    this.more.hidden = scrollWidth <= clientWidth;
  }

  /** @param {Row} row */
  #link(row) {
    if (!row.item || !row.file) return h("span", row.observation);
    return h("a", { href: contactAddress(row.item, row.sequence) }, row.observation);
  }

  /**
   * @param {{ key: string, label: string, words: string, symbol?: string | null }} column
   * @param {boolean} number
   */
  #header({ key, label, words, symbol: term }, number) {
    // Each press goes on to the next order: rising, falling, that of the study.
    const { sort } = this.asked;
    const [way, sign, next] = {
      [key]: ["ascending", " ↑", `-${key}`],
      [`-${key}`]: ["descending", " ↓", ""],
    }[sort] ?? [undefined, "", key];
    const shown = labelParts(label);
    const content = [
      term ? symbol(term, { inControl: true, words: shown }) : shown,
      h("span", { "aria-hidden": "true" }, sign),
    ];
    return h(
      number ? "th.number" : "th",
      { scope: "col", "aria-sort": way, title: term ? undefined : words },
      button(content, () => this.#ask({ sort: next, offset: 0 }), { label: `Sort by ${label}` }),
    );
  }

  /** @param {Row} row @param {string} key of its column @param {boolean} numeric whether it has numbers */
  #cell(row, key, numeric) {
    const value = row[key];
    if (key === "status")
      return h("td", [
        chip(value, KIND[value] ?? "", row.reason || undefined),
        row.reason && h("div.soft.reason", row.reason),
      ]);
    const unknown = value === null || value === undefined || value === "";
    return h(numeric ? "td.number" : "td", unknown ? h("span.soft", "–") : (value.words ?? String(value)));
  }

  close() {
    clearTimeout(this.timer);
    this.size?.disconnect();
  }
}
