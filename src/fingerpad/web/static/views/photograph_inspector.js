// Results of one face, and of all faces of the finger combined.

import { h, render, s } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { quantityRow, signedPercent } from "../core/quantity.js";
import { PHOTOGRAPH_FLAGS, rules } from "../core/workspace.js";
import { alarm, chip, choiceField, field, synthetic } from "../parts/forms.js";
import { AXES } from "../parts/missing_fields.js";
import { scaleChoice, whichScale } from "../parts/scale_ways.js";
import { flagNote, Inspector } from "./inspector.js";

const NAMES = Object.fromEntries(AXES);
const SIDES = [["", "as in the study"], "up", "down", "left", "right"];

const REASONS = ["blurred", "wrong finger", "not parallel to the image plane"];

export class PhotographInspector extends Inspector {
  tools = {
    points: {
      words: h(
        "p.soft",
        "Click on the outline of the pad. Added points can be dragged; Delete removes them.",
      ),
    },
    erase: { brush: "Eraser radius", hint: "[ and ] change it." },
    box: { words: h("p.soft", "Draw a box around the fingertip.") },
    length: { words: [h("h3", "Length"), h("p.soft", { "data-live": "length" })] },
  };

  constructor(view) {
    super(view, ["pad", "face"], REASONS);
  }

  head() {
    const { finger, file, synthetic: made } = this.view.entry;
    render(this.parts.head, [
      h("div.headline", [h("h2", `${finger}, ${faceWords(this.view.entry)}`), synthetic(made)]),
      h("p.soft", `${file} · ${whichScale(this.view.entry)}`),
    ]);
  }

  wait() {
    this.head();
    render(this.parts.face, h("p.loading", "Finding the outline …"));
    render(this.parts.pad);
    this.tool();
  }

  /** @param {PhotographMeasurement | null} answer @param {string} [problem] */
  show(answer, problem) {
    if (!answer) {
      render(this.parts.face, [
        alarm(problem),
        !this.view.lacking?.length &&
          h("p.soft", "Draw a region of interest round the fingertip, or add points on its outline."),
      ]);
      render(this.parts.pad);
      this.settings();
      return;
    }
    const { automatic } = answer;
    render(this.parts.face, [
      h("div.headline", [h("h3", "This face"), chip(answer.by, automatic ? "accent" : "")]),
      h("dl.readings", { "data-live": "face" }, [
        Object.keys(answer.semi_axes_mm).map((axis) =>
          quantityRow(`${NAMES[axis]} semi-axis`, answer.semi_axes_mm[axis].words, {
            mark: "face",
            title: `Standard uncertainty: ${answer.uncertainty_words[axis]}`,
            was: automatic?.[axis].words,
          }),
        ),
        quantityRow("Arc of the pad", answer.arc_deg.words),
        answer.exponent.value !== null && quantityRow("Exponent (ellipse: 2)", answer.exponent.words),
        answer.radii.map(({ wedge_angle_deg: wedge, outline_mm: outline, ellipse_mm: ellipse }) =>
          quantityRow(`Radius at ${wedge.words}, outline`, `${outline.words} (ellipse ${ellipse.words})`),
        ),
        quantityRow("Tilt", answer.tilt_deg.words),
      ]),
      flagNote(answer.flags, PHOTOGRAPH_FLAGS),
    ]);
    this.#pad(answer);
    this.settings();
  }

  /** @param {PhotographMeasurement} answer */
  #pad({ finger, finger_error: problem }) {
    if (!finger) {
      // What was measured before stays while the other faces are measured again.
      if (!problem && this.parts.pad.querySelector("[data-live]")) return;
      const words = problem ?? "Measuring the other faces …";
      render(this.parts.pad, [h("h3", "All faces combined"), h("p.soft", words)]);
      return;
    }
    const agree = finger.degrees_of_freedom > 0 ? !finger.disagree : null;
    render(this.parts.pad, [
      h("div.headline", [
        h("h3", "All faces combined"),
        agree === null ? null : agree ? chip("faces agree", "good") : chip("faces disagree", "warn"),
      ]),
      h("dl.readings", { "data-live": "finger" }, [
        Object.entries(NAMES).map(([axis, words]) =>
          quantityRow(`${words} semi-axis`, h("strong.figure", finger.semi_axes_mm[axis].words)),
        ),
        finger.degrees_of_freedom > 0 &&
          quantityRow("Agreement", [
            symbol("χ²"),
            ` = ${finger.chi_square.toPrecision(3)}, df = ${finger.degrees_of_freedom}, ${finger.p_words}`,
          ]),
      ]),
      finger.disagreements?.length > 0 &&
        h("details", { open: true }, [
          h("summary", "Deviation of each face"),
          differences(finger.disagreements),
        ]),
    ]);
  }

  /** Change the photograph's table of the study. */
  #state(key, value) {
    this.edit({ kind: "photograph", key: this.view.entry.item, set: { [key]: value } });
  }

  settings() {
    const { change } = this.view.corrections;
    const { face, scale } = this.view.entry;
    const side = (key, label) =>
      choiceField(label, {
        value: change[key] ?? "",
        options: SIDES,
        onset: (value) => this.view.set(key, value || null),
      });
    this.drawSettings(
      [
        face &&
          choiceField("Face", {
            value: face,
            options: rules().faces,
            onset: (value) => this.#state("face", value),
          }),
        scale &&
          field(
            "Scale",
            scaleChoice({
              value: scale,
              words: this.view.entry.scale_words,
              onset: (value) => value && this.#state("scale", value),
            }),
          ),
        side("tip", "Fingertip points"),
        ["distal", "radial", "ulnar"].includes(this.view.entry.face) && side("palmar_side", "Palmar side"),
      ],
      this.resetButtons("ellipse_px", "added_points_px", "erased", "region_of_interest_px"),
    );
  }

  /** @param {Answers["LengthMeasurement"] | null} answer of a line, if there is one */
  length(answer) {
    const [, place] = this.tools.length.words;
    const found = answer && h("span.figure-big.number", answer.length_mm.words);
    render(
      place,
      found ? [found, h("br"), "uncertainty of each end: 1 px"] : ["Draw a line on the picture."],
    );
  }
}

/** @param {{ face?: string | null }} entry */
export const faceWords = ({ face }) => (face ? `${face} face` : "face not stated");

/**
 * Bars of the deviation of each face from all faces combined.
 *
 * @param {Answers["CombinedFaces"]["disagreements"]} faces
 */
function differences(faces) {
  const rows = faces.flatMap(([face, off]) =>
    Object.entries(off).map(([axis, value]) => ({ label: `${face}: ${NAMES[axis].toLowerCase()}`, value })),
  );
  // Small deviations look small.
  const most = Math.max(...rows.map(({ value }) => Math.abs(value)), 0.05);
  return h("div.differences", [
    rows.map(({ label, value }) => {
      const width = (Math.abs(value) / most) * 48;
      return h("div.difference", [
        h("span", label),
        s("svg", { viewBox: "-50 0 100 10", width: 100, height: 10, "aria-hidden": "true" }, [
          s("path", { d: "M0 0V10", class: "zero" }),
          s("rect", { x: value < 0 ? -width : 0, y: 2, width, height: 6 }),
        ]),
        h("span.number", signedPercent(value)),
      ]);
    }),
  ]);
}
