// Tools that draw around an area: a lasso in one stroke, a polygon corner by corner.

import { attributes, pathOf, s } from "../core/dom.js";
import { apart, rounded } from "../core/gestures.js";

const CLOSE_PX = 10;

/** Base of both: shows the points so far, and calls `done` with the area's points. */
class Area {
  cursor = "crosshair";
  /** @type {Points | null} */
  points = null;
  /** @type {Points | null} */
  kept = null;
  /** @type {string | undefined} what the area being drawn does, if not `action` */
  now;

  constructor(stage, { action, done }) {
    this.stage = stage;
    this.action = action;
    this.done = done;
    this.casing = s("path.casing");
    this.line = s("path.lasso");
    this.start = s("circle.lasso-start", { visibility: "hidden" });
    stage.world.append(this.casing, this.line, this.start);
    this.forget = stage.keepSize((size) => this.start.setAttribute("r", 6 * size));
    this.setAction(action);
  }

  setAction(action) {
    this.action = action;
    this.line.setAttribute("class", `lasso ${action}`);
  }

  /** Draw the points, and a line to the pointer. */
  draw(to) {
    const points = this.points ?? this.kept;
    const d = points ? pathOf(to && this.points ? [...points, to] : points, !this.points) : "";
    for (const path of [this.casing, this.line]) path.setAttribute("d", d);
    attributes(this.start, {
      visibility: this.points ? "visible" : "hidden",
      cx: points?.[0][1] ?? 0,
      cy: points?.[0][0] ?? 0,
    });
  }

  finish() {
    const points = this.points;
    this.points = null;
    this.kept = points && points.length > 2 ? points : null;
    this.draw();
    if (this.kept) this.done({ action: this.now ?? this.action, points_px: this.kept.map(rounded) });
  }

  cancel() {
    this.points = this.kept = null;
    this.draw();
  }

  /** Remove the line once the new region is shown. */
  dry() {
    if (!this.points) this.cancel();
  }

  leave() {
    this.forget();
    for (const node of [this.casing, this.line, this.start]) node.remove();
  }
}

/** A line around an area, in one stroke. */
export class Lasso extends Area {
  down(point, event) {
    this.now = event?.altKey ? { add: "remove", remove: "add" }[this.action] : undefined;
    this.points = [point];
    this.draw();
  }

  move(point, down) {
    if (!down || !this.points || apart(point, this.points.at(-1)) < 1.5 / Math.min(1, this.stage.zoom))
      return;
    this.points.push(point);
    this.draw();
  }

  up() {
    if (this.points) this.finish();
  }
}

/** Corners one by one; the first corner again, or Enter, closes the area. */
export class Polygon extends Area {
  once = true;

  down(point, event) {
    this.points ??= [];
    const first = this.points[0];
    const closes = this.points.length > 2 && apart(point, first) * this.stage.zoom < CLOSE_PX;
    if (closes || event?.detail === 2) return this.finish();
    this.points.push(point);
    this.draw();
  }

  move(point) {
    if (this.points) this.draw(point);
  }

  /** @param {KeyboardEvent} event */
  key({ key }) {
    if (!this.points) return false;
    if (key === "Enter") this.finish();
    else if (key === "Escape") this.cancel();
    else if (key === "Backspace") {
      this.points.pop();
      if (this.points.length) this.draw();
      else this.cancel();
    } else return false;
    return true;
  }
}
