// Force and contact area of a sequence over time, and area against force, with the current frame.

import { attributes, button, h, render, s } from "../core/dom.js";
import { drag } from "../core/gestures.js";
import { percent, short } from "../core/quantity.js";
import { PhaseLimits } from "./phase_limits.js";

const HEIGHT = 132;
const SIDE = { most: 190, least: 140, gap: 12 };
const LEAST_TIME = 300;
const PAD = { left: 54, right: 54, top: 8, bottom: 24 };
const SIDE_LEFT = 26;
// Between frames that are played: long enough to see the outline.
const PAUSE_MS = 100;

const AREA = { key: "gross_area_mm2", words: "area (mm²)", name: "Contact area", fromZero: true };
/** What areas and aspect ratios are drawn against. */
const FORCE = { by: "load_N", label: "force (N)", against: "force" };
const INDENTATION = {
  by: "measured_indentation_mm",
  label: "indentation ξ (mm)",
  against: "measured indentation",
};

/** A linear scale from numbers to pixels. */
const scale = (from, to, start, end) => (value) =>
  start + ((value - from) / (to - from || 1)) * (end - start);

const path = (points) =>
  points.map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");

/** The least and the greatest of some values; a spread would overflow the stack with very many. */
const extent = (values) =>
  values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);

/** Dots at some places, one for each pixel: the first frame there draws it. */
function dots(places) {
  const taken = new Set();
  return places.flatMap((place, index) => {
    if (!place) return [];
    const [x, y] = place.map(Math.round);
    const key = x * 4096 + y;
    if (taken.has(key)) return [];
    taken.add(key);
    return [{ index, d: `M${x} ${y}h0` }];
  });
}

/** The path of some dots. @param {{ d: string }[]} some */
const joined = (some) => some.map(({ d }) => d).join("");

const label = (x, y, words, kind = "", anchor = "start") =>
  s("text", { x, y, class: kind, "text-anchor": anchor }, words);

/** The index of the nearest value. */
function nearest(values, wanted) {
  const far = values.map((value) => Math.abs(value - wanted));
  return far.indexOf(extent(far)[0]);
}

export class SequenceTraces {
  #signal = null;
  #frames = [];
  #at = -1;
  #shift = 0;
  #timer = null;

  /**
   * @param {{ chosen: (frame: Frame) => Promise<void>, scrubbed: (frame: Frame) => void,
   *   aligned: (start: number) => void }} events
   */
  constructor(events) {
    this.events = events;
    this.phases = new PhaseLimits();
    const slider = { role: "slider", tabindex: 0, "aria-label": "Time of the frame", "aria-valuenow": 0 };
    this.plot = s("svg", { height: HEIGHT, ...slider });
    this.sides = [
      { ...AREA, ...FORCE },
      { ...AREA, ...INDENTATION },
      { key: "aspect_ratio", words: "aspect ratio", name: "Aspect ratio", fromZero: false, ...FORCE },
    ].map((side) => ({
      ...side,
      points: [],
      grown: s("path.grown"),
      drawn: 0,
      plot: s("svg", {
        height: HEIGHT,
        role: "img",
        "aria-label": `${side.name} against ${side.against}, up to the current frame`,
      }),
    }));
    this.playButton = button("Play", () => this.#toggle());
    this.alignBox = h("input", { type: "checkbox", onchange: () => this.#aligning() });
    this.alignWords = h("span.soft", { role: "status" });
    this.keepButton = button("Keep this alignment", () =>
      this.events.aligned(this.#signal.start_s + this.#shift),
    );
    this.keepButton.hidden = true;
    this.bar = h("div.trace-bar", [
      this.playButton,
      h("label", [this.alignBox, "Drag the area to align it with the force"]),
      this.alignWords,
      this.keepButton,
      (this.figure = h("span")),
    ]);
    this.root = h("div.traces", { hidden: true }, [
      h("div.trace-bars", [this.bar, this.phases.bar]),
      h("div.trace-plots", [
        h("div.time-plot", [this.plot, this.phases.layer]),
        this.sides.map(({ plot }) => plot),
      ]),
    ]);
    this.observer = new ResizeObserver(() => this.#draw());
    this.observer.observe(this.root);
    this.plot.addEventListener("pointerdown", (event) => this.#press(event));
    this.plot.addEventListener("keydown", (event) => this.#key(event));
  }

  /**
   * Show a sequence.
   *
   * @param {string | null} name
   * @param {Answers["SequenceSignal"] | null} signal
   * @param {Frame[]} frames in order; those without a time are left out
   */
  set(name, signal, frames) {
    this.stop();
    this.#signal = signal;
    this.#frames = frames.filter(({ time_s }) => time_s !== null);
    this.#shift = 0;
    this.alignBox.checked = false;
    this.root.hidden = !signal;
    this.phases.set(signal && name, signal?.phases ?? [], this.#frames);
    this.bar.hidden = this.#frames.length < 2;
    this.alignBox.parentElement.hidden = signal?.start_s === null;
    this.#aligning();
    this.#draw();
  }

  /** Move the cursor to a frame. */
  choose(frame) {
    this.#at = this.#frames.findIndex((one) => one.frame === frame?.frame);
    this.#cursor();
  }

  #draw() {
    const whole = this.root.clientWidth - 24;
    const sides = this.sides.filter(({ by }) => this.#frames.some((frame) => frame[by] !== null));
    const share = Math.floor((whole - LEAST_TIME) / Math.max(1, sides.length)) - SIDE.gap;
    this.sideWidth =
      share < SIDE.least ? this.#wrappedWidth(whole, sides.length) : Math.min(SIDE.most, share);
    const beside = whole - sides.length * (this.sideWidth + SIDE.gap);
    const width = Math.max(200, share < SIDE.least ? whole : beside);
    if (!this.#signal || this.root.hidden || !width) return;
    const { time_s: time, load_N: load } = this.#signal;
    const frames = this.#frames;
    const areas = frames.map(({ gross_area_mm2: area }) => area ?? 0);
    const times = frames.map(({ time_s }) => time_s);
    const greatest = (values) => Math.max(0, extent(values)[1]);
    const ends = extent([time[0], time.at(-1), ...times]);
    const bottom = HEIGHT - PAD.bottom;
    this.x = scale(...ends, PAD.left, width - PAD.right);
    this.time = scale(PAD.left, width - PAD.right, ...ends);
    this.loadY = scale(0, greatest(load) || 1, bottom, PAD.top);
    this.areaY = scale(0, greatest(areas) || 1, bottom, PAD.top);
    this.plot.setAttribute("width", String(width));
    const number = (value) => short(value, 2);
    const measured = areas.map((area, k) => (area ? [this.x(times[k]), this.areaY(area)] : null));
    this.areas = s("g.areas", s("path", { d: joined(dots(measured)) }));
    this.line = s("path.cursor", { d: `M0 ${PAD.top}V${bottom}`, visibility: "hidden" });
    render(this.plot, [
      this.phases.bands,
      s("path.axis", { d: `M${PAD.left} ${PAD.top}V${bottom}H${width - PAD.right}V${PAD.top}` }),
      s("path.load", { d: path(time.map((t, k) => [this.x(t), this.loadY(load[k])])) }),
      this.areas,
      this.line,
      label(PAD.left - 4, PAD.top + 9, number(greatest(load)), "load", "end"),
      label(PAD.left - 4, bottom, "N", "load", "end"),
      label(width - PAD.right + 4, PAD.top + 9, frames.length ? number(greatest(areas)) : "", "area"),
      label(width - PAD.right + 4, bottom, frames.length ? "mm²" : "", "area"),
      label(PAD.left - 4, HEIGHT - 7, `${short(ends[0], 3)} s`, "", "end"),
      label(width - PAD.right + 4, HEIGHT - 7, `${short(ends[1], 3)} s`, ""),
    ]);
    const step =
      frames.length > 1 ? (times.at(-1) - times[0]) / (times.length - 1) : (ends[1] - ends[0]) / 500;
    this.phases.draw({ x: this.x, time: this.time, ends, top: PAD.top, bottom, height: HEIGHT, step });
    this.#displace();
    this.#drawSides();
    this.#cursor();
  }

  /** The width of plots that stand in rows below the first, as on narrow screens. */
  #wrappedWidth(whole, count) {
    const fit = Math.floor((whole + SIDE.gap) / (SIDE.least + SIDE.gap));
    const row = Math.max(1, Math.min(count, fit));
    return Math.floor((whole + SIDE.gap) / row) - SIDE.gap;
  }

  /** Area and aspect ratio against force: all frames faint, those up to the current one strong. */
  #drawSides() {
    const bottom = HEIGHT - PAD.bottom;
    const right = this.sideWidth - 8;
    for (const side of this.sides) {
      side.plot.setAttribute("width", String(this.sideWidth));
      const across = this.#frames.map((frame) => frame[side.by]);
      const known = across.filter((value) => value !== null);
      const x = scale(Math.min(0, extent(known)[0]), extent(known)[1] || 1, SIDE_LEFT, right);
      const values = this.#frames.map((frame) => frame[side.key]);
      const [low, high] = extent(values.filter(Boolean));
      const y = scale(side.fromZero ? 0 : low, high, bottom - (side.fromZero ? 0 : 6), PAD.top + 12);
      side.points = dots(
        values.map((value, k) => (value && across[k] !== null ? [x(across[k]), y(value)] : null)),
      );
      side.grown = s("path.grown");
      side.drawn = 0;
      render(side.plot, [
        s("path.axis", { d: `M${SIDE_LEFT} ${PAD.top}V${bottom}H${right}` }),
        s("path.all", { d: joined(side.points) }),
        side.grown,
        label(right, HEIGHT - 6, side.label, "", "end"),
        label(SIDE_LEFT + 6, PAD.top + 9, side.words),
        side.points.length > 0 && label(right, PAD.top + 9, `≤ ${short(high, 3)}`, "", "end"),
      ]);
      side.plot.style.display = side.points.length ? "" : "none";
    }
  }

  #cursor() {
    const frame = this.#frames[this.#at];
    if (!this.line) return;
    this.line.setAttribute("visibility", frame ? "visible" : "hidden");
    if (!frame) return;
    this.line.setAttribute("transform", `translate(${this.x(frame.time_s + this.#shift).toFixed(1)} 0)`);
    for (const side of this.sides) {
      const count = side.points.findLastIndex(({ index }) => index <= this.#at) + 1;
      if (count === side.drawn) continue;
      side.drawn = count;
      side.grown.setAttribute("d", joined(side.points.slice(0, count)));
    }
    attributes(this.plot, {
      "aria-valuemin": this.#frames[0].time_s,
      "aria-valuemax": this.#frames.at(-1).time_s,
      "aria-valuenow": frame.time_s,
      "aria-valuetext": `frame ${frame.frame}, ${short(frame.time_s)} s`,
    });
  }

  #press(event) {
    if (event.button || !this.#frames.length) return;
    this.plot.focus({ preventScroll: true });
    const left = this.plot.getBoundingClientRect().left;
    const timeAt = ({ clientX }) => this.time(clientX - left);
    const begin = timeAt(event) - this.#shift;
    const move = (now) =>
      this.alignBox.checked ? this.#shiftTo(timeAt(now) - begin) : this.#scrub(timeAt(now));
    const end = () => this.alignBox.checked || this.events.chosen(this.#frames[this.#at]);
    drag(this.plot, event, { move, end });
    if (!this.alignBox.checked) move(event);
  }

  #scrub(time) {
    const times = this.#frames.map(({ time_s }) => time_s);
    this.#at = nearest(times, time);
    this.#cursor();
    this.events.scrubbed(this.#frames[this.#at]);
  }

  #key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -Infinity, End: Infinity }[
      event.key
    ];
    if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    if (this.alignBox.checked) {
      const { shift_s: shifts } = this.#signal;
      this.#shiftTo(this.#shift + (step * (shifts[1] - shifts[0])) / 4);
      return;
    }
    const to = Math.max(0, Math.min(this.#frames.length - 1, this.#at + step));
    this.events.chosen(this.#frames[to]);
  }

  #toggle() {
    if (this.#timer) {
      this.stop();
      return;
    }
    if (this.#at >= this.#frames.length - 1 || this.#at < 0) this.#at = 0;
    const wait = Math.max(
      PAUSE_MS,
      (1000 * (this.#frames.at(-1).time_s - this.#frames[0].time_s)) / (this.#frames.length - 1),
    );
    this.playButton.textContent = "Pause";
    const next = async () => {
      this.#at += 1;
      this.#cursor();
      await this.events.chosen(this.#frames[this.#at]);
      if (!this.#timer) return;
      if (this.#at < this.#frames.length - 1) this.#timer = setTimeout(next, wait);
      else this.stop();
    };
    this.#timer = setTimeout(next, wait);
  }

  /** Stop playing. */
  stop() {
    clearTimeout(this.#timer);
    this.#timer = null;
    this.playButton.textContent = "Play";
  }

  #aligning() {
    if (!this.alignBox.checked) this.#shift = 0;
    this.plot.classList.toggle("aligning", this.alignBox.checked);
    this.#displace();
  }

  #shiftTo(shift) {
    const { shift_s: shifts } = this.#signal;
    this.#shift = Math.max(shifts[0], Math.min(shifts.at(-1), shift));
    this.#displace();
  }

  /** Show the areas later or earlier, and how much they scatter about the force. */
  #displace() {
    if (!this.areas || !this.#signal) return;
    const moved = this.x(this.#shift) - this.x(0);
    this.areas.setAttribute("transform", `translate(${moved.toFixed(1)} 0)`);
    this.#cursor();
    this.keepButton.hidden = !this.alignBox.checked || this.#shift === 0;
    this.alignWords.textContent = this.alignBox.checked ? this.#words() : "";
  }

  #words() {
    const { shift_s: shifts, area_scatter: scatter } = this.#signal;
    const known = scatter.map((one) => one ?? Infinity);
    const best = known.indexOf(Math.min(...known));
    const here = scatter[nearest(shifts, this.#shift)];
    return (
      `frames ${(1000 * this.#shift).toFixed(0)} ms later: areas scatter ${percent(here)} about a power of ` +
      `the force; least, ${percent(scatter[best])}, at ${(1000 * shifts[best]).toFixed(0)} ms`
    );
  }

  close() {
    this.stop();
    this.phases.close();
    this.observer.disconnect();
  }
}
