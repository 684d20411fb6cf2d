// Tables of what a study holds, one row for each thing.

import { h, small } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { chip } from "./forms.js";

const STATUS = {
  done: ["measured", "good"],
  left: ["not measured", ""],
  stale: ["changed", "warn"],
  older: ["program changed", "warn"],
  failed: ["failed", "bad"],
  given: ["given", ""],
  rejected: ["rejected", "bad"],
};

/** @param {{ status?: string, reason?: string | null, complete?: boolean }} entry */
export function statusChip({ status, reason, complete }) {
  const key = status === "stale" && workspace.study.results.other_program ? "older" : status;
  return incompleteChip({ complete }) || chip(...(STATUS[key] ?? [key ?? "", ""]), reason ?? undefined);
}

/** @param {{ complete?: boolean }} entry */
export const incompleteChip = ({ complete }) => complete === false && chip("incomplete", "warn");

/**
 * A card with a title, words beside it, and a table, or `none` without rows. The column without a heading
 * holds buttons; a heading can be `{ words, title }`, of numbers.
 *
 * @param {string} title
 * @param {{ words: any, actions?: any, headings: (string | { words: any, title?: string })[],
 *   rows: HTMLTableRowElement[], none?: any }} content
 */
export const tableCard = (title, { words, actions, headings, rows, none }) =>
  h("section.card", { "aria-label": title }, [
    h("header", [h("h2", title), h("span.soft", words), actions && h("div.actions", actions)]),
    none && !rows.length ? h("p.soft", none) : table(title, headings, rows),
  ]);

function table(label, headings, rows) {
  const heading = (one) =>
    typeof one === "string"
      ? h("th", { scope: "col" }, one || h("span.sr", "Actions"))
      : h("th.number", { scope: "col", title: one.title }, one.words);
  const made = tableOf("table.tight", headings.map(heading), rows);
  labelCells(made);
  return scrolled(label, made);
}

/** What scrolls in a box of its own, also by keys. */
export const scrolled = (label, content, name = "div.table-wrap") =>
  h(name, { tabindex: 0, role: "group", "aria-label": label }, content);

/** Headings of columns of numbers. @param {string[]} words */
export const numberHeadings = (words) => words.map((one) => h("th.number", { scope: "col" }, one));

/**
 * A table of headings, words or cells, and rows.
 *
 * @param {string} name
 * @param {any[]} headings
 * @param {any} rows
 */
export function tableOf(name, headings, rows) {
  const cells = headings.map((one) => (typeof one === "string" ? h("th", { scope: "col" }, one) : one));
  return h(name, [h("thead", h("tr", cells)), h("tbody", rows)]);
}

/** Buttons that turn the pages of a long table, if there are several. @param {(page: number) => any} turn */
export function pager(page, pages, turn) {
  const go = (to, words, label) => small(words, () => turn(to), { disabled: to < 0 || to >= pages, label });
  return (
    pages > 1 && [
      go(page - 1, "‹", "Previous page"),
      h("span.number", `${page + 1} of ${pages}`),
      go(page + 1, "›", "Next page"),
    ]
  );
}

/**
 * The rows of a page, and the buttons that turn it.
 *
 * @template T
 * @param {T[]} rows
 * @param {number} page
 * @param {number} size rows on a page
 * @param {(page: number) => void} turn
 */
export function paged(rows, page, size, turn) {
  const pages = Math.max(1, Math.ceil(rows.length / size));
  const at = Math.min(page, pages - 1);
  return { shown: rows.slice(at * size, (at + 1) * size), pager: pager(at, pages, turn) };
}

/**
 * Name the column of each cell, for small screens, on which a row becomes a card.
 *
 * @param {HTMLTableElement} table
 */
function labelCells(table) {
  const labels = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
  for (const row of table.tBodies[0].rows) {
    for (const [k, cell] of [...row.cells].entries()) {
      if (k < labels.length - 1) cell.dataset.label = labels[k];
    }
  }
}

/** A row of cells, by the key of its item. @param {string} key @param {...any} cells */
export const row = (key, ...cells) => h("tr", { key }, cells);

/** A cell. @param {...any} content */
export const cell = (...content) => h("td", content);
