// The header of results of a finger at a placement.

import { h } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { plain } from "../core/quantity.js";
import { figureButton } from "./figure_settings.js";
import { synthetic } from "./forms.js";

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
