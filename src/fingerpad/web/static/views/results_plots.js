// Charts of each finger and placement against load, with R_0g and R_g as lines.

import { contactAddress, get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { short } from "../core/quantity.js";
import { chart, colour, forget, prepareCharts } from "../parts/chart.js";
import { alarm, choiceField, list } from "../parts/forms.js";
import { poolingList } from "../parts/pooling.js";
import { figureOf, groupCard, verdictChip } from "../parts/results.js";
import { curveCard, folded } from "./results_parts.js";

const RADIUS = "radius_from_indentation_mm";
const COMPARED = "radius_from_compliance_mm";

// Quantities plotted against load, as the report has them: key, name, axis title, and whether from zero.
/** @type {[key: string, name: string, axis: string, fromZero?: boolean][]} */
const QUANTITIES = [
  ["gross_area_mm2", "contact area", "contact area A (mm²)", true],
  ["youngs_modulus_kpa", "Young's modulus", "Young's modulus E (kPa)", true],
  [RADIUS, "corrected radius", "corrected radius (mm)"],
  ["indentation_mm", "indentation", "indentation ξ (mm)", true],
  ["aspect_ratio", "aspect ratio", "aspect ratio ℓd/ℓe"],
];

// The figures of the report that show them, by the end of their names.
const FIGURES = { [RADIUS]: "corrected_radius", gross_area_mm2: "area", aspect_ratio: "aspect_ratio" };

// Quantities that the whole pad on its layer of tissue has too.
const ON_LAYER = {
  indentation_mm: "indentation_on_layer_mm",
  youngs_modulus_kpa: "youngs_modulus_on_layer_kpa",
};

// As in the figures of the report.
const FADED = 0.4;

const WITH_MODEL = "standard uncertainty with what the model leaves uncertain";
const BARS = [
  ["all", "all uncertainties"],
  ["given", "fixed pad geometry, as in Dzidek et al. (2017)"],
];

/** Whether a quantity is known of any contact of a group. @param {Answers["PlottedGroup"]} group */
const isThere = ({ points }, key) => points[key].some(({ value }) => value !== null);

/** What the report says; nothing where it is of an earlier version. */
const advice = () => get(/** @type {any} */ ("/download/report.json")).catch(() => /** @type {any} */ ({}));

/** The groups with one quantity: all of them take long to send of many contacts. */
const read = (quantity) => get("/results/plot", { quantity });

export class Plots {
  /** @type {Answers["PlottedGroup"][]} */
  groups = [];
  /** @type {Answers["FigureEntry"][]} */
  figures = [];

  constructor(root) {
    this.root = root;
    this.finger = "";
    this.bars = "all";
    this.quantity = QUANTITIES[0][0];
    this.drawn = new Set();
  }

  async load() {
    prepareCharts(); // meanwhile
    [this.groups, this.figures] = await Promise.all([read(this.quantity), get("/results/figures")]);
    const said = this.figures.length ? await advice() : {}; // both are the report's
    const fingers = [...new Set(this.groups.map(({ finger }) => finger))];
    const warning =
      said.check?.length > 0 && h("div.note", [h("strong", "Check the results"), list(said.check)]);
    const rest = [
      said.curves?.length > 0 && [h("h2", "Loading curves"), h("div.plot-grid", said.curves.map(curveCard))],
      folded("To measure better", said.better),
      folded("What is exact, assumed or missing: the ± leave out what that would add", said.missing),
    ];
    if (!this.groups.length) {
      const words = "There are no contacts in these results: a plot needs finger, angle, load and scale. ";
      const none = h("p.lead", [words, h("a", { href: "#/study" }, "See the Study page.")]);
      render(this.root, [warning, none, rest]);
      return;
    }
    this.grid = h("div.plot-grid");
    const set = (change) => {
      Object.assign(this, change);
      this.#draw();
    };
    const choice = (label, key, options, onset = (value) => set({ [key]: value })) =>
      choiceField(label, { value: this[key], options, onset });
    render(this.root, [
      warning,
      h("div.plot-bar", [
        choice("Against load", "quantity", QUANTITIES, async (quantity) =>
          set({ groups: await read(quantity), quantity }),
        ),
        choice("Finger", "finger", [["", "all fingers"], ...fingers]),
        choice("Error bars (standard uncertainty)", "bars", BARS),
        (this.legend = h("div.legend", { "aria-label": "Legend" })),
      ]),
      this.grid,
      rest,
    ]);
    this.watcher = new IntersectionObserver(
      (entries) => {
        for (const { isIntersecting, target } of entries) if (isIntersecting) this.#plot(target);
      },
      { rootMargin: "400px" },
    );
    this.#draw();
  }

  #draw() {
    for (const node of this.drawn) forget(node);
    this.drawn.clear();
    const groups = this.groups.filter(({ finger }) => !this.finger || finger === this.finger);
    render(this.legend, this.#legend(groups));
    render(this.grid, [groups.map((group) => this.#card(group))]);
    for (const node of this.grid.querySelectorAll(".chart")) this.watcher.observe(node);
  }

  /**
   * What the marks of the drawn quantity are, of those that are there.
   *
   * @param {Answers["PlottedGroup"][]} groups
   */
  #legend(groups) {
    const hollow = [
      groups.some((group) => group.synthetic) && h("span", "hollow circles: synthetic"),
      groups.some(({ pooled }) => pooled.includes(false)) && h("span", "faded: left out of the pool"),
    ];
    const any = (key) => groups.some((group) => isThere(group, key));
    if (this.quantity !== RADIUS) {
      const onLayer = ON_LAYER[this.quantity];
      return [
        onLayer &&
          any(onLayer) && [
            h("span", [h("i.dot-mark"), "Hertz theory"]),
            h("span", [h("i.square-mark"), "on the layer over bone"]),
          ],
        hollow,
      ];
    }
    const loading = groups.some((group) => group.loading_radius_mm.value !== null);
    return [
      h("span", [h("i.dot-mark"), symbol("R_g^corr")]),
      any(COMPARED) &&
        h("span", [h("i.square-mark"), symbol("R_Aξ"), loading && [", compare with ", symbol("R_g")]]),
      h("span", [h("i.line-mark.dotted"), symbol("R_0g"), ", undeformed pad"]),
      loading && h("span", [h("i.line-mark.dashed"), symbol("R_g"), ", from loading data"]),
      hollow,
    ];
  }

  /** @param {Answers["PlottedGroup"]} group */
  #card(group) {
    const why = this.#why(group);
    const node = why ? h("p.soft", why) : h("div.chart", { role: "img", "aria-label": this.#words(group) });
    node.group = group;
    const checks = group.checks.map(([, words]) => words);
    const fact = (label, { value, words }) =>
      value !== null && h("div", [h("dt", label), h("dd.number", words)]);
    return groupCard(
      group,
      figureOf(this.figures, group, FIGURES[this.quantity]),
      [
        h("p.answer", group.answer),
        h("dl.facts", [
          group.radius_from_indentation_mm.value !== null &&
            h("div.main-fact", [
              h("dt", [symbol("R_g^corr"), ", pooled"]),
              h("dd.number", { title: group.radius_of_model ? WITH_MODEL : "" }, [
                group.radius_from_indentation_mm.words,
                " ",
                verdictChip(group.radius_verdict, group.checks, "radius "),
              ]),
            ]),
          fact(symbol("R_0g"), group.mean_curvature_radius_mm),
          fact(symbol("R_g"), group.loading_radius_mm),
        ]),
        poolingList(group.pooling),
        node,
        folded(`Does the model hold? ${group.verdict}`, checks),
        folded(`Doubtful values (${group.doubts.length})`, group.doubts),
      ],
      "section.card.plot-card",
    );
  }

  /** Why there is nothing to plot; empty if there is. @param {Answers["PlottedGroup"]} group */
  #why({ items, load_N: load, points }) {
    const [key, words] = QUANTITIES.find(([each]) => each === this.quantity);
    const drawn = [key, ON_LAYER[key], key === RADIUS && COMPARED].filter(Boolean);
    const there = (index) => load[index] !== null && drawn.some((each) => points[each][index].value !== null);
    if (items.some((_, index) => there(index))) return "";
    return [
      `No contact here has a ${words} to plot; `,
      h("a", { href: "#/results/table" }, "the table"),
      " says what each lacks.",
    ];
  }

  /** @param {Answers["PlottedGroup"]} group */
  #words(group) {
    const [key, words] = QUANTITIES.find(([each]) => each === this.quantity);
    const values = group.points[key].map(({ value }) => value).filter((value) => value !== null);
    const ends = [Math.min(...values), Math.max(...values)].map((end) => short(end));
    return `Chart of ${words} against load: ${values.length} values from ${ends.join(" to ")}`;
  }

  async #plot(node) {
    if (this.drawn.has(node)) return;
    this.drawn.add(node);
    /** @type {Answers["PlottedGroup"]} */
    const group = node.group;
    const { items, points } = group;
    const [measured, compliance, panel, ink] = ["measured", "compliance", "panel", "undeformed"].map(colour);
    const radius = this.quantity === RADIUS;
    const [key, words, title, fromZero] = QUANTITIES.find(([each]) => each === this.quantity);
    const drawn = points[radius && this.bars === "given" ? `${RADIUS}_fixed_geometry` : key];
    const layerKey = ON_LAYER[key];
    const crowded = items.length > 80;
    // An outline wider than the circle, which would hide a square of nearly the same value.
    const opacity = group.pooled.map((pooled) => (pooled ? 1 : FADED));
    const square = {
      symbol: "square",
      color: "transparent",
      size: crowded ? 7 : 14,
      line: { color: compliance, width: 1.4 },
      opacity,
    };
    const bars = { type: "data", thickness: 1.4, width: crowded ? 0 : 4 };
    /** @type {(quantities: Answers["Quantity"][], name: string, marker: object, bars?: string) => object} */
    const trace = (quantities, name, marker, color) => ({
      x: group.load_N,
      y: quantities.map(({ value }) => value),
      error_y: color && { ...bars, array: quantities.map(({ std }) => std), color },
      mode: "markers",
      type: "scatter",
      marker,
      hovertemplate: quantities.map(
        ({ words }) => `%{text}<br>W = %{x:.3g} N<br>${name}${words}<extra></extra>`,
      ),
      text: items,
    });
    const circle = {
      color: group.synthetic ? panel : measured,
      size: crowded ? 4 : 8.5,
      line: { color: measured, width: 1.6 },
      opacity,
    };
    const traces = [
      radius && trace(points[COMPARED], "R_Aξ = ", square),
      layerKey &&
        isThere(group, layerKey) &&
        trace(points[layerKey], `${words} on layer: `, square, compliance),
      trace(drawn, `${words}: `, circle, measured),
    ].filter(Boolean);
    const lines = [
      { label: "<i>R</i><sub>0g</sub>", value: group.mean_curvature_radius_mm.value, dash: "dot" },
      { label: "<i>R</i><sub>g</sub>", value: group.loading_radius_mm.value, dash: "dash" },
    ].filter(({ value }) => radius && value !== null);
    // The label of the upper line stands above it, the other below, as they may lie close together.
    const [one, other] = lines.map(({ value }) => value);
    const upper = one >= other ? 0 : 1;
    try {
      await chart(node, traces, {
        x: "normal load W (N)",
        y: title,
        fromZero,
        shapes: lines.map(({ value, dash }) => ({
          type: "line",
          xref: "paper",
          x0: 0,
          x1: 1,
          y0: value,
          y1: value,
          line: { color: ink, width: 1.3, dash },
        })),
        annotations: lines.map(({ label, value }, k) => ({
          yshift: lines.length > 1 ? (k === upper ? 8 : -8) : 0,
          xref: "paper",
          x: 1.01,
          xanchor: "left",
          y: value,
          text: `${label} ${short(value)}`,
        })),
        chosen: ({ pointIndex }) => {
          const item = items[pointIndex];
          location.hash = contactAddress(item, item.includes("#") ? item.split("#")[0] : null);
        },
      });
    } catch (error) {
      render(node, alarm(error.message));
    }
  }

  theme() {
    const drawn = [...this.drawn];
    this.drawn.clear();
    for (const node of drawn) this.#plot(node);
  }

  close() {
    this.watcher?.disconnect();
    for (const node of this.drawn) forget(node);
  }
}
