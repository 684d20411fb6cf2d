// An ellipse with handles for centre, semi-axes and rotation.

import { attributes, s } from "../core/dom.js";
import { handle } from "./handle.js";

const TURN_PX = 30;

export class EllipseEditor {
  /** `names` are those of the semi-axes; `changed(shape, final)` is called on every move. */
  constructor(stage, names, changed) {
    this.stage = stage;
    this.changed = changed;
    /** @type {{ centre: Point, lengths: Point, directions: [Point, Point] } | null} */
    this.shape = null;
    this.curve = [s("ellipse.casing"), s("ellipse.ellipse")];
    this.axes = [s("path.arm"), s("path.arm")];
    this.stalk = s("path.stalk");
    this.lines = s("g.ellipse-lines", { visibility: "hidden" }, this.curve, this.axes, this.stalk);
    this.layer = s("g.ellipse-handles", { visibility: "hidden" });
    this.handles = {
      centre: this.#handle("Centre of the ellipse", "centre", (point) => (this.shape.centre = point)),
      first: this.#end(names[0], 0, 1),
      firstBack: this.#end(`${names[0]}, other end`, 0, -1),
      second: this.#end(names[1], 1, 1),
      secondBack: this.#end(`${names[1]}, other end`, 1, -1),
      turn: this.#handle(
        "Rotation of the ellipse; left and right arrows turn by half a degree",
        "turn",
        (point) => this.#turnTo(point),
        ([row, column], size) => this.#turnBy((column || row) * size * 0.5),
      ),
    };
    this.layer.append(...Object.values(this.handles).map(({ node }) => node));
    stage.world.append(this.lines, this.layer);
    stage.keepSize(() => this.shape && this.#draw());
  }

  #handle(label, kind, apply, step) {
    const after = () => {
      this.#draw();
      this.changed(this.shape, false);
    };
    return handle(this.stage, {
      label,
      kind,
      move: (point) => this.shape && (apply(point), after()),
      step: step && ((arrow, size) => this.shape && (step(arrow, size), after())),
      commit: () => this.shape && this.changed(this.shape, true),
    });
  }

  #end(name, axis, side) {
    const stretch = (length) => (this.shape.lengths[axis] = Math.max(2, length));
    return this.#handle(
      `End of the ${name}`,
      "axis",
      (point) => {
        const [row, column] = this.shape.directions[axis];
        stretch(
          side * ((point[0] - this.shape.centre[0]) * row + (point[1] - this.shape.centre[1]) * column),
        );
      },
      ([row, column], size) => stretch(this.shape.lengths[axis] + (column || -row) * size),
    );
  }

  #turnTo(point) {
    const { centre, directions } = this.shape;
    const [row, column] = directions[0];
    this.#turn(Math.atan2(point[0] - centre[0], point[1] - centre[1]) - Math.atan2(row, column));
  }

  #turnBy(degrees) {
    this.#turn((degrees * Math.PI) / 180);
  }

  #turn(angle) {
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    /** @type {(direction: Point) => Point} */
    const turned = ([row, column]) => [row * cos + column * sin, column * cos - row * sin];
    const [first, second] = this.shape.directions;
    this.shape.directions = [turned(first), turned(second)];
  }

  /**
   * Show the ellipse with these ends of its semi-axes.
   *
   * @param {Point} centre
   * @param {Point} firstEnd
   * @param {Point} secondEnd
   */
  show(centre, firstEnd, secondEnd) {
    const length = (end) => Math.hypot(end[0] - centre[0], end[1] - centre[1]);
    /** @type {Point} */
    const lengths = [length(firstEnd), length(secondEnd)];
    /** @type {(end: Point, index: 0 | 1) => Point} */
    const direction = (end, index) => [
      (end[0] - centre[0]) / lengths[index],
      (end[1] - centre[1]) / lengths[index],
    ];
    this.shape = {
      centre: [centre[0], centre[1]],
      lengths,
      directions: [direction(firstEnd, 0), direction(secondEnd, 1)],
    };
    this.#visible("visible");
    this.#draw();
  }

  hide() {
    this.shape = null;
    this.#visible("hidden");
  }

  #visible(value) {
    for (const layer of [this.lines, this.layer]) layer.setAttribute("visibility", value);
  }

  /** @param {0 | 1} axis @returns {Point} */
  end(axis, side = 1) {
    const { centre, lengths, directions } = this.shape;
    return [
      centre[0] + side * lengths[axis] * directions[axis][0],
      centre[1] + side * lengths[axis] * directions[axis][1],
    ];
  }

  /** Angle of the first semi-axis from straight up, degrees counter-clockwise on the screen. */
  get fromUp() {
    const [row, column] = this.shape.directions[0];
    return (Math.atan2(-column, -row) * 180) / Math.PI;
  }

  #draw() {
    const { centre, lengths, directions } = this.shape;
    const turn = (Math.atan2(directions[0][0], directions[0][1]) * 180) / Math.PI;
    for (const curve of this.curve) {
      attributes(curve, {
        cx: centre[1],
        cy: centre[0],
        rx: lengths[0],
        ry: lengths[1],
        transform: `rotate(${turn} ${centre[1]} ${centre[0]})`,
      });
    }
    const ends = [this.end(0), this.end(0, -1), this.end(1), this.end(1, -1)];
    this.axes.forEach((axis, index) => {
      const [from, to] = [ends[2 * index], ends[2 * index + 1]];
      axis.setAttribute("d", `M${from[1]} ${from[0]}L${to[1]} ${to[0]}`);
    });
    const far = lengths[0] + TURN_PX / this.stage.zoom;
    const knob = [centre[0] + far * directions[0][0], centre[1] + far * directions[0][1]];
    this.stalk.setAttribute("d", `M${ends[0][1]} ${ends[0][0]}L${knob[1]} ${knob[0]}`);
    const { first, firstBack, second, secondBack, turn: rotation, centre: middle } = this.handles;
    [first, firstBack, second, secondBack].forEach((each, index) => {
      each.put(ends[index]);
    });
    middle.put(centre);
    rotation.put(knob);
  }
}
