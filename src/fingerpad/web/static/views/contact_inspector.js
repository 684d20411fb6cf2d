// Results, settings and history of a contact image, with the automatic result to compare.

import { h, render, small } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { quantityRow, quantityRows, short, signedPercent } from "../core/quantity.js";
import { adviseCode, who } from "../core/workspace.js";
import { Histogram } from "../editor/histogram.js";
import { alarm, check, chip, choiceField, numberField, segments, synthetic } from "../parts/forms.js";
import { SURFACES, staleChip } from "../parts/missing_fields.js";
import { poolingOf } from "../parts/pooling.js";
import { verdictChip } from "../parts/results.js";
import { tableOf } from "../parts/tables.js";
import { flagNote, Inspector } from "./inspector.js";
import { SHARED } from "./similar.js";

/** @type {Shown[]} */
const MEASURED = [
  ["semi_major_mm", "Semi-major", "ℓ_d", "semi-major axis of the ellipse", "ellipse"],
  ["semi_minor_mm", "Semi-minor", "ℓ_e", "semi-minor axis of the ellipse", "ellipse"],
  ["gross_area_mm2", "Gross area", "", "area inside the outline of the contact", "region"],
];
/** @type {Shown[]} */
const RIDGES = [
  ["ridge_area_mm2", "Ridge area", "", "area of the ridges in contact", "ridges"],
  ["ridge_period_mm", "Ridge period", "", ""],
];
const SPHERE = "sphere with the same area at the same indentation; compare with the radius from loading data";
/** @type {Shown[]} */
const MODEL = [
  ["mean_curvature_radius_mm", "Undeformed pad", "R_0g", "1/H of the undeformed pad at the contact"],
  ["radius_from_compliance_mm", "Equivalent sphere", "R_Aξ", SPHERE],
  ["indentation_mm", "Indentation", "ξ", "indentation by Hertz theory from load and ellipse"],
  ["youngs_modulus_kpa", "Young's modulus", "E", "Young's modulus by Hertz theory"],
];
const EXPECTED = "A/(πξ) of the whole pad on the layer; compare with the radius from loading data";
/** Beside the model, where the finger's thickness is stated. @type {Shown[]} */
const ON_LAYER = [
  ["youngs_modulus_on_layer_kpa", "Young's modulus", "E", "of the pad on the layer, from load and area"],
  ["indentation_on_layer_mm", "Indentation", "ξ", "of the pad on the layer, from the area"],
  ["loading_radius_on_layer_mm", "Expected", "R_g", EXPECTED],
];

/** Whether Hertz theory held for a quantity in the last run. */
const verdictOf = ({ verdicts }, key) => key in verdicts && verdictChip(verdicts[key]);

const ALT = "[ and ] change it; Alt switches between adding and removing.";
const TRY = "Try another threshold, polarity, seed point or the brush; otherwise reject the image.";
const REASONS = ["smeared", "slipped", "cropped", "wrong finger", "no contact"];

export class ContactInspector extends Inspector {
  tools = {
    add: { brush: "Radius of the brush that adds", hint: ALT },
    remove: { brush: "Radius of the brush that removes", hint: ALT },
    threshold: { words: h("div.stack-small", h("h3", "Threshold")) },
    lasso: { words: this.#areaTool("lasso", "Draw around an area in one stroke.") },
    polygon: {
      words: this.#areaTool(
        "polygon",
        "Click corner by corner; the first corner, or Enter, closes it. Backspace takes one back, Esc all.",
      ),
    },
    seed: { words: h("p.soft", "Click a point inside the contact.") },
    box: { words: h("p.soft", "Draw a box around the contact.") },
  };

  constructor(view) {
    super(view, ["agreement", "numbers"], REASONS);
    this.parts.agreement.hidden = !view.blind;
    this.histogram = new Histogram({
      tried: (threshold) => view.tryThreshold(threshold),
      set: (threshold) => view.setThreshold(threshold),
    });
    this.tools.threshold.words.append(this.histogram.root);
  }

  /** What an area that is drawn around does, and how it is drawn. */
  #areaTool(name, hint) {
    const actions = segments(
      `What the ${name} does`,
      [
        ["replace", "Is the contact"],
        ["add", "Add"],
        ["remove", "Remove"],
      ],
      "replace",
      (action) => this.view.setAction(action),
    );
    return h("div.stack-small", [actions, h("p.soft", hint)]);
  }

  tool() {
    super.tool();
    /** @type {HTMLElement | null} */
    const actions = this.parts.tool.querySelector("[role=radiogroup]");
    actions?.show(this.view.action);
    if (this.view.tool === "threshold") this.histogram.input.focus({ preventScroll: true });
  }

  /**
   * Show the histogram with the threshold that a person set.
   *
   * @param {Answers["ContactLevels"] | null} levels
   * @param {number | null} threshold
   */
  levels(levels, threshold) {
    this.histogram.root.hidden = levels === null;
    if (levels !== null) this.histogram.show(levels, threshold);
  }

  /** Whether the contact has no ridges, as its table or the study says. */
  isSmooth() {
    return (this.view.sequence ?? this.view.entry)?.surface === "smooth";
  }

  /** Change the table of the contact, or of the sequence. */
  #setSurface(surface) {
    const { sequence, entry } = this.view;
    const [kind, key] = sequence ? ["sequence", sequence.name] : ["observation", entry.item];
    this.edit(/** @type {Edit} */ ({ kind, key, set: { surface } }));
  }

  head() {
    const { entry, lines } = this.view.context();
    render(this.parts.head, [
      h("div.headline", [
        h("h2", entry.frame === undefined ? entry.item : `Frame ${entry.frame}`),
        h("span", [
          this.isSmooth() && chip("smooth surface"),
          synthetic(entry.synthetic ?? this.view.sequence?.synthetic),
        ]),
      ]),
      h("p.context", lines.join(" · ")),
    ]);
  }

  wait() {
    this.head();
    render(this.parts.numbers, h("p.loading", "Measuring …"));
    this.tool();
  }

  /** Before the second operator has outlined anything. */
  blind() {
    render(this.parts.numbers, [
      h("h3", "Contact"),
      h("p", "Outline the contact by lasso, polygon or threshold. No other outline is shown."),
    ]);
    this.settings(null);
  }

  corrected() {
    super.corrected();
    if (this.view.blind) render(this.parts.agreement, agreementOf(this.view.agreement));
  }

  /** @param {ContactMeasurement | null} answer @param {string} [problem] */
  show(answer, problem) {
    if (!answer) {
      render(this.parts.numbers, [
        h("h3", "Result"),
        alarm(problem),
        !this.view.lacking?.length && !this.view.unreached && h("p.soft", TRY),
      ]);
      this.settings(null);
      return;
    }
    const { numbers, automatic, model } = answer;
    const corrected = answer.by !== "automatic" && !this.view.blind;
    const outOfDate = () =>
      staleChip((this.view.sequence ?? this.view.entry).finger, "semi-axes out of date");
    const shown = [...MEASURED, ...(this.isSmooth() ? [] : RIDGES)];
    const title = "intersection over union; 1 is a perfect match";
    render(this.parts.numbers, [
      model &&
        h("div.headline.main-number", [
          h("span", ["Corrected radius ", symbol("R_g^corr")]),
          h(
            "span.figure-big.number",
            { "data-live": "radius" },
            model.numbers.radius_from_indentation_mm.words,
          ),
          verdictOf(model, "radius_from_indentation_mm"),
          outOfDate(),
        ]),
      h("div.headline", [h("h3", "Contact"), chip(answer.by, corrected ? "accent" : "")]),
      h("dl.readings", { "data-live": "numbers" }, [
        quantityRows(shown, numbers, { automatic: corrected ? automatic : null }),
        quantityRow([symbol("IoU"), " of ellipse and region"], numbers.ellipse_iou.words, { title }),
      ]),
      model && [
        h("div.headline", [h("h3", layered(model) ? "Model, Hertz theory" : "Model"), outOfDate()]),
        h("dl.readings", quantityRows(MODEL, model.numbers, { beside: (key) => verdictOf(model, key) })),
      ],
      layered(model) && [
        h("h3", `Model, ${model.numbers.effective_thickness_mm.words} of tissue over bone`),
        h("dl.readings", { "data-live": "layer" }, quantityRows(ON_LAYER, model.numbers)),
        model.layer_flag && h("p.soft", `Out of range. ${adviseCode(model.layer_flag)}`),
      ],
      !model &&
        h("p.soft", [
          this.view.lacking?.length
            ? "The corrected radius needs what is missing above."
            : answer.waits
              ? "Measuring the photographs of the finger …"
              : "The corrected radius needs the finger's semi-axes: see Study and Photographs.",
        ]),
      flagNote(answer.flags),
      answer.pooling &&
        !this.view.blind &&
        !this.view.corrections.change.rejected &&
        poolingOf(answer.pooling, (pooling) => this.view.decidePooling(pooling)),
      model?.range_notes.length > 0 &&
        h("details", [
          h("summary", `Doubtful values (${model.range_notes.length})`),
          flagNote(model.range_notes),
        ]),
    ]);
    this.settings(answer);
  }

  /** @param {ContactMeasurement | null} answer */
  settings(answer) {
    const { change } = this.view.corrections;
    const smooth = this.isSmooth();
    this.drawSettings(
      [
        choiceField("Polarity", {
          value: String(change.dark_on_light ?? ""),
          options: [
            ["", answer === null ? "automatic" : `automatic: ${answer.dark_on_light ? "dark" : "light"}`],
            ["true", smooth ? "dark contact on light" : "dark ridges on light"],
            ["false", smooth ? "light contact on dark" : "light ridges on dark"],
          ],
          onset: (value) => this.view.set("dark_on_light", value === "" ? null : value === "true"),
        }),
        !this.view.blind &&
          choiceField(this.view.sequence ? "Surface (sequence)" : "Surface", {
            value: smooth ? "smooth" : "ridged",
            options: SURFACES,
            onset: (value) => this.#setSurface(value),
          }),
        // A threshold tells ridges from valleys; one that was set can be seen and taken back.
        (!smooth || typeof change.threshold === "number") &&
          numberField("Threshold, grey levels", {
            value: change.threshold ?? null,
            min: 0,
            placeholder: answer?.threshold == null ? "automatic" : `automatic: ${short(answer.threshold)}`,
            onset: (value) => this.view.set("threshold", value),
          }),
      ],
      this.view.sequence &&
        answer &&
        check("Key frame: carry this ellipse to the frames up to the next one (k)", {
          checked: Boolean(change.key_frame),
          onset: (on) => this.view.setKeyFrame(on),
        }),
      this.resetButtons("threshold", "seed_px", "region_of_interest_px", "ellipse_px", "strokes"),
      this.view.source === "images" &&
        SHARED.some((key) => change[key] !== undefined && change[key] !== null) &&
        small("Apply to similar images …", () => this.view.applyToSimilar()),
      !this.view.blind && check("Show the automatic outline", { onset: (on) => this.view.showAutomatic(on) }),
    );
  }
}

/** @param {ContactMeasurement["model"]} model */
const layered = (model) => typeof model?.numbers.effective_thickness_mm.value === "number";

/** @type {["semi_major_mm" | "semi_minor_mm" | "gross_area_mm2" | "ridge_area_mm2", string][]} */
const AGREEMENT = [
  ["gross_area_mm2", "Gross area"],
  ["ridge_area_mm2", "Ridge area"],
  ["semi_major_mm", "Semi-major"],
  ["semi_minor_mm", "Semi-minor"],
];

/** How the second operator agrees with the first. @param {Answers["SecondOperator"]} state */
function agreementOf({ first_operators: first, agreement, unseen }) {
  return [
    h("h3", "Second operator"),
    first.includes(who()) &&
      alarm(
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
        h("p.number", `n = ${one.count}, IoU ${one.iou_mean.toFixed(3)} (least ${one.iou_least.toFixed(3)})`),
        tableOf(
          "table.agreement",
          ["", "Bias", "Limits of agreement"],
          AGREEMENT.map(([key, words]) => {
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
