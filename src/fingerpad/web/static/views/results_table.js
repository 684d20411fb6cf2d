// The results as a table that can be filtered and sorted.

import { contactAddress, download, get, LatestRequest } from "../core/api.js";
import { button, h, render } from "../core/dom.js";
import { symbol, symbolParts } from "../core/glossary.js";
import { showError } from "../core/messages.js";
import { describeCode, workspace } from "../core/workspace.js";
import { check, chip, choiceField, field, synthetic } from "../parts/forms.js";
import { pager, tableOf } from "../parts/tables.js";

const LIMIT = 100;
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
    this.asked = { offset: 0, limit: LIMIT, usual: true };
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
      .flatMap((kind) => Object.keys(study.flags[kind]))
      .map((code) => [code, code.replaceAll("_", " ")]);
    const filter = (label, key, none, options) =>
      choiceField(label, { options: [["", none], ...options], onset: set(key) });
    const oninput = () => set("text")(this.searchField.value);
    this.searchField = h("input", { type: "search", placeholder: "name, reason …", oninput });
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
        check("All columns", { onset: (on) => this.#ask({ usual: !on }) }),
        h("span.grow"),
        h("a.button", { href: download("results.csv?attachment=1") }, "CSV"),
      ]),
      h("div.table-head", [this.count, h("div.actions", [this.more, this.pager])]),
      this.table,
    ]);
    this.rows = new LatestRequest(
      (asked) => get("/results/rows", asked),
      (answer) => this.#draw(answer),
      showError,
      this.table,
    );
    this.drawn = "";
    this.#draw(await get("/results/rows", this.asked));
  }

  search() {
    this.searchField?.focus();
  }

  #ask(change) {
    this.asked = { ...this.asked, ...change };
    this.rows.request(this.asked);
  }

  /** @param {Answers["Rows"]} answer */
  #draw({ columns, rows, matching, total }) {
    const { offset, sort, usual } = this.asked;
    // Drawn again, a row that is there already would lose the focus.
    const drawn = JSON.stringify([rows, matching, offset, sort, usual]);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    const shown = columns.filter(({ key }) => key !== "observation");
    const range = `, ${offset + 1} to ${Math.min(matching, offset + LIMIT)} shown`;
    this.count.textContent = `${matching} of ${total} rows${matching > LIMIT ? range : ""}`;
    const turn = (page) => this.#ask({ offset: page * LIMIT });
    render(this.pager, pager(offset / LIMIT, Math.ceil(matching / LIMIT), turn));
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
    this.size?.disconnect();
  }
}
