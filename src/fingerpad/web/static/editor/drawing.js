// What is drawn on a contact image: strokes of a brush, areas, points, and the overlay of a correction.

import { attributes, pathOf, render, s } from "../core/dom.js";
import { apart, rounded } from "../core/gestures.js";

const CLOSE_PX = 10;

/** What a brush or an area does while Alt is held. */
const otherwise = (action) => ({ add: "remove", remove: "add" })[action];

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
    this.now = (event?.altKey && otherwise(this.action)) || this.action;
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
    this.now = event?.altKey ? otherwise(this.action) : undefined;
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

/** Region, brush strokes, seed point, and the automatic outline of a contact image. */
export class ContactOverlay {
  #stage;
  #region = s("path.region");
  #strokes = s("g.kept-strokes");
  #own = s("path.own");
  #mark = s("g.seed", { visibility: "hidden" }, [
    s("circle", { r: 7, class: "seed" }),
    s("path.seed", { d: "M-12 0H-4M4 0H12M0-12V-4M0 4V12" }),
  ]);
  #seed = null;

  constructor(stage) {
    this.#stage = stage;
    stage.world.append(this.#region, this.#strokes, this.#own, this.#mark);
    stage.keepSize(() => this.#drawSeed());
  }

  clear() {
    this.region(null);
    this.own(null);
    render(this.#strokes);
  }

  region(outline) {
    this.#region.setAttribute("d", pathOf(outline));
  }

  own(outline) {
    this.#own.setAttribute("d", pathOf(outline));
  }

  /** Show the strokes and the seed point of a correction. */
  correction({ strokes, seed_px: seed }) {
    render(this.#strokes, [
      (strokes ?? []).map(({ action, points_px: points, radius_px: radius }) =>
        radius
          ? s(`path.stroke.${action}`, {
              d: pathOf(points.length > 1 ? points : [points[0], points[0]], false),
              "stroke-width": 2 * radius,
            })
          : s(`path.area.${action}`, { d: pathOf(points) }),
      ),
    ]);
    this.#seed = seed ?? null;
    this.#drawSeed();
  }

  #drawSeed() {
    this.#mark.setAttribute("visibility", this.#seed ? "visible" : "hidden");
    if (this.#seed)
      this.#mark.setAttribute(
        "transform",
        `translate(${this.#seed[1]} ${this.#seed[0]}) scale(${1 / this.#stage.zoom})`,
      );
  }
}
