// Shapes on a Stage that are moved by their handles: a line, a box, three points, an ellipse.

import { attributes, s } from "../core/dom.js";
import { apart, rounded } from "../core/gestures.js";
import { handle } from "./handle.js";

/** Distance of the handle that turns an ellipse, pixels of the screen. */
const TURN_PX = 30;

/** What all shapes have in common; a shape says what a handle changes, and draws itself. */
class Shape {
  cursor = "crosshair";
  /** @type {any} what is drawn, if anything */
  value = null;
  /** @type {any} what was drawn before, which stays if a new one is too small */
  kept = null;

  /**
   * @param {import("./stage.js").Stage} stage
   * @param {{ lines: Element[], handles: { label: string, kind?: string, steps?: boolean }[],
   *   changed: (value: any, final: boolean) => void }} options handles with `steps` say what an arrow key
   *   does; `changed` is called on every move
   */
  constructor(stage, { lines, handles, changed }) {
    this.stage = stage;
    this.lines = lines;
    this.changed = changed;
    this.handles = handles.map(({ steps, ...how }, index) =>
      handle(stage, {
        ...how,
        move: (point) => this.#after(() => this.moved(index, point)),
        step: steps && ((arrow, size) => this.#after(() => this.stepped(index, arrow, size))),
        commit: () => this.value && this.report(true),
      }),
    );
    this.grips = s("g", [this.handles.map(({ node }) => node)]);
    this.layer = s("g", { visibility: "hidden" }, [lines, this.grips]);
    stage.world.append(this.layer);
    stage.keepSize(() => this.value && this.draw());
  }

  #after(move) {
    if (!this.value) return;
    move();
    this.report(false);
  }

  // What each shape says for itself; the handles of most are its points.
  moved(index, point) {
    this.value[index] = point;
  }
  /** @param {number} _index @param {Point} _arrow @param {number} _size */
  stepped(_index, _arrow, _size) {}
  draw() {}

  /** Show a shape; null hides it. */
  set(value) {
    this.kept = structuredClone(value);
    this.show(value);
  }

  show(value) {
    this.value = structuredClone(value);
    this.layer.setAttribute("visibility", value ? "visible" : "hidden");
    if (value) this.draw();
  }

  report(final) {
    this.draw();
    if (final) this.kept = structuredClone(this.value);
    this.changed(this.value, final);
  }

  /** Draw the path of its lines, and its handles. @param {string} path @param {Points} points */
  trace(path, points) {
    for (const line of this.lines) line.setAttribute("d", path);
    this.put(points);
  }

  /** Put the handles at points. @param {Points} points */
  put(points) {
    for (const [index, point] of points.entries()) this.handles[index].put(point);
  }
}

const outline = (name) => [s("path.casing"), s(`path.${name}`)];

/** A straight line: its two ends. */
export class Line extends Shape {
  /** @param {import("./stage.js").Stage} stage @param {(ends: Points, final: boolean) => void} changed */
  constructor(stage, changed) {
    const handles = [{ label: "Start of the line" }, { label: "End of the line" }];
    super(stage, { lines: outline("measure"), handles, changed });
    this.label = s("text.measure-label", { "text-anchor": "middle" });
    this.grips.before(this.label);
  }

  write(words) {
    this.label.textContent = words;
  }

  down(point) {
    this.drawing = true;
    this.show([point, point]);
  }

  move(point, down) {
    if (!down || !this.drawing) return;
    this.value[1] = point;
    this.report(false);
  }

  up(point) {
    if (!this.drawing) return;
    this.drawing = false;
    this.value[1] = point;
    if (apart(this.value[0], point) * this.stage.zoom < 4) this.show(this.kept);
    else this.report(true);
  }

  draw() {
    const [from, to] = this.value;
    this.trace(`M${from[1]} ${from[0]}L${to[1]} ${to[0]}`, this.value);
    const [row, column] = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
    this.label.setAttribute(
      "transform",
      `translate(${column} ${row}) scale(${1 / this.stage.zoom}) translate(0 -12)`,
    );
  }
}

/** Where the row and the column of each corner of a box stand. */
const CORNERS = [
  [0, 1],
  [0, 3],
  [2, 1],
  [2, 3],
];

/** A box [row0, column0, row1, column1]. */
export class Box extends Shape {
  /** @type {Point | null} where it is drawn from */
  from = null;

  /** @param {import("./stage.js").Stage} stage @param {(box: number[], final: boolean) => void} changed */
  constructor(stage, changed) {
    const handles = CORNERS.map(([row, column]) => ({
      label: `${row ? "Lower" : "Upper"} ${column === 3 ? "right" : "left"} corner of the region`,
      kind: "axis",
    }));
    super(stage, { lines: outline("roi"), handles, changed });
  }

  /** @param {Point} point @returns {Point} */
  #inside([row, column]) {
    const [rows, columns] = this.stage.size;
    return [Math.round(Math.min(rows, Math.max(0, row))), Math.round(Math.min(columns, Math.max(0, column)))];
  }

  moved(index, point) {
    const [row, column] = CORNERS[index];
    [this.value[row], this.value[column]] = this.#inside(point);
  }

  down(point) {
    this.from = this.#inside(point);
  }

  move(point, down) {
    if (down && this.from) this.show([...this.from, ...this.#inside(point)]);
  }

  up(point) {
    if (!this.from) return;
    const to = this.#inside(point);
    const far = Math.abs(to[0] - this.from[0]) > 4 && Math.abs(to[1] - this.from[1]) > 4;
    this.show(far ? [...this.from, ...to] : this.kept);
    this.from = null;
    if (far) this.report(true);
  }

  report(final) {
    if (final) {
      const [row0, column0, row1, column1] = this.value;
      const [left, right] = [Math.min(column0, column1), Math.max(column0, column1)];
      this.value = [Math.min(row0, row1), left, Math.max(row0, row1), right];
    }
    super.report(final);
  }

  draw() {
    const [row0, column0, row1, column1] = this.value;
    /** @type {Points} */
    const corners = CORNERS.map(([row, column]) => [this.value[row], this.value[column]]);
    this.trace(`M${column0} ${row0}H${column1}V${row1}H${column0}Z`, corners);
  }
}

/** Three points on a rim; `changed` is called once there are three. */
export class ThreePoints extends Shape {
  once = true;

  /** @param {import("./stage.js").Stage} stage @param {(points: Points, final: boolean) => void} changed */
  constructor(stage, changed) {
    super(stage, {
      lines: [],
      handles: [1, 2, 3].map((one) => ({ label: `Point ${one} on the rim` })),
      changed,
    });
    this.set([]);
  }

  /** Set the next point, or move the nearest. */
  down(point) {
    const far = (index) => apart(point, this.value[index]);
    const { length } = this.value;
    const index = length < 3 ? length : [0, 1, 2].sort((one, other) => far(one) - far(other))[0];
    this.value[index] = point;
    this.report(true);
  }

  report(final) {
    this.draw();
    const inside = (point) => rounded(point).map((value) => Math.max(0, value));
    if (final && this.value.length === 3) this.changed(this.value.map(inside), true);
  }

  draw() {
    this.put(this.value);
    for (const [index, { node }] of this.handles.entries())
      node.style.display = this.value[index] ? "" : "none";
  }
}

/** The ends of the semi-axes of an ellipse: axis and side. @type {[axis: 0 | 1, side: 1 | -1][]} */
const ENDS = [
  [0, 1],
  [0, -1],
  [1, 1],
  [1, -1],
];

/**
 * An ellipse with handles for the ends of its semi-axes, its centre and its rotation. Its value is
 * `{ centre, lengths, directions }`, of its two semi-axes.
 */
export class EllipseEditor extends Shape {
  /** `names` are those of the semi-axes. */
  constructor(stage, names, changed) {
    const curves = [s("ellipse.casing"), s("ellipse.ellipse")];
    const arms = [s("path.arm"), s("path.arm")];
    const ends = ENDS.map(([axis, side]) => ({
      label: `End of the ${names[axis]}${side < 0 ? ", other end" : ""}`,
      kind: "axis",
      steps: true,
    }));
    const turning = "Rotation of the ellipse; left and right arrows turn by half a degree";
    const handles = [
      { label: "Centre of the ellipse", kind: "centre" },
      ...ends,
      { label: turning, kind: "turn", steps: true },
    ];
    super(stage, { lines: [...curves, ...arms], handles, changed });
    this.curves = curves;
    this.arms = arms;
    this.stalk = s("path.stalk");
    this.grips.prepend(this.stalk);
  }

  moved(index, point) {
    const { centre, directions, lengths } = this.value;
    const [down, along] = [point[0] - centre[0], point[1] - centre[1]];
    if (index === 0) this.value.centre = point;
    else if (index <= ENDS.length) {
      const [axis, side] = ENDS[index - 1];
      lengths[axis] = Math.max(2, side * (down * directions[axis][0] + along * directions[axis][1]));
    } else this.#turn(Math.atan2(down, along) - this.#angle);
  }

  stepped(index, [row, column], size) {
    if (index <= ENDS.length) {
      const [axis] = ENDS[index - 1];
      this.value.lengths[axis] = Math.max(2, this.value.lengths[axis] + (column || -row) * size);
    } else this.#turn(((column || row) * size * 0.5 * Math.PI) / 180);
  }

  /** Angle of the first semi-axis from the right, clockwise on the screen. */
  get #angle() {
    const [row, column] = this.value.directions[0];
    return Math.atan2(row, column);
  }

  #turn(angle) {
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    this.value.directions = this.value.directions.map(([row, column]) => [
      row * cos + column * sin,
      column * cos - row * sin,
    ]);
  }

  /** Show the ellipse with these ends of its semi-axes. @param {Point} centre @param {Point[]} ends */
  place(centre, ...ends) {
    const lengths = ends.map((end) => apart(end, centre));
    const directions = ends.map((end, axis) => end.map((value, k) => (value - centre[k]) / lengths[axis]));
    this.set({ centre, lengths, directions });
  }

  /** @param {0 | 1} axis @returns {Point} */
  end(axis, side = 1) {
    const { centre, lengths, directions } = this.value;
    return centre.map((value, k) => value + side * lengths[axis] * directions[axis][k]);
  }

  /** Angle of the first semi-axis from straight up, degrees counter-clockwise on the screen. */
  get fromUp() {
    const [row, column] = this.value.directions[0];
    return (Math.atan2(-column, -row) * 180) / Math.PI;
  }

  draw() {
    const { centre, lengths, directions } = this.value;
    const transform = `rotate(${(this.#angle * 180) / Math.PI} ${centre[1]} ${centre[0]})`;
    for (const curve of this.curves)
      attributes(curve, { cx: centre[1], cy: centre[0], rx: lengths[0], ry: lengths[1], transform });
    const ends = ENDS.map(([axis, side]) => this.end(axis, side));
    const between = (from, to) => `M${from[1]} ${from[0]}L${to[1]} ${to[0]}`;
    for (const [axis, arm] of this.arms.entries())
      arm.setAttribute("d", between(ends[2 * axis], ends[2 * axis + 1]));
    const far = lengths[0] + TURN_PX / this.stage.zoom;
    const knob = centre.map((value, k) => value + far * directions[0][k]);
    this.stalk.setAttribute("d", between(ends[0], knob));
    this.put([centre, ...ends, knob]);
  }
}
