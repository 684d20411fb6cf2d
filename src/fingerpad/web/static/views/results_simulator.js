// A finger in the numbers and files that robot simulators take.

import { addressOf, get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { list, numberField } from "../parts/forms.js";
import { groupHeader } from "../parts/results.js";
import { tableOf } from "../parts/tables.js";

const percent = (share) => `${Number((100 * share).toPrecision(2))} %`;

export class Simulator {
  constructor(root) {
    this.root = root;
    this.asked = { lowest_load_N: 0.2, highest_load_N: 3, thickness_mm: null, mass_kg: 0.1 };
  }

  async load() {
    const [{ groups }, { figures }] = await Promise.all([get("/results/budget"), get("/results/figures")]);
    this.groups = groups;
    this.figures = figures;
    this.cards = h("div.plot-grid");
    render(this.root, [
      h(
        "p.lead",
        "What MuJoCo, Drake and Newton take for each finger, the largest error of the load over the range, " +
          "and the files that are ready to run.",
      ),
      h("div.filters", [
        this.#number("Lowest load", "lowest_load_N", "N"),
        this.#number("Highest load", "highest_load_N", "N"),
        this.#number("Effective mass (MuJoCo)", "mass_kg", "kg"),
        this.#number("Thickness", "thickness_mm", "mm", "of the study"),
      ]),
      this.cards,
    ]);
    this.#draw();
  }

  #number(words, key, unit, placeholder = "") {
    const onset = (value) => {
      this.asked[key] = value;
      this.#draw();
    };
    return numberField(words, { value: this.asked[key], above: 0, placeholder, onset, unit });
  }

  #draw() {
    render(this.cards, [this.groups.map((group) => this.#card(group))]);
  }

  /** @param {Answers["BudgetGroup"]} group */
  #card(group) {
    const { finger, wedge_angle_deg: wedge } = group;
    const query = Object.fromEntries(
      Object.entries({ finger, wedge_angle_deg: wedge, ...this.asked }).filter(([, value]) => value !== null),
    );
    const body = h("div.stack-small", h("p.soft", { role: "status" }, "Computing …"));
    get("/results/simulator", /** @type {any} */ (query))
      .then((found) => render(body, [numbers(found), download(query, finger, wedge)]))
      .catch((error) => render(body, h("p.note", { role: "alert" }, error.message)));
    // Of the curves of this finger and angle, the first that has the figure.
    const drawn = this.figures.find(
      ({ name }) => name.replace(/^curve\d+_/, "") === `${group.figure}_simulator`,
    );
    return h("section.card", { "aria-label": `${finger}, wedge ${wedge}°` }, [
      groupHeader(group, drawn),
      drawn && h("img", { src: drawn.svg, alt: drawn.caption, loading: "lazy" }),
      body,
    ]);
  }
}

/** @param {Answers["SimulatorNumbers"]} found */
const numbers = ({ source, model, targets, notes }) => [
  h("p", `The whole pad by the ${model}, which the simulators are to follow. ${source}.`),
  tableOf(
    "table.budget",
    [
      "Simulator",
      "Value",
      ...["Largest error of load", "Area factor"].map((words) => h("th.number", { scope: "col" }, words)),
    ],
    targets.map(({ name, value, worst_relative_error: error, area_factor: factor, assumes }) =>
      h("tr", { title: `Assumes ${assumes}` }, [
        h("th", { scope: "row" }, name),
        h("td", value),
        h("td.number", percent(error)),
        h("td.number", factor === null ? "–" : `× ${factor.toFixed(2)}`),
      ]),
    ),
  ),
  list(notes, "ul.note"),
];

const download = (query, finger, wedge) =>
  h("div.actions", [
    h(
      "a.button",
      {
        href: addressOf(`/results/simulator/file?${new URLSearchParams(query)}`),
        "aria-label": `Files of ${finger}, wedge ${wedge}°`,
        download: "",
      },
      "Files (ZIP)",
    ),
  ]);
