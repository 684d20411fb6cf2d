// A card of results, and whether the model holds: one word, and the checks behind it.

import { h } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { rules } from "../core/workspace.js";
import { figureButton } from "./figure_settings.js";
import { chip, synthetic } from "./forms.js";

const KIND = { holds: "good", strained: "warn", fails: "bad" };

/** @param {string} verdict @param {[verdict: string, words: string][]} [checks] @param {string} [of] */
export function verdictChip(verdict, checks = [], of = "") {
  const tested = checks.filter(([found]) => found !== "not tested");
  return chip(
    `${rules().verdicts[verdict] ?? "–"} ${of}${verdict}`,
    KIND[verdict] ?? "",
    [`Hertz theory: ${verdict}`, ...tested.map(([, words]) => words)].join("\n"),
  );
}

/**
 * The figure of a kind that the report has of a finger at a placement.
 *
 * @param {Answers["FigureEntry"][]} figures
 * @param {{ figure: string }} group
 * @param {string} kind
 */
export const figureOf = (figures, group, kind) =>
  figures.find(({ name }) => name === `${group.figure}_${kind}`);

/**
 * A card of a finger at a placement: with a button for its figure, if there is one.
 *
 * @param {Answers["PlottedGroup"] | Answers["BudgetGroup"]} group
 * @param {Answers["FigureEntry"] | undefined} figure
 * @param {any} content
 */
export function groupCard(group, figure, content, name = "section.card") {
  const { finger, wedge_angle_deg: wedge, roll_angle_deg: roll } = group;
  return h(name, { "aria-label": `${finger}, wedge ${wedge.words}` }, [
    h("header", [
      h("h2", [
        `${finger}, `,
        symbol("θ"),
        ` = ${wedge.words}`,
        roll.value !== 0 && [", ", symbol("φ"), ` = ${roll.words}`],
      ]),
      synthetic(group.synthetic),
      h("div.actions", figureButton(figure)),
    ]),
    content,
  ]);
}
