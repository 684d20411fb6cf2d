// Parts of the results without a state of their own: figures, uncertainty budget, simulators and audit.

import { addressOf, get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { percent } from "../core/quantity.js";
import { figureButton } from "../parts/figure_settings.js";
import { alarm, chip, choiceField, list, numberField, synthetic } from "../parts/forms.js";
import { figureOf, groupCard } from "../parts/results.js";
import { numberHeadings, scrolled, tableOf } from "../parts/tables.js";

const KINDS_OF_FIGURES = [
  ["", "all figures"],
  ["corrected_radius", "corrected radius"],
  ["pad", "pad and contact"],
  ["area", "area against load"],
  ["aspect_ratio", "aspect ratio"],
  ["on_layer", "effect of a thickness"],
  ["section", "section to the bone"],
  ["budget", "uncertainty budget"],
  ["curve", "loading curves"],
  ["sequence", "sequences"],
];

/** Figures of the report. */
export async function showFigures(root) {
  const figures = await get("/results/figures");
  const grid = h("div.figure-grid");
  const draw = (kind) => {
    const isShown = (name) =>
      ["curve", "sequence"].includes(kind) ? name.startsWith(kind) : name.endsWith(kind);
    const shown = figures.filter(({ name }) => isShown(name)).map(figureCard);
    render(grid, shown.length ? shown : h("p.soft", "There are no such figures in this study."));
  };
  const choice = choiceField("Show", { options: KINDS_OF_FIGURES, onset: draw });
  render(root, [h("div.plot-bar", choice), grid]);
  draw("");
}

/** @param {Answers["FigureEntry"]} figure */
function figureCard(figure) {
  const { name, caption: words, svg } = figure;
  const save = h("a.button", { href: `${svg}?attachment=1`, "aria-label": `SVG of ${name}` }, "SVG");
  return h("figure.card", [
    h("img", { src: svg, alt: words, loading: "lazy" }),
    h("figcaption", [h("p", words), h("div.actions", [save, figureButton(figure, "")])]),
  ]);
}

/** Notes behind their title; nothing without any. @param {string[]} notes */
export const folded = (title, notes = []) =>
  notes.length > 0 && h("details.range", [h("summary", title), list(notes, "ul.note")]);

/** What a loading curve tells. */
export const curveCard = ({ title, synthetic: made, facts, verdict, doubts }) =>
  h("section.card.curve-card", { "aria-label": title }, [
    h("header", [h("h2", title), synthetic(made), chip(verdict, doubts.length ? "warn" : "good")]),
    h("dl.facts", [
      Object.entries(facts).map(([term, words]) =>
        h("div", [h("dt", /^\w+$/.test(term) ? symbol(term) : term), h("dd.number", words)]),
      ),
    ]),
    list(doubts, "ul.note"),
  ]);

/** Uncertainty budget of the corrected radius. */
export async function showBudget(root) {
  const [groups, figures] = await Promise.all([get("/results/budget"), get("/results/figures")]);
  render(root, [
    h("p.lead", [
      "Shares of the variance of the corrected radius ",
      symbol("R_g^corr"),
      ": of the pooled value, and of the highest-load contact by linear approximation and by Sobol's " +
        "total index, which includes interactions.",
    ]),
    h("div.plot-grid", [
      groups.map((group) => groupCard(group, figureOf(figures, group, "budget"), budgetOf(group))),
    ]),
  ]);
}

/** @param {Answers["BudgetGroup"]} group */
function budgetOf({ pooled, check, check_words: words }) {
  const first = pooled ?? check?.shares ?? {};
  const sources = Object.keys(first).sort((one, other) => first[other] - first[one]);
  /** @type {[words: string, shares: Record<string, number> | null, mark: string][]} */
  const every = [
    ["pooled", pooled, "measured"],
    ["highest load, linear", check?.shares, "compliance"],
    ["highest load, Sobol", check?.total, "predicted"],
  ];
  const columns = every.filter(([, shares]) => shares);
  const shareCell = (share, mark) =>
    h("td.number", [
      h("span", percent(share ?? null)),
      // A shorter bar would be a speck.
      share >= 0.01 &&
        h("i.share", { style: { background: `var(--${mark})`, width: `${Math.min(1, share) * 100}%` } }),
    ]);
  const valid = check?.valid
    ? chip("linear approximation valid", "good")
    : chip("linear approximation not valid", "warn");
  return [
    check && h("p", [h("span.number", words), " ", valid]),
    sources.length
      ? tableOf(
          "table.budget",
          ["Source", ...numberHeadings(columns.map(([words]) => words))],
          sources.map((source) =>
            h("tr", [
              h("th", { scope: "row" }, source),
              columns.map(([, shares, mark]) => shareCell(shares[source], mark)),
            ]),
          ),
        )
      : h("p.soft", "No contacts can be pooled."),
  ];
}

/** Fingers in the numbers and files that robot simulators take. */
export async function showSimulator(root) {
  const [groups, figures] = await Promise.all([get("/results/budget"), get("/results/figures")]);
  const asked = { lowest_load_N: 0.2, highest_load_N: 3, thickness_mm: null, mass_kg: 0.1 };
  const cards = h("div.plot-grid");
  const draw = () => render(cards, [groups.map((group) => simulatorCard(group, figures, asked))]);
  const field = (words, key, unit, placeholder = "") => {
    const onset = (value) => ((asked[key] = value), draw());
    return numberField(words, { value: asked[key], above: 0, placeholder, onset, unit });
  };
  render(root, [
    h(
      "p.lead",
      "What MuJoCo, Drake and Newton take for each finger, the largest error of the load over the range, " +
        "and the files that are ready to run.",
    ),
    h("div.filters", [
      field("Lowest load", "lowest_load_N", "N"),
      field("Highest load", "highest_load_N", "N"),
      field("Effective mass (MuJoCo)", "mass_kg", "kg"),
      field("Thickness", "thickness_mm", "mm", "of the study"),
    ]),
    cards,
  ]);
  draw();
}

let turn = Promise.resolve();

/** @param {Answers["BudgetGroup"]} group @param {Answers["FigureEntry"][]} figures */
function simulatorCard(group, figures, asked) {
  const { finger, wedge_angle_deg: wedge } = group;
  const query = { finger, wedge_angle_deg: wedge.value, ...asked };
  const link = {
    href: addressOf("/results/simulator/file", query),
    "aria-label": `Files of ${finger}, wedge ${wedge.words}`,
    download: "",
  };
  const files = h("div.actions", h("a.button", link, "Files (ZIP)"));
  // As tall as the numbers will be, so that no more cards are in view than then.
  const waiting = h("p.soft", { role: "status", style: { minHeight: "26rem" } }, "Computing …");
  const body = h("div.stack-small", waiting);
  const compute = async () => {
    if (!body.isConnected) return;
    const found = await get("/results/simulator", /** @type {any} */ (query)).catch((error) => error);
    render(body, found instanceof Error ? alarm(found.message) : [simulatorNumbers(found), files]);
  };
  // Those in view, one after the other, as long as they are shown: each takes the server a while.
  new IntersectionObserver((seen, watcher) => {
    if (!seen.some(({ isIntersecting }) => isIntersecting)) return;
    watcher.disconnect();
    turn = turn.then(compute);
  }).observe(body);
  // Of the curves of this finger and angle, the first that has the figure.
  const drawn = figures.find(({ name }) => name.replace(/^curve\d+_/, "") === `${group.figure}_simulator`);
  return groupCard(group, drawn, [
    drawn && h("img", { src: drawn.svg, alt: drawn.caption, loading: "lazy" }),
    body,
  ]);
}

/** @param {Answers["SimulatorNumbers"]} found */
const simulatorNumbers = ({ source, model, targets, notes }) => [
  h("p", `The whole pad by the ${model}, which the simulators are to follow. ${source}.`),
  tableOf(
    "table.budget",
    ["Simulator", "Value", ...numberHeadings(["Largest error of load", "Area factor"])],
    targets.map(({ name, value, worst_relative_error: error, area_factor: factor, assumes }) =>
      h("tr", { title: `Assumes ${assumes}` }, [
        h("th", { scope: "row" }, name),
        h("td", value),
        h("td.number", `${Number((100 * error).toPrecision(2))} %`),
        h("td.number", factor === null ? "–" : `× ${factor.toFixed(2)}`),
      ]),
    ),
  ),
  list(notes, "ul.note"),
];

const MISPRINT = "reproduced with the known misprint";
const VERDICTS = { reproduced: "good", [MISPRINT]: "accent" };

/** The numbers printed by Dzidek et al. (2017) compared with what their equations give. */
export async function showAudit(root) {
  const numbers = await get("/api/published");
  const count = (wanted) => numbers.filter(({ verdict }) => verdict === wanted).length;
  const headings = numberHeadings(["Printed", "Computed", "Rounding range", "With misprint"]);
  render(root, [
    h(
      "p.lead",
      `Supplement of Dzidek et al. (2017): ${numbers.length} published numbers compared with the values ` +
        `that its equations give. ${count("reproduced")} are reproduced, ${count(MISPRINT)} with a ` +
        "known misprint, and the others are not reproducible from the published values.",
    ),
    scrolled(
      "Audit of the published tables",
      tableOf("table.audit", ["Item", ...headings, "Verdict", "Formula"], numbers.map(auditRow)),
    ),
  ]);
}

/** @param {Answers["AuditedNumber"]} number */
function auditRow({ item, printed, computed, range, with_misprint, verdict, formula, remark }) {
  return h("tr", [
    h("th", { scope: "row" }, item),
    [printed, computed, range, with_misprint].map((words) => h("td.number", words)),
    h("td", chip(verdict, VERDICTS[verdict] ?? "warn")),
    h("td.formula", [formula && h("code", formula), remark && h("p.soft", remark)]),
  ]);
}
