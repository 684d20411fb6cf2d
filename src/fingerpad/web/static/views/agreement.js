// How the second operator agrees with the first, by the last run.

import { h } from "../core/dom.js";
import { signedPercent } from "../core/quantity.js";
import { who } from "../core/workspace.js";
import { tableOf } from "../parts/tables.js";

/** @type {["semi_major_mm" | "semi_minor_mm" | "gross_area_mm2" | "ridge_area_mm2", string][]} */
const QUANTITIES = [
  ["gross_area_mm2", "Gross area"],
  ["ridge_area_mm2", "Ridge area"],
  ["semi_major_mm", "Semi-major"],
  ["semi_minor_mm", "Semi-minor"],
];

/** @param {Answers["SecondOperator"]} state */
export function agreementOf({ first_operators: first, agreement, unseen }) {
  return [
    h("h3", "Second operator"),
    first.includes(who()) &&
      h(
        "p.note.bad",
        { role: "alert" },
        `The first operator is ${first.join(", ")}. Another person has to do this: enter their name above.`,
      ),
    h("p.soft", [
      "Images in random order: stop after as many as you like.",
      unseen > 0 && ` ${unseen} more wait for the first operator.`,
    ]),
    // Closed: who knows the bias may correct for it.
    agreement.map((one) =>
      h("details", { "data-live": "agreement" }, [
        h("summary", `Agreement by the last run${one.synthetic ? ", synthetic images" : ""}`),
        h(
          "p.number",
          `n = ${one.count}, IoU ${one.iou_mean.toFixed(3)} ` + `(least ${one.iou_least.toFixed(3)})`,
        ),
        tableOf(
          "table.agreement",
          ["", "Bias", "Limits of agreement"],
          QUANTITIES.map(([key, words]) => {
            const found = one[key];
            return (
              found &&
              h("tr", [
                h("th", { scope: "row" }, words),
                h("td.number", signedPercent(found.bias)),
                h("td.number", [
                  found.limits[0] === null
                    ? "from 3 images on"
                    : found.limits.map(signedPercent).join(" to "),
                ]),
              ])
            );
          }),
        ),
      ]),
    ),
    !agreement.length && h("p.soft", "Run the study to see how far both agree."),
  ];
}
