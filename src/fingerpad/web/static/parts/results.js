// The header of a card of results, and whether the model holds: one word, and the checks behind it.

import { h } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { plain, probability } from "../core/quantity.js";
import { figureButton } from "./figure_settings.js";
import { chip, list, synthetic } from "./forms.js";

// The symbols differ without colour too.
const SYMBOL = { holds: "●", strained: "◐", fails: "○" };
const KIND = { holds: "good", strained: "warn", fails: "bad" };

/** @param {Answers["CheckRecord"]} check */
function words({ compared, verdict, relative_difference: difference, difference_of: of, p_value: p, note }) {
  const numbers = [
    difference !== null &&
      `${of ? `${of} ` : ""}${difference < 0 ? "−" : "+"}${(100 * Math.abs(difference)).toFixed(1)} %`,
    p !== null && probability(p),
    note,
  ].filter(Boolean);
  return `${compared}: ${verdict}${numbers.length ? ` (${numbers.join(", ")})` : ""}`;
}

/** @param {Pick<Answers["ValidityRecord"], "verdict" | "checks">} validity */
export function verdictChip({ verdict, checks }) {
  const tested = checks.filter((check) => check.verdict !== "not tested");
  return chip(
    `${SYMBOL[verdict] ?? "–"} ${verdict}`,
    KIND[verdict] ?? "",
    `Hertz theory: ${verdict}\n${tested.map(words).join("\n")}`,
  );
}

/** @param {Answers["ValidityRecord"]} validity */
export const checkList = ({ checks }) => list(checks.map(words), "ul.note");

/**
 * The header of a card of a finger at a placement: with a button for its figure, if the report has it.
 *
 * @param {Answers["PlottedGroup"] | Answers["BudgetGroup"]} group
 * @param {Answers["Figures"]["figures"]} figures
 * @param {string} kind of the figure
 */
export const groupHeader = (group, figures, kind) =>
  h(
    "header",
    h(
      "h2",
      `${group.finger}, `,
      symbol("θ"),
      ` = ${plain(group.wedge_angle_deg)}°`,
      group.roll_angle_deg ? [", ", symbol("φ"), ` = ${plain(group.roll_angle_deg)}°`] : "",
    ),
    synthetic(group.synthetic),
    h("div.actions", figureButton(figures.find(({ name }) => name === `${group.figure}_${kind}`))),
  );
