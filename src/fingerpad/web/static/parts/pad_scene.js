// The pad in three dimensions: pad, platen and wedge are painted on a canvas, the farthest faces first; lines
// and names are SVG above them.

import { attributes, h, render, s } from "../core/dom.js";
import { ARROWS, drag } from "../core/gestures.js";

// Red, green, blue, and opacity.
const SKIN = [242, 217, 198, 1];
const BACK = [219, 224, 230, 1];
const PLATEN = [87, 178, 232, 0.3];
const WEDGE = [143, 158, 178, 0.5];

/** From where the pad is seen: turned about the platen's normal, and tilted towards it, radians. */
export const VIEWS = {
  Oblique: { turn: -0.62, tilt: 0.42 },
  Side: { turn: 0, tilt: 0 },
  Tip: { turn: Math.PI / 2, tilt: 0 },
  "Through platen": { turn: -Math.PI / 2, tilt: 1.5 },
};

/** @type {(p: number, a: Vector, q: number, b: Vector) => Vector} */
const sum = (p, a, q, b) => [p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2]];
/** @type {(a: Vector, b: Vector) => Vector} */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @type {(a: Vector, b: Vector) => number} */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @type {(a: Vector) => Vector} */
const unit = (a) => sum(1 / (Math.hypot(...a) || 1), a, 0, a);
const LIGHT = unit([-0.45, 0.65, 0.72]);

/** @type {(corners: Vector[], colour: number[]) => PadFace} */
function faceOf(corners, colour) {
  const [a, b, c] = corners;
  const total = corners.reduce((one, other) => sum(1, one, 1, other));
  return {
    corners,
    centre: sum(1 / corners.length, total, 0, total),
    normal: unit(cross(sum(1, c, -1, a), sum(1, corners.at(-1), -1, b))),
    colour,
  };
}

/** The faces of the pad, whose normals point outwards. @param {Vector[][]} mesh @returns {PadFace[]} */
const padFaces = (mesh) =>
  mesh.slice(1).flatMap((line, row) =>
    line.slice(1).map((_, column) => {
      const [before, after] = [mesh[row], line];
      const face = faceOf([before[column], before[column + 1], after[column + 1], after[column]], SKIN);
      if (face.centre[0] < 0) face.colour = BACK;
      if (dot(face.normal, face.centre) < 0) face.normal = sum(-1, face.normal, 0, face.normal);
      return face;
    }),
  );

/** The edges of a solid: two faces go along each, in opposite directions. */
const edgesOf = ({ wedge_mm: vertices, wedge_faces: faces }) =>
  faces
    .flatMap((face) => face.map((from, place) => [from, face[(place + 1) % face.length]]))
    .filter(([from, to]) => from < to)
    .map((ends) => ends.map((index) => vertices[index]));

export class PadScene {
  constructor() {
    this.view = VIEWS.Oblique;
    this.canvas = h("canvas");
    this.paint = this.canvas.getContext("2d");
    this.marks = s("g.marks");
    this.svg = s("svg", { "aria-hidden": "true" }, this.marks);
    this.root = h(
      "div.pad-scene",
      { tabindex: 0, role: "img", "aria-label": "The pad in three dimensions" },
      [this.canvas, this.svg],
    );
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.root);
    this.root.addEventListener("pointerdown", (press) => {
      let last = press;
      const move = (now) => {
        this.#turn((now.clientX - last.clientX) * 0.009, (now.clientY - last.clientY) * 0.009);
        last = now;
      };
      drag(this.root, press, { move });
      this.root.focus({ preventScroll: true });
    });
    this.root.addEventListener("keydown", (event) => {
      const arrow = ARROWS[event.key];
      if (arrow) this.#turn(0.1 * arrow[1], 0.1 * arrow[0]);
      else if (event.key === "0") this.look("Oblique");
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /** @type {(by: number, tilt: number) => void} */
  #turn(by, tilt) {
    this.view = { turn: this.view.turn + by, tilt: Math.max(-1.5, Math.min(1.5, this.view.tilt + tilt)) };
    this.draw();
  }

  /** @param {string} view its name */
  look(view) {
    this.view = VIEWS[view];
    this.draw();
  }

  /** @param {Answers["PadGeometry"]} scene @param {string} label */
  show(scene, label) {
    this.scene = scene;
    this.root.setAttribute("aria-label", label);
    const { wedge_mm: vertices, wedge_faces: faces } = scene;
    this.pad = padFaces(scene.mesh_mm);
    this.around = [
      faceOf(scene.platen_mm, PLATEN),
      ...faces.map((face) =>
        faceOf(
          face.map((index) => vertices[index]),
          WEDGE,
        ),
      ),
    ];
    this.edges = edgesOf(scene);
    this.reach = Math.max(...[...scene.platen_mm, ...vertices].map((at) => Math.hypot(...at)));
    this.draw();
  }

  /** Directions on the screen: right, up and towards the viewer. The platen is on top. */
  #axes() {
    const { turn, tilt } = this.view;
    const { normal: up, principal_directions: directions } = this.scene;
    const along = unit(directions[0][1] < 0 ? sum(-1, directions[0], 0, up) : directions[0]);
    const away = sum(Math.sin(turn), along, Math.cos(turn), unit(cross(along, up)));
    const right = unit(cross(up, away));
    const eye = sum(Math.cos(tilt), away, Math.sin(tilt), up);
    return [right, unit(cross(eye, right)), eye];
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!this.scene || !width || !height) return;
    const axes = this.#axes();
    // A platen rarely stands upright: above and below it may reach further.
    const scale = Math.min(width, height / 0.93) / 2 / this.reach;
    this.project = (point) => [
      width / 2 + scale * dot(axes[0], point),
      height / 2 - scale * dot(axes[1], point),
    ];
    attributes(this.svg, { viewBox: `0 0 ${width} ${height}`, width, height });
    this.#paint(axes, width, height);
    this.#mark();
  }

  #paint(axes, width, height) {
    const { canvas, paint } = this;
    const ratio = window.devicePixelRatio || 1;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    const eye = axes[2];
    // A face stands before the pad if its plane parts the pad's centre from the viewer.
    const before = (face) => dot(face.normal, eye) * dot(face.normal, face.centre) > 0;
    const byDepth = (one, other) => dot(eye, one.centre) - dot(eye, other.centre);
    const around = [...this.around].sort(byDepth);
    for (const face of around) if (!before(face)) this.#face(face, axes);
    for (const face of this.pad) if (dot(face.normal, eye) > -0.05) this.#face(face, axes);
    for (const face of around) if (before(face)) this.#face(face, axes);
  }

  #face({ corners, normal, colour }, axes) {
    const { paint } = this;
    /** @type {any} */
    let turned = axes.map((axis) => dot(axis, normal));
    if (turned[2] < 0) turned = turned.map((value) => -value);
    const rim = colour[3] < 1 ? 0 : 0.28 * (1 - turned[2]) ** 3;
    const light = (0.46 + 0.42 * Math.max(0, dot(turned, LIGHT)) + 0.16 * turned[2]) * (1 - rim);
    const [red, green, blue] = colour.map((value) => Math.min(255, Math.round(value * light)));
    paint.beginPath();
    for (const corner of corners) paint.lineTo(...this.project(corner));
    paint.closePath();
    paint.fillStyle = `rgb(${red} ${green} ${blue} / ${colour[3]})`;
    paint.fill();
    if (colour[3] < 1) return;
    // Else what is behind would shine through between two faces.
    paint.strokeStyle = paint.fillStyle;
    paint.lineWidth = 0.7;
    paint.stroke();
  }

  /** Draw lines, points and names. */
  #mark() {
    const { scene, project } = this;
    const line = (points, kind) => s(`path.${kind}`, { d: `M${points.map(project).join("L")}` });
    const directions = {
      "principal direction along": ["along", scene.in_plane_radius_mm.value],
      "principal direction across": ["across", scene.transverse_radius_mm.value],
    };
    const [x, y] = project(scene.contact_point_mm);
    render(this.marks, [
      line([...scene.platen_mm, scene.platen_mm[0]], "platen-edge"),
      this.edges.map((edge) => line(edge, "wedge-edge")),
      Object.entries(scene.lines_mm).map(([name, points]) => {
        if (!directions[name]) return line(points, `aid.${name.replace(" ", "-")}`);
        const [kind, radius] = directions[name];
        const [right, top] = project(points.at(-1));
        const words = `${kind} ${radius.toFixed(1)} mm`;
        return [
          line(points, `direction.${kind}`),
          s("text", { x: right, y: top, class: kind, "text-anchor": "middle" }, words),
        ];
      }),
      s("circle.contact", { cx: x, cy: y, r: 5 }),
      Object.entries(scene.points_mm).map(([u, point], index) => {
        const [cx, cy] = project(point);
        return [
          s("circle.station", { cx, cy, r: 2.6 }),
          s("text.station-name", { x: cx + 6, y: cy - 4 }, `${index ? "" : "u = "}${u}°`),
        ];
      }),
    ]);
    this.#separateNames();
  }

  /** Move the name of a direction above another that it would cover; leave out angles that it covers. */
  #separateNames() {
    const kept = [];
    for (const text of this.marks.querySelectorAll("text")) {
      const { x, y, width, height } = text.getBBox();
      const box = { left: x, right: x + width, top: y, bottom: y + height };
      const other = kept.find(
        (each) =>
          box.left < each.right && each.left < box.right && box.top < each.bottom && each.top < box.bottom,
      );
      if (other && text.matches(".station-name")) {
        text.remove();
        continue;
      }
      if (other) {
        const shift = box.bottom - other.top;
        text.setAttribute("y", String(Number(text.getAttribute("y")) - shift));
        box.top -= shift;
        box.bottom -= shift;
      }
      kept.push(box);
    }
  }

  close() {
    this.observer.disconnect();
  }
}
