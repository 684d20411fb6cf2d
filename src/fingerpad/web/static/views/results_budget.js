// Uncertainty budget of the corrected radius.

import { get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { percent } from "../core/quantity.js";
import { chip } from "../parts/forms.js";
import { figureOf, groupHeader } from "../parts/results.js";
import { tableOf } from "../parts/tables.js";

export class Budget {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const [{ groups }, { figures }] = await Promise.all([get("/results/budget"), get("/results/figures")]);
    this.figures = figures;
    render(this.root, [
      h("p.lead", [
        "Shares of the variance of the corrected radius ",
        symbol("R_g^corr"),
        ": of the pooled value, and of the highest-load contact by linear approximation and by Sobol's " +
          "total index, which includes interactions.",
      ]),
      h("div.plot-grid", [groups.map((group) => this.#group(group))]),
    ]);
  }

  /** @param {Answers["BudgetGroup"]} group */
  #group(group) {
    const { finger, wedge_angle_deg: wedge, pooled, check, check_words: words } = group;
    const sources = Object.keys(pooled ?? check?.shares ?? {}).sort(
      (a, b) => (pooled ?? check.shares)[b] - (pooled ?? check.shares)[a],
    );
    const columns = [
      ["pooled", pooled, "measured"],
      ["highest load, linear", check?.shares, "compliance"],
      ["highest load, Sobol", check?.total, "predicted"],
    ].filter(([, shares]) => shares);
    return h("section.card", { "aria-label": `${finger}, wedge ${wedge}°` }, [
      groupHeader(group, figureOf(this.figures, group, "budget")),
      check &&
        h("p", [
          h("span.number", words),
          " ",
          check.valid
            ? chip("linear approximation valid", "good")
            : chip("linear approximation not valid", "warn"),
        ]),
      sources.length
        ? tableOf(
            "table.budget",
            ["Source", ...columns.map(([words]) => h("th.number", { scope: "col" }, words))],
            sources.map((source) =>
              h("tr", [
                h("th", { scope: "row" }, source),
                columns.map(([, shares, mark]) => {
                  const share = shares[source];
                  return h("td.number", [
                    share === undefined || share === null ? "–" : h("span", percent(share)),
                    // A shorter bar would be a speck.
                    share >= 0.01 &&
                      h("i.share", {
                        style: { background: `var(--${mark})`, width: `${Math.min(1, share) * 100}%` },
                      }),
                  ]);
                }),
              ]),
            ),
          )
        : h("p.soft", "No contacts can be pooled."),
    ]);
  }
}
