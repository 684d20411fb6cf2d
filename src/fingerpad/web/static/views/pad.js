// The pad on its wedge: point of contact and curvature.

import { LatestRequest, post } from "../core/api.js";
import { h, render, small } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { bindHere } from "../core/keys.js";
import { quantityRow, quantityRows } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { alarm, choiceField, empty, field, head, number, numberField, synthetic } from "../parts/forms.js";
import { AXES, staleChip } from "../parts/missing_fields.js";
import { PadScene, VIEWS } from "../parts/pad_scene.js";

/** @type {Shown[]} */
const RADII = [
  ["in_plane_radius_mm", "Radius along the finger"],
  ["transverse_radius_mm", "Radius across the finger"],
  ["mean_curvature_radius_mm", "", "R_0g"],
  ["geometric_mean_radius_mm", "", "R_e"],
];

export class PadView {
  constructor(root, rest) {
    const known = this.#fingers();
    this.finger = (known.find(({ name }) => name === rest[0]) ?? known[0])?.name ?? "";
    /** @type {Record<string, number | null>} semi-axes entered here; none is assumed */
    this.axes = { palmar: null, distal: null, radial_ulnar: null };
    /** @type {Answers["PadGeometry"] | null} */
    this.answer = null;
    const placed = workspace.study.observations.find(({ finger }) => finger === this.finger);
    this.wedge = placed?.wedge_angle_deg ?? 30;
    this.roll = placed?.roll_angle_deg ?? 0;
    this.scene = new PadScene();
    this.numbers = h("section");
    this.live = new LatestRequest(
      (asked) => post("/geometry", asked),
      (answer) => this.#show(answer),
      (error) => render(this.numbers, alarm(error.message)),
      this.numbers,
    );
    this.side = h("div.stack");
    this.nothing = empty(
      "No semi-axes yet",
      "Photographs of the finger's faces give them, or enter them for the finger on the Study page. " +
        "To try a pad, enter three semi-axes beside this.",
      h("a.button", { href: "#/study" }, "Go to study"),
    );
    this.caption = h("div.pad-caption");
    render(root, [
      head("Pad", "The ellipsoidal pad on its wedge under the platen.", this.#views()),
      h("div.panes.no-tools.pad-panes", [
        h("div.pad-main", [this.nothing, this.scene.root, this.caption]),
        h("aside.inspector", { "aria-label": "Placement", tabindex: 0 }, this.side),
      ]),
    ]);
    bindHere([
      ["w", "Wedge angle up", () => this.#nudge("wedge", 1)],
      ["W", "Wedge angle down", () => this.#nudge("wedge", -1)],
      ["f", "View from the side", () => this.scene.look("Side")],
      ["t", "View along the platen normal", () => this.scene.look("Through platen")],
      ["ArrowLeft ArrowRight ArrowUp ArrowDown", "Rotate the pad (when focused)", null],
      ["0", "Reset the view (when focused)", null],
    ]);
    this.#draw();
    this.#ask();
  }

  /** Fingers whose semi-axes are entered, or given by their photographs. */
  #fingers() {
    return workspace.study.fingers.filter(
      ({ complete, semi_axes_mm: axes, photographs }) => axes || (complete && photographs.length),
    );
  }

  #views() {
    return Object.keys(VIEWS).map((words) => small(words, () => this.scene.look(words)));
  }

  #draw() {
    const known = this.#fingers();
    const options = [...known.map(({ name }) => [name, name]), ["", "semi-axes entered here"]];
    const finger = workspace.study.fingers.find(({ name }) => name === this.finger);
    this.axesShown = h("dl.readings");
    this.axesTitle = h("div.headline");
    const angle = (key, title, words, min, max) => {
      const slider = h("input", {
        type: "range",
        min,
        max,
        step: 0.5,
        value: this[key],
        oninput: () => set(Number(slider.value)),
      });
      const typed = number({
        value: this[key],
        min,
        max,
        onset: (value) => set(value ?? 0),
        label: `${words}, degrees`,
      });
      const set = (value) => {
        this[key] = value;
        slider.value = typed.value = value;
        this.#ask();
      };
      this[`set_${key}`] = set;
      return h("div.angle", [field(title, slider), h("div.control", [typed, h("span.unit", "°")])]);
    };
    render(this.axesTitle, h("h3", "Semi-axes"));
    render(this.side, [
      h("h2.sr", "Pad and placement"),
      h("section", [
        choiceField("Finger", { value: this.finger, options, onset: (value) => this.#choose(value) }),
        finger?.synthetic && h("div", synthetic(true)),
      ]),
      h("section", [
        this.axesTitle,
        finger
          ? this.axesShown
          : h("div.fields", [
              AXES.map(([axis, words]) =>
                numberField(words, {
                  value: this.axes[axis],
                  min: 0.1,
                  onset: (value) => ((this.axes[axis] = value), this.#ask()),
                  unit: "mm",
                }),
              ),
            ]),
      ]),
      h("section", [
        h("h3", "Placement"),
        angle("wedge", ["Wedge angle ", symbol("θ")], "Wedge angle θ", 0, 90),
        angle("roll", ["Roll angle ", symbol("φ")], "Roll angle φ", -60, 60),
      ]),
      this.numbers,
    ]);
  }

  #nudge(key, by) {
    this[`set_${key}`](Math.max(0, Math.min(90, this[key] + by)));
  }

  /** Show a finger, or semi-axes to enter, which start from those shown before. */
  #choose(finger) {
    if (!finger && this.answer)
      for (const [axis] of AXES) this.axes[axis] = this.answer.semi_axes_mm[axis].value;
    this.finger = finger;
    this.#draw();
    this.#ask();
  }

  #ask() {
    const lacking = !this.finger && Object.values(this.axes).some((axis) => !axis);
    this.scene.root.hidden = this.caption.hidden = lacking;
    this.nothing.hidden = !lacking;
    if (lacking) {
      this.live.cancel();
      render(this.numbers);
      return;
    }
    const which = this.finger
      ? { finger: this.finger }
      : { semi_axes_mm: AXES.map(([axis]) => this.axes[axis]) };
    this.live.request({ ...which, wedge_angle_deg: this.wedge, roll_angle_deg: this.roll, detail: 40 });
  }

  /** @param {Answers["PadGeometry"]} answer */
  #show(answer) {
    this.answer = answer;
    render(this.axesTitle, [h("h3", "Semi-axes"), staleChip(this.finger)]);
    render(this.axesShown, [
      AXES.map(([axis, words]) => quantityRow(words, answer.semi_axes_mm[axis].words)),
    ]);
    this.scene.show(answer, `The pad on a wedge of ${this.wedge}°, touching at u = ${answer.u_deg.words}`);
    render(this.caption, [
      h("span", [h("i.key.along"), "principal direction along the finger"]),
      h("span", [h("i.key.across"), "across the finger"]),
      h("span", [h("i.key.contact"), "point of contact"]),
      h("span", [h("i.key.place"), "parametric angle ", symbol("u")]),
      h("span", [h("i.key.platen"), "platen"]),
      h("span", [h("i.key.wedge"), "wedge"]),
    ]);
    render(this.numbers, [
      h("div.headline", [
        h("span", ["Contact at ", symbol("u")]),
        h("span.figure-big.number", { "data-live": "u" }, answer.u_deg.words),
      ]),
      Math.abs(answer.v_deg.value - 90) > 0.005 &&
        h("p.soft.number", [symbol("v"), ` = ${answer.v_deg.words}`]),
      h("div", staleChip(this.finger)),
      h("dl.readings", { "data-live": "radii" }, quantityRows(RADII, answer)),
      !this.finger && h("p.soft", "No uncertainty: these semi-axes belong to no finger of the study."),
    ]);
  }

  update() {
    if (this.finger) this.#ask();
  }

  close() {
    this.live.cancel();
    this.scene.close();
  }
}
