// The numbers printed by Dzidek et al. (2017) compared with what their equations give.

import { get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { chip } from "../parts/forms.js";
import { tableOf } from "../parts/tables.js";

const MISPRINT = "reproduced with the known misprint";
const KIND = { reproduced: "good", [MISPRINT]: "accent" };

export class Audit {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const { items } = await get("/api/published");
    const count = (verdict) => items.filter((item) => item.verdict === verdict).length;
    render(this.root, [
      h(
        "p.lead",
        `Supplement of Dzidek et al. (2017): ${items.length} published numbers compared with the values ` +
          `that its equations give. ${count("reproduced")} are reproduced, ${count(MISPRINT)} with a ` +
          "known misprint, and the others are not reproducible from the published values.",
      ),
      h("div.table-wrap", { tabindex: 0, role: "region", "aria-label": "Audit of the published tables" }, [
        tableOf(
          "table.audit",
          [
            "Item",
            ...["Printed", "Computed", "Rounding range", "With misprint"].map((words) =>
              h("th.number", { scope: "col" }, words),
            ),
            "Verdict",
            "Formula",
          ],
          items.map(row),
        ),
      ]),
    ]);
  }
}

/** @param {Answers["AuditedNumber"]} number */
function row({ item, words, verdict, formula, remark }) {
  return h("tr", [
    h("th", { scope: "row" }, item),
    [words.printed, words.computed, words.range, words.with_misprint].map((each) => h("td.number", each)),
    h("td", chip(verdict, KIND[verdict] ?? "warn")),
    h("td.formula", [formula && h("code", formula), remark && h("p.soft", remark)]),
  ]);
}
