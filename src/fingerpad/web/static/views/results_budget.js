// Uncertainty budget of the corrected radius.

import { get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { plain, withStd } from "../core/quantity.js";
import { figureButton } from "../parts/figure_settings.js";
import { chip, synthetic } from "../parts/forms.js";

const percent = (share) => `${(100 * share).toFixed(1)} %`;

export class Budget {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const [{ groups }, { figures }] = await Promise.all([
      get("/api/results/budget"),
      get("/api/results/figures"),
    ]);
    this.figures = figures;
    render(
      this.root,
      h(
        "p.lead",
        null,
        "Shares of the variance of the corrected radius ",
        symbol("R_g^corr"),
        ": of the pooled value, and of the highest-load contact by linear approximation and by Sobol's " +
          "total index, which includes interactions.",
      ),
      h(
        "div.plot-grid",
        null,
        groups.map((group) => this.#group(group)),
      ),
    );
  }

  /** @param {Answers["BudgetGroup"]} group */
  #group({ finger, wedge_angle_deg: wedge, roll_angle_deg: roll, synthetic: made, figure, pooled, check }) {
    const sources = Object.keys(pooled ?? check?.shares ?? {}).sort(
      (a, b) => (pooled ?? check.shares)[b] - (pooled ?? check.shares)[a],
    );
    const columns = [
      ["pooled", pooled, "measured"],
      ["highest load, linear", check?.shares, "compliance"],
      ["highest load, Sobol", check?.total, "predicted"],
    ].filter(([, shares]) => shares);
    return h(
      "section.card",
      { "aria-label": `${finger}, wedge ${wedge}°` },
      h(
        "header",
        null,
        h(
          "h2",
          null,
          finger,
          ", ",
          symbol("θ"),
          ` = ${plain(wedge)}°`,
          roll ? [", ", symbol("φ"), ` = ${plain(roll)}°`] : "",
        ),
        synthetic(made),
        h("div.actions", null, figureButton(this.figures.find(({ name }) => name === `${figure}_budget`))),
      ),
      check &&
        h(
          "p",
          null,
          h("span.number", null, `${check.observation}: ${withStd(check.value, check.std)} mm`),
          " ",
          check.valid
            ? chip("linear approximation valid", "good")
            : chip("linear approximation not valid", "warn"),
        ),
      sources.length
        ? h(
            "table.budget",
            null,
            h(
              "thead",
              null,
              h(
                "tr",
                null,
                h("th", { scope: "col" }, "Source"),
                columns.map(([words]) => h("th.number", { scope: "col" }, words)),
              ),
            ),
            h(
              "tbody",
              null,
              sources.map((source) =>
                h(
                  "tr",
                  null,
                  h("th", { scope: "row" }, source),
                  columns.map(([, shares, mark]) => {
                    const share = shares[source];
                    return h(
                      "td.number",
                      null,
                      share === undefined || share === null
                        ? "–"
                        : [
                            h("span", null, percent(share)),
                            h("i.share", {
                              "data-of": mark,
                              style: { width: `${Math.max(0, Math.min(1, share)) * 100}%` },
                            }),
                          ],
                    );
                  }),
                ),
              ),
            ),
          )
        : h("p.soft", null, "No contacts can be pooled."),
    );
  }
}
