// How the second operator agrees with the first, by the last run.

import { h } from "../core/dom.js";
import { who } from "../core/workspace.js";

/** @type {["semi_major_mm" | "semi_minor_mm" | "gross_area_mm2" | "ridge_area_mm2", string][]} */
const QUANTITIES = [
  ["gross_area_mm2", "Gross area"],
  ["ridge_area_mm2", "Ridge area"],
  ["semi_major_mm", "Semi-major"],
  ["semi_minor_mm", "Semi-minor"],
];

const signed = (share) =>
  share === null ? "–" : `${share < 0 ? "−" : "+"}${Math.abs(100 * share).toFixed(1)} %`;

/** @param {Answers["SecondOperator"]} state */
export function agreementOf({ first_operators: first, agreement, unseen }) {
  return [
    h("h3", null, "Second operator"),
    first.includes(who()) &&
      h(
        "p.note.bad",
        { role: "alert" },
        `The first operator is ${first.join(", ")}. Another person has to do this: enter their name above.`,
      ),
    h(
      "p.soft",
      null,
      "Images in random order: stop after as many as you like.",
      unseen > 0 && ` ${unseen} more wait for the first operator.`,
    ),
    // Closed: who knows the bias may correct for it.
    agreement.map((one) =>
      h(
        "details",
        { "data-live": "agreement" },
        h("summary", null, `Agreement by the last run${one.synthetic ? ", synthetic images" : ""}`),
        h(
          "p.number",
          null,
          `n = ${one.count}, IoU ${one.iou_mean.toFixed(3)} ` + `(least ${one.iou_least.toFixed(3)})`,
        ),
        h(
          "table.agreement",
          null,
          h(
            "thead",
            null,
            h(
              "tr",
              null,
              ["", "Bias", "Limits of agreement"].map((words) => h("th", null, words)),
            ),
          ),
          h(
            "tbody",
            null,
            QUANTITIES.map(([key, words]) => {
              const found = one[key];
              return (
                found &&
                h(
                  "tr",
                  null,
                  h("th", { scope: "row" }, words),
                  h("td.number", null, signed(found.bias)),
                  h(
                    "td.number",
                    null,
                    found.limits[0] === null ? "from 3 images on" : found.limits.map(signed).join(" to "),
                  ),
                )
              );
            }),
          ),
        ),
      ),
    ),
    !agreement.length && h("p.soft", null, "Run the study to see how far both agree."),
  ];
}
