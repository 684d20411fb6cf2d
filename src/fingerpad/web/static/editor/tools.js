// Tools of a Stage: brush, line, box, and single points.

import { attributes, pathOf, s } from "../core/dom.js";
import { apart, rounded } from "../core/gestures.js";
import { handle } from "./handle.js";

/** A brush; `done` is called with each finished stroke. */
export class Brush {
  cursor = "none";

  constructor(stage, { action, radius, done }) {
    this.stage = stage;
    this.action = action;
    this.radius = radius;
    this.done = done;
    this.points = null;
    this.trace = s(`path.stroke.${action}`, { d: "" });
    this.tip = s(`circle.tip.${action}`, { visibility: "hidden" });
    stage.world.append(this.trace, this.tip);
    this.setRadius(radius);
  }

  setRadius(radius) {
    this.radius = radius;
    this.trace.setAttribute("stroke-width", 2 * radius);
    this.tip.setAttribute("r", radius);
  }

  down(point, event) {
    this.points = [point];
    this.now = event?.altKey ? { add: "remove", remove: "add" }[this.action] : this.action;
    this.trace.setAttribute("class", `stroke ${this.now}`);
    this.#draw();
  }

  move(point, down) {
    attributes(this.tip, { cx: point[1], cy: point[0], visibility: "visible" });
    if (!down || !this.points) return;
    if (apart(point, this.points.at(-1)) < Math.max(0.5, this.radius / 8)) return;
    this.points.push(point);
    this.#draw();
  }

  up(point) {
    if (!this.points) return;
    if (point && apart(point, this.points.at(-1)) > 0.5) this.points.push(point);
    const points = this.points.map(rounded);
    this.points = null;
    this.done({ action: this.now, points_px: points, radius_px: this.radius });
  }

  out() {
    this.tip.setAttribute("visibility", "hidden");
  }

  /** Remove the stroke once the new region is shown. */
  dry() {
    if (!this.points) this.trace.setAttribute("d", "");
  }

  #draw() {
    const points = this.points.length > 1 ? this.points : [this.points[0], this.points[0]];
    this.trace.setAttribute("d", pathOf(points, false));
  }

  leave() {
    this.trace.remove();
    this.tip.remove();
  }
}

/** A straight line; `changed([from, to], final)` is called on every move. */
export class Line {
  cursor = "crosshair";

  constructor(stage, changed) {
    this.stage = stage;
    this.changed = changed;
    this.ends = null;
    this.layer = s(
      "g.line",
      { visibility: "hidden" },
      (this.casing = s("path.casing")),
      (this.stroke = s("path.measure")),
    );
    this.label = s("text.measure-label", { "text-anchor": "middle" });
    this.handles = [0, 1].map((index) =>
      handle(stage, {
        label: index ? "End of the line" : "Start of the line",
        move: (point) => {
          this.ends[index] = point;
          this.#report(false);
        },
        commit: () => this.#report(true),
      }),
    );
    this.layer.append(this.label, ...this.handles.map(({ node }) => node));
    stage.world.append(this.layer);
    stage.keepSize(() => this.ends && this.#draw());
  }

  set(ends) {
    this.ends = ends?.map((point) => [...point]);
    this.layer.setAttribute("visibility", ends ? "visible" : "hidden");
    if (ends) this.#draw();
  }

  write(words) {
    this.label.textContent = words;
  }

  down(point) {
    this.drawing = true;
    this.set([point, point]);
  }

  move(point, down) {
    if (!down || !this.drawing) return;
    this.ends[1] = point;
    this.#report(false);
  }

  up(point) {
    if (!this.drawing) return;
    this.drawing = false;
    this.ends[1] = point;
    if (apart(this.ends[0], this.ends[1]) * this.stage.zoom < 4) {
      this.set(this.kept ?? null);
      return;
    }
    this.#report(true);
  }

  #report(final) {
    this.#draw();
    if (final) this.kept = this.ends.map((point) => [...point]);
    this.changed(this.ends, final);
  }

  #draw() {
    const [from, to] = this.ends;
    for (const path of [this.casing, this.stroke])
      path.setAttribute("d", `M${from[1]} ${from[0]}L${to[1]} ${to[0]}`);
    this.handles.forEach((each, index) => {
      each.put(this.ends[index]);
    });
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

/** A box [row0, column0, row1, column1]; `changed(box)` is called once it is drawn. */
export class Box {
  cursor = "crosshair";

  constructor(stage, changed) {
    this.stage = stage;
    this.changed = changed;
    this.box = null;
    this.layer = s(
      "g.box",
      { visibility: "hidden" },
      (this.casing = s("path.casing")),
      (this.stroke = s("path.roi")),
    );
    this.handles = CORNERS.map(([row, column]) =>
      handle(stage, {
        label: `${row ? "Lower" : "Upper"} ${column === 3 ? "right" : "left"} corner of the region`,
        kind: "axis",
        move: (point) => {
          [this.box[row], this.box[column]] = this.#inside(point);
          this.#report(false);
        },
        commit: () => this.#report(true),
      }),
    );
    this.layer.append(...this.handles.map(({ node }) => node));
    stage.world.append(this.layer);
    stage.keepSize(() => this.box && this.#draw());
  }

  #inside([row, column]) {
    const [rows, columns] = this.stage.size;
    return [Math.round(Math.min(rows, Math.max(0, row))), Math.round(Math.min(columns, Math.max(0, column)))];
  }

  set(box) {
    this.box = box && [...box];
    this.layer.setAttribute("visibility", box ? "visible" : "hidden");
    if (box) this.#draw();
  }

  down(point) {
    this.from = this.#inside(point);
  }

  move(point, down) {
    if (!down || !this.from) return;
    this.set([...this.from, ...this.#inside(point)]);
  }

  up(point) {
    if (!this.from) return;
    const to = this.#inside(point);
    const far = Math.abs(to[0] - this.from[0]) > 4 && Math.abs(to[1] - this.from[1]) > 4;
    if (far) {
      this.box = [...this.from, ...to];
      this.#report(true);
    } else this.set(this.kept ?? null);
    this.from = null;
  }

  #report(final) {
    const [row0, column0, row1, column1] = this.box;
    this.#draw();
    if (!final) return;
    const [left, right] = [Math.min(column0, column1), Math.max(column0, column1)];
    this.box = [Math.min(row0, row1), left, Math.max(row0, row1), right];
    this.kept = [...this.box];
    this.#draw();
    this.layer.setAttribute("visibility", "visible");
    this.changed(this.box);
  }

  #draw() {
    const [row0, column0, row1, column1] = this.box;
    for (const path of [this.casing, this.stroke])
      path.setAttribute("d", `M${column0} ${row0}H${column1}V${row1}H${column0}Z`);
    this.handles.forEach((each, index) => {
      const [row, column] = CORNERS[index];
      each.put([this.box[row], this.box[column]]);
    });
  }
}

/** Three points; `changed(points)` is called once there are three, and whenever one has moved. */
export class ThreePoints {
  cursor = "crosshair";
  once = true;
  /** @type {Points} */
  points = [];

  constructor(stage, changed) {
    this.changed = changed;
    this.handles = [0, 1, 2].map((index) =>
      handle(stage, {
        label: `Point ${index + 1} on the rim`,
        move: (point) => {
          this.points[index] = point;
          this.#draw();
        },
        commit: () => this.#report(),
      }),
    );
    this.layer = s(
      "g.rim",
      this.handles.map(({ node }) => node),
    );
    stage.world.append(this.layer);
    this.set([]);
  }

  set(points) {
    this.points = points.map((point) => [...point]);
    this.#draw();
  }

  /** Set the next point, or move the nearest. */
  down(point) {
    const far = (index) => apart(point, this.points[index]);
    const { length } = this.points;
    const index = length < 3 ? length : [0, 1, 2].sort((one, other) => far(one) - far(other))[0];
    this.points[index] = point;
    this.#draw();
    this.#report();
  }

  #report() {
    const inside = (point) => rounded(point).map((value) => Math.max(0, value));
    if (this.points.length === 3) this.changed(this.points.map(inside));
  }

  #draw() {
    this.handles.forEach((each, index) => {
      each.node.style.display = this.points[index] ? "" : "none";
      if (this.points[index]) each.put(this.points[index]);
    });
  }
}

/** A tool for single points. */
export class Click {
  cursor = "crosshair";
  once = true;

  constructor(done) {
    this.done = done;
  }

  down(point) {
    this.done(point.map((value) => Math.round(value * 10) / 10));
  }
}
