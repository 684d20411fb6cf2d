// The numbers of one contact beside the program's own, its settings, its decision and its history.

import { wordsFor } from "../core/bench.js";
import { wordsOf } from "../core/corrections.js";
import { h, place, symbol } from "../core/dom.js";
import { ago, BY, plain, quantityText, reading } from "../core/quantity.js";
import { button, check, chip, choose, field, number, synthetic, text } from "../parts/forms.js";

const READINGS = [
  ["semi_major_mm", () => ["Semi-major ", symbol("ℓ", "d")], "semi-major axis of the ellipse", "ellipse"],
  ["semi_minor_mm", () => ["Semi-minor ", symbol("ℓ", "e")], "semi-minor axis of the ellipse", "ellipse"],
  ["gross_area_mm2", () => "Gross area", "inside the outline of the contact", "region"],
  ["ridge_area_mm2", () => "Ridge area", "area of the ridges in contact", "ridges"],
];

const MODEL = [
  ["mean_curvature_radius_mm", () => ["Undeformed pad ", symbol("R", "0g")], "1/H of the undeformed pad where it touches"],
  ["radius_from_compliance_mm", () => ["Same area and depth ", symbol("R", "Aξ")], "sphere of the same area at the same indentation: to compare with the radius from loading data"],
  ["indentation_mm", () => ["Indentation ", symbol("ξ")], "indentation that Hertz theory gives for load and ellipse"],
  ["youngs_modulus_kpa", () => ["Young's modulus ", symbol("E")], "Young's modulus that Hertz theory gives"],
];

const REASONS = ["smeared", "slipped", "cut off", "wrong finger", "no contact"];

export class ContactInspector {
  constructor(view) {
    this.view = view;
    this.parts = Object.fromEntries(["head", "tool", "numbers", "settings", "history"].map((name) => [name, h("section", { "data-part": name })]));
    this.why = text({ value: "", placeholder: "why it is no good", list: "reasons" });
    this.root = h("div.stack", null, Object.values(this.parts), h("datalist", { id: "reasons" }, REASONS.map((value) => h("option", { value }))));
    this.footer = h("div.footer", null, this.#decision());
  }

  reason() {
    return this.why.value.trim() || "rejected by eye";
  }

  head() {
    const { entry, lines } = this.view.context();
    place(
      this.parts.head,
      h("div.headline", null, h("h2", null, entry.frame === undefined ? entry.item : `Frame ${entry.frame}`), h("span", null, synthetic(entry.synthetic ?? this.view.film?.synthetic))),
      h("p.context", null, lines.join(" · ")),
    );
  }

  wait() {
    this.head();
    place(this.parts.numbers, h("p.loading", null, "Measuring …"));
    this.tool();
  }

  show(answer, problem) {
    if (!answer) {
      place(this.parts.numbers, h("h3", null, "Result"), h("p.note.bad", { role: "alert" }, problem), h("p.soft", null, "Another threshold, polarity, seed point or a brush may help; otherwise reject the picture."));
      this.settings(null);
      return;
    }
    const { numbers, program, model } = answer;
    const corrected = answer.by !== "program";
    const line = ([key, label, words, mark]) => reading(label(), quantityText(numbers, key), { mark, title: words, was: corrected && program ? quantityText(program.numbers ?? program, key) : undefined });
    place(
      this.parts.numbers,
      model &&
        h(
          "div.headline.main-number",
          null,
          h("span", null, "Corrected radius ", symbol("R", "g", "corr")),
          h("span.figure-big.number", { "data-live": "radius" }, quantityText(model, "radius_from_indentation_mm")),
        ),
      h("div.headline", null, h("h3", null, "Contact"), chip(BY[answer.by] ?? answer.by, corrected ? "accent" : "")),
      h(
        "dl.readings",
        { "data-live": "numbers" },
        READINGS.map(line),
        reading("Ridge period", quantityText(numbers, "ridge_period_mm")),
        reading("Ellipse over region", numbers.ellipse_iou === null || numbers.ellipse_iou === undefined ? "–" : plain(numbers.ellipse_iou), { title: "area common to both over the area that either covers: 1 is perfect" }),
      ),
      model && [h("h3", null, "Model"), h("dl.readings", null, MODEL.map(([key, label, words]) => reading(label(), quantityText(model, key), { title: words })))],
      !model && h("p.soft", null, "The corrected radius appears once the finger's semi-axes are known: run the study."),
      answer.flags.filter((flag) => flag !== "edited_by_person").length > 0 && h("div.note", null, h("ul", null, answer.flags.filter((flag) => flag !== "edited_by_person").map((flag) => h("li", null, wordsFor(flag))))),
      notesOf(model).length > 0 && h("details", null, h("summary", null, `Where the model ends (${notesOf(model).length})`), h("ul.note", null, notesOf(model).map((code) => h("li", null, wordsFor(code))))),
    );
    this.settings(answer);
  }

  settings(answer) {
    const { change } = this.view.corrections;
    const used = answer?.settings ?? {};
    place(
      this.parts.settings,
      h("h3", null, "How it is read"),
      h(
        "div.fields",
        null,
        field(
          "Polarity",
          choose({
            value: change.dark_on_light === undefined || change.dark_on_light === null ? "" : String(change.dark_on_light),
            options: [
              ["", used.dark_on_light === undefined ? "program's choice" : `program: ${used.dark_on_light ? "dark" : "light"}`],
              ["true", "dark ridges on light"],
              ["false", "light ridges on dark"],
            ],
            onset: (value) => this.view.set("dark_on_light", value === "" ? null : value === "true"),
          }),
        ),
        field(
          "Threshold",
          number({ value: change.threshold ?? null, min: 0, placeholder: used.threshold === undefined || used.threshold === null ? "program's" : `program: ${plain(used.threshold)}`, onset: (value) => this.view.set("threshold", value) }),
        ),
      ),
      h(
        "div.actions",
        null,
        change.seed_px && button("Forget seed point", () => this.view.set("seed_px", null), { kind: "small" }),
        change.region_of_interest_px && button("Forget region of interest", () => this.view.set("region_of_interest_px", null), { kind: "small" }),
        change.ellipse_px && button("Ellipse from region", () => this.view.set("ellipse_px", null), { kind: "small" }),
        change.strokes?.length > 0 && button("Forget brush", () => this.view.set("strokes", null), { kind: "small" }),
      ),
      check("Show the program's own outline", { onset: (on) => this.view.showOwn(on) }),
    );
  }

  tool() {
    const { tool, radius } = this.view;
    const brushing = tool === "add" || tool === "remove";
    this.parts.tool.hidden = !brushing && tool === "ellipse";
    if (brushing) {
      const slider = h("input", { type: "range", min: 1, max: 100, value: radius, oninput: () => this.view.setRadius(Number(slider.value)) });
      if (this.slider && this.parts.tool.contains(this.slider)) {
        this.slider.value = radius;
        this.unit.textContent = `${radius} px`;
        if (this.parts.tool.dataset.tool === tool) return;
      }
      this.slider = slider;
      const control = field(tool === "add" ? "Brush that adds: radius" : "Brush that takes away: radius", slider, { unit: `${radius} px`, hint: "[ and ] change it. Hold Alt for the other brush." });
      this.unit = control.querySelector(".unit");
      place(this.parts.tool, control);
      this.parts.tool.dataset.tool = tool;
    } else {
      place(this.parts.tool, h("p.soft", null, tool === "seed" ? "Click a point inside the right patch." : "Draw a box round what should be measured."));
      this.parts.tool.dataset.tool = tool;
    }
  }

  #decision() {
    this.buttons = {
      accept: button("Accept and next", () => this.view.accept(), { kind: "primary", key: "Enter" }),
      undo: button("Undo", () => this.view.undo(), { key: "u" }),
      redo: button("Redo", () => this.view.redo(), { key: "r" }),
      reject: button("Reject", () => this.view.reject(), { kind: "bad", key: "x" }),
      revert: button("Back to the program", () => this.view.revert(), { kind: "small", title: "Take back all corrections of this picture; they stay in its history" }),
    };
    const { accept, undo, redo, reject } = this.buttons;
    return [h("div.decision", null, accept, undo, redo, reject), h("label.why", null, h("span", null, "Reason to reject"), this.why)];
  }

  corrected() {
    const { document, change } = this.view.corrections;
    this.buttons.undo.disabled = !document.can_undo;
    this.buttons.redo.disabled = !document.can_redo;
    this.buttons.revert.disabled = !Object.keys(change).length;
    place(this.buttons.reject, change.rejected ? "Take back" : "Reject", h("kbd", { "aria-hidden": "true" }, "x"));
    this.buttons.accept.classList.toggle("accepted", Boolean(change.accepted));
    const records = [...document.history].reverse();
    place(
      this.parts.history,
      h("div.headline", null, h("h3", null, "History"), this.buttons.revert),
      h("div.chips", null, change.accepted && chip("accepted", "good"), change.rejected && chip(`rejected: ${change.rejected}`, "bad")),
      records.length
        ? h("ol.history", { tabindex: 0, "aria-label": "History of corrections" }, records.map((record) => h("li", null, h("span", null, wordsOf(record)), h("time", { datetime: record.when, title: record.when }, `${record.who || "unknown"}, ${ago(record.when)}`))))
        : h("p.soft", null, "As the program measured it."),
    );
  }
}

const notesOf = (model) => (Array.isArray(model?.range_notes) ? model.range_notes : (model?.range_notes ?? "").split(" ").filter(Boolean));
