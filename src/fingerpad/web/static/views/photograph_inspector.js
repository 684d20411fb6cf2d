// The numbers of one face, and of the pad that all faces of the finger give together.

import { wordsFor } from "../core/bench.js";
import { wordsOf } from "../core/corrections.js";
import { h, place, s } from "../core/dom.js";
import { ago, BY, plain, probability, quantityText, reading, withStd } from "../core/quantity.js";
import { button, chip, choose, field, synthetic, text } from "../parts/forms.js";
import { scaleWords } from "../parts/scale_choice.js";

const NAMES = { palmar: "Palmar", distal: "Distal", radial_ulnar: "Radial–ulnar" };
const SIDES = [
  ["", "as the study says"],
  ["up", "up"],
  ["down", "down"],
  ["left", "left"],
  ["right", "right"],
];

export class PhotographInspector {
  constructor(view) {
    this.view = view;
    this.parts = Object.fromEntries(["head", "tool", "pad", "face", "settings", "history"].map((name) => [name, h("section", { "data-part": name })]));
    this.why = text({ value: "", placeholder: "why it is no good" });
    this.root = h("div.stack", null, Object.values(this.parts));
    this.parts.tool.hidden = true;
    this.footer = h("div.footer", null, this.#decision());
  }

  reason() {
    return this.why.value.trim() || "rejected by eye";
  }

  wait() {
    const { finger, face, scale, file, synthetic: made } = this.view.entry;
    place(this.parts.head, h("div.headline", null, h("h2", null, `${finger}, ${face} face`), synthetic(made)), h("p.soft", null, `${file} · scale ${scaleWords(scale)}`));
    place(this.parts.face, h("p.loading", null, "Finding the outline …"));
    place(this.parts.pad);
    this.tool();
  }

  show(answer, problem, own) {
    if (!answer) {
      place(this.parts.face, h("p.note.bad", { role: "alert" }, problem), h("p.soft", null, "Draw a region of interest round the fingertip, or add points on its outline."));
      place(this.parts.pad);
      this.settings();
      return;
    }
    const corrected = answer.by !== "program";
    place(
      this.parts.face,
      h("div.headline", null, h("h3", null, "This face"), chip(BY[answer.by] ?? answer.by, corrected ? "accent" : "")),
      h(
        "dl.readings",
        { "data-live": "face" },
        answer.axes.map((axis) =>
          reading(`${NAMES[axis]} semi-axis`, `${withStd(answer.semi_axes_mm[axis], answer.semi_axes_mm_std?.[axis])} mm`, {
            mark: "face",
            was: corrected && own ? `${withStd(own.semi_axes_mm[axis], own.semi_axes_mm_std?.[axis])} mm` : undefined,
          }),
        ),
        reading("Arc that is pad", answer.arc_deg === null ? "–" : `${plain(answer.arc_deg)}°`),
        reading("Lean", answer.lean_deg === null ? "–" : `${plain(answer.lean_deg)}°`),
      ),
      answer.flags.length > 0 && h("div.note", null, h("ul", null, answer.flags.map((flag) => h("li", null, wordsFor(flag))))),
    );
    this.#pad(answer);
    this.settings();
  }

  #pad({ finger, finger_error: problem }) {
    if (finger === undefined || (finger === null && !problem)) {
      if (!this.parts.pad.querySelector("[data-live]")) place(this.parts.pad, h("h3", null, "All faces together"), h("p.soft", null, "Measuring the other faces …"));
      return;
    }
    if (!finger) {
      place(this.parts.pad, h("h3", null, "All faces together"), h("p.soft", null, problem ?? "Two faces are the least for a pad."));
      return;
    }
    const agree = finger.p_value === null || finger.p_value === undefined ? null : finger.p_value > 0.05;
    place(
      this.parts.pad,
      h("div.headline", null, h("h3", null, "All faces together"), agree === null ? null : agree ? chip("the faces agree", "good") : chip("the faces disagree", "warn")),
      h(
        "dl.readings",
        { "data-live": "finger" },
        Object.entries(NAMES).map(([axis, words]) => reading(`${words} semi-axis`, h("strong.figure", null, `${withStd(finger.semi_axes_mm[axis], finger.semi_axes_mm_std?.[axis])} mm`))),
        finger.degrees_of_freedom > 0 && reading("Agreement", `χ² = ${finger.chi_square.toPrecision(3)} for ${finger.degrees_of_freedom}, ${probability(finger.p_value)}`),
      ),
      finger.disagreements?.length > 0 && h("details", { open: true }, h("summary", null, "Each face against all, mm"), differences(finger.disagreements)),
    );
  }

  settings() {
    const { change } = this.view.corrections;
    const side = (key, label) => field(label, choose({ value: change[key] ?? "", options: SIDES, onset: (value) => this.view.set(key, value || null) }));
    place(
      this.parts.settings,
      h("h3", null, "How it is read"),
      h("div.fields", null, side("tip", "Fingertip points"), ["distal", "radial", "ulnar"].includes(this.view.entry.face) && side("palmar_side", "Palmar side lies")),
      h(
        "div.actions",
        null,
        change.ellipse_px && button("Ellipse from outline", () => this.view.set("ellipse_px", null), { kind: "small" }),
        change.added_points_px?.length > 0 && button("Forget points added", () => this.view.set("added_points_px", null), { kind: "small" }),
        change.erased?.length > 0 && button("Forget rubbing out", () => this.view.set("erased", null), { kind: "small" }),
        change.region_of_interest_px && button("Forget region of interest", () => this.view.set("region_of_interest_px", null), { kind: "small" }),
      ),
    );
  }

  tool() {
    const { tool, radius } = this.view;
    this.parts.tool.hidden = tool === "ellipse";
    if (tool === "erase") {
      const slider = h("input", { type: "range", min: 2, max: 100, value: radius, onchange: () => this.view.setRadius(Number(slider.value)) });
      place(this.parts.tool, field("Rubber: radius", slider, { unit: `${radius} px` }));
    } else if (tool === "points") place(this.parts.tool, h("p.soft", null, "Click on the pad's outline. A point added can be dragged; Delete takes it away."));
    else if (tool === "box") place(this.parts.tool, h("p.soft", null, "Draw a box round the fingertip."));
    else if (tool === "length") place(this.parts.tool, h("h3", null, "Length"), h("p.soft", { "data-live": "length" }, "Draw a line on the picture."));
  }

  length(answer) {
    const line = this.parts.tool.querySelector("[data-live=length]");
    if (line) place(line, h("span.figure-big.number", null, quantityText(answer, "length_mm")), h("br"), `${plain(answer.length_px)} px, ends ± 1 px each`);
  }

  #decision() {
    this.buttons = {
      accept: button("Accept and next", () => this.view.accept(), { kind: "primary", key: "Enter" }),
      undo: button("Undo", () => this.view.undo(), { key: "u" }),
      redo: button("Redo", () => this.view.redo(), { key: "r" }),
      reject: button("Reject", () => this.view.reject(), { kind: "bad", key: "x" }),
      revert: button("Back to the program", () => this.view.revert(), { kind: "small", title: "Take back all corrections of this photograph; they stay in its history" }),
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

/** Bars left and right of zero: each face's semi-axis less that of all faces. */
function differences(faces) {
  const axes = Object.keys(NAMES);
  const rows = faces.flatMap((face) => axes.filter((axis) => Number.isFinite(face[axis])).map((axis) => [`${face.face}: ${NAMES[axis].toLowerCase()}`, face[axis]]));
  const most = Math.max(...rows.map(([, value]) => Math.abs(value)), 1e-9);
  return h(
    "div.differences",
    null,
    rows.map(([label, value]) => {
      const width = (Math.abs(value) / most) * 48;
      return h(
        "div.difference",
        null,
        h("span", null, label),
        s("svg", { viewBox: "-50 0 100 10", width: 100, height: 10, "aria-hidden": "true" }, s("path", { d: "M0 0V10", class: "zero" }), s("rect", { x: value < 0 ? -width : 0, y: 2, width, height: 6 })),
        h("span.number", null, (value < 0 ? "−" : "+") + Math.abs(value).toFixed(3)),
      );
    }),
  );
}
