// Overlay of a contact image: region, brush strokes, seed point, and the automatic outline.

import { pathOf, render, s } from "../core/dom.js";

export class ContactOverlay {
  #stage;
  #region = s("path.region");
  #strokes = s("g.kept-strokes");
  #own = s("path.own");
  #mark = s(
    "g.seed",
    { visibility: "hidden" },
    s("circle", { r: 7, class: "seed" }),
    s("path.seed", { d: "M-12 0H-4M4 0H12M0-12V-4M0 4V12" }),
  );
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
    render(
      this.#strokes,
      (strokes ?? []).map(({ action, points_px: points, radius_px: radius }) =>
        radius
          ? s(`path.stroke.${action}`, {
              d: pathOf(points.length > 1 ? points : [points[0], points[0]], false),
              "stroke-width": 2 * radius,
            })
          : s(`path.area.${action}`, { d: pathOf(points) }),
      ),
    );
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
