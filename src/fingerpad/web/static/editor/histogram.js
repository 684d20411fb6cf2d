// The histogram of an image's levels, with the threshold as a slider on it.

import { attributes, h, s } from "../core/dom.js";
import { drag } from "../core/gestures.js";
import { short } from "../core/quantity.js";

const HEIGHT = 64;
const STEPS = 400;

export class Histogram {
  /** @type {Answers["ContactLevels"] | null} */
  levels = null;

  /** `tried` is called while the threshold is moved, `set` once it is chosen. */
  constructor({ tried, set }) {
    this.set = set;
    this.bars = s("path.bars");
    this.above = s("path.bars.above");
    this.automatic = s("path.automatic");
    this.mark = s("path.threshold");
    this.plot = s("svg.histogram", { preserveAspectRatio: "none", "aria-hidden": "true" }, [
      this.bars,
      this.above,
      this.automatic,
      this.mark,
    ]);
    this.input = h("input", {
      type: "range",
      min: 1,
      max: STEPS,
      "aria-label": "Threshold",
      oninput: () => {
        this.held = true;
        this.#draw(this.value);
        tried(this.value);
      },
      onchange: () => this.#chosen(),
    });
    this.text = h("output.number");
    this.root = h("div.levels", [this.plot, this.input, this.text]);
    this.plot.addEventListener("pointerdown", (event) => this.#press(event));
  }

  get value() {
    return Number(((Number(this.input.value) / STEPS) * this.levels.edges.at(-1)).toPrecision(4));
  }

  /** Move the threshold by pressing or dragging on the histogram itself. */
  #press(event) {
    const move = ({ clientX }) => {
      const { left, width } = this.plot.getBoundingClientRect();
      const [low, high] = [this.levels.edges[0], this.levels.edges.at(-1)];
      const level = low + ((clientX - left) / width) * (high - low);
      this.input.value = String(Math.max(1, Math.round((STEPS * level) / high)));
      this.input.dispatchEvent(new Event("input"));
    };
    drag(this.plot, event, { move, end: () => this.#chosen() });
    move(event);
  }

  #chosen() {
    if (!this.held) return;
    this.held = false;
    this.set(this.value);
  }

  /**
   * Show levels and the threshold in use; not while it is being moved.
   *
   * @param {Answers["ContactLevels"]} levels
   * @param {number | null} threshold
   */
  show(levels, threshold) {
    if (this.held) return;
    this.levels = levels;
    const high = levels.edges.at(-1);
    this.shown = threshold ?? levels.automatic_threshold ?? high / 2;
    this.input.value = String(Math.round((STEPS * this.shown) / high));
    this.chosen = threshold !== null;
    this.#draw(this.shown);
  }

  #draw(threshold) {
    const { edges, counts, automatic_threshold: automatic } = this.levels;
    const [low, high] = [edges[0], edges.at(-1)];
    // A cube root: the background's peak would hide the rest.
    const top = Math.cbrt(Math.max(...counts));
    const path = (from) => {
      let d = `M${Math.max(low, from)} ${HEIGHT}`;
      counts.forEach((count, k) => {
        if (edges[k + 1] <= from) return;
        d += `V${HEIGHT - (HEIGHT * Math.cbrt(count)) / top}H${edges[k + 1]}`;
      });
      return `${d}V${HEIGHT}Z`;
    };
    this.plot.setAttribute("viewBox", `${low} 0 ${high - low} ${HEIGHT}`);
    this.bars.setAttribute("d", path(low));
    this.above.setAttribute("d", path(threshold));
    attributes(this.automatic, { d: automatic === null ? "" : `M${automatic} 0V${HEIGHT}` });
    this.mark.setAttribute("d", `M${threshold} 0V${HEIGHT}`);
    this.text.textContent = `${short(threshold)}${this.held || this.chosen ? "" : " (automatic)"}`;
    this.input.setAttribute("aria-valuetext", `${short(threshold)} grey levels above the background`);
    // The slider starts at zero, the histogram below: noise of the background.
    this.root.style.setProperty("--zero", `${(100 * -low) / (high - low)}%`);
  }
}
