// The numbers printed by Dzidek et al. (2017) compared with what their equations give.

import { get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { plain, unitOf, withUnit } from "../core/quantity.js";
import { chip } from "../parts/forms.js";

const MISPRINT = "reproduced with the known misprint";
const KIND = { reproduced: "good", [MISPRINT]: "accent" };

export class Audit {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const { items } = await get("/api/published");
    const count = (verdict) => items.filter((item) => item.verdict === verdict).length;
    render(
      this.root,
      h(
        "p.lead",
        null,
        `Supplement of Dzidek et al. (2017): ${items.length} published numbers compared with the values ` +
          `that its equations give. ${count("reproduced")} are reproduced, ${count(MISPRINT)} with a ` +
          "known misprint, and the others are not reproducible from the published values.",
      ),
      h(
        "div.table-wrap",
        { tabindex: 0, role: "region", "aria-label": "Audit of the published tables" },
        h(
          "table.audit",
          null,
          h(
            "thead",
            null,
            h(
              "tr",
              null,
              ["Item", "Printed", "Computed", "Rounding range", "With misprint", "Verdict", "Formula"].map(
                (words, index) =>
                  h("th", { scope: "col", class: index > 0 && index < 5 ? "number" : undefined }, words),
              ),
            ),
          ),
          h(
            "tbody",
            null,
            items.map((item) => row(item)),
          ),
        ),
      ),
    );
  }
}

/** @param {Answers["AuditedNumber"]} item */
function row({
  item,
  printed,
  computed,
  low,
  high,
  with_misprint: misprint,
  verdict,
  formula,
  remark,
  unit = unitOf(item),
}) {
  const number = (words, known) =>
    h("td.number", null, known === null || known === undefined ? "–" : withUnit(words, unit));
  return h(
    "tr",
    null,
    h("th", { scope: "row" }, item),
    number(String(printed), printed),
    number(plain(computed), computed),
    number(`${plain(low)} to ${plain(high)}`, low),
    number(plain(misprint), misprint),
    h("td", null, chip(verdict, KIND[verdict] ?? "warn")),
    h("td.formula", null, formula && h("code", null, formula), remark && h("p.soft", null, remark)),
  );
}
