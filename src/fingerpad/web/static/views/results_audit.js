// The printed numbers of the source beside what its own equations give.

import { get } from "../core/api.js";
import { h, place } from "../core/dom.js";
import { plain, unitOf } from "../core/quantity.js";
import { chip } from "../parts/forms.js";

const KIND = { reproduced: "good", "reproduced with the known slip": "accent" };

export class Audit {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const { items } = await get("/api/published");
    const count = (verdict) => items.filter((item) => item.verdict === verdict).length;
    place(
      this.root,
      h("p.lead", null, `The supplement of Dzidek et al. 2017, from which the model comes: ${items.length} printed numbers beside what its equations give from its own printed inputs. ${count("reproduced")} are reproduced, ${count("reproduced with the known slip")} with a slip of the pen that is known, and the rest cannot be had from what is printed.`),
      h(
        "div.table-wrap",
        { tabindex: 0, role: "region", "aria-label": "Audit of the printed tables" },
        h(
          "table.audit",
          null,
          h("thead", null, h("tr", null, ["Item", "Printed", "Computed", "Range of rounding", "With the slip", "Verdict", "How"].map((words, index) => h("th", { scope: "col", class: index > 0 && index < 5 ? "number" : undefined }, words)))),
          h(
            "tbody",
            null,
            items.map((item) =>
              h(
                "tr",
                null,
                h("th", { scope: "row" }, item.item),
                h("td.number", null, `${item.printed} ${item.unit ?? unitOf(item.item)}`),
                h("td.number", null, plain(item.computed)),
                h("td.number", null, item.low === null || item.low === undefined ? "–" : `${plain(item.low)} to ${plain(item.high)}`),
                h("td.number", null, plain(item.with_slip)),
                h("td", null, chip(item.verdict, KIND[item.verdict] ?? "warn")),
                h("td.formula", null, item.formula && h("code", null, item.formula), item.remark && h("p.soft", null, item.remark)),
              ),
            ),
          ),
        ),
      ),
    );
  }
}
