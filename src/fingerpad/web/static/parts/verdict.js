// Whether the model holds: one word, and the checks behind it.

import { probability } from "../core/quantity.js";
import { chip, list } from "./forms.js";

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
