// The pad in three dimensions: surface, point of contact, principal directions, platen and wedge. Lines and
// labels are SVG over the shaded surface; where WebGL is missing, the surface is SVG too.

import { attributes, h, render, s } from "../core/dom.js";
import { Painter } from "./webgl.js";

const SKIN = [0.95, 0.85, 0.775, 1];
const BACK = [0.86, 0.88, 0.9, 1];
const PLATEN = [0.34, 0.7, 0.91, 0.3];
const WEDGE = [0.56, 0.62, 0.7, 0.55];
const START = { turn: -0.62, tilt: 0.42 };

/** @typedef {[number, number, number]} Vector */
/** @type {(a: Vector, b: Vector) => Vector} */
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @type {(a: Vector, b: Vector) => Vector} */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @type {(p: number, a: Vector, q: number, b: Vector) => Vector} */
const sum = (p, a, q, b) => [p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2]];
/** @type {(a: Vector) => Vector} */
const unit = (a) => {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
};

/** Flat faces as triangles with normals. */
function flat(vertices, faces) {
  const positions = [];
  const normals = [];
  const triangles = [];
  for (const face of faces) {
    const normal = unit(
      cross(subtract(vertices[face[1]], vertices[face[0]]), subtract(vertices[face[2]], vertices[face[0]])),
    );
    const first = positions.length / 3;
    for (const index of face) {
      positions.push(...vertices[index]);
      normals.push(...normal);
    }
    for (let index = 2; index < face.length; index += 1)
      triangles.push(first, first + index - 1, first + index);
  }
  return [positions, normals, triangles];
}

/** Edges of a solid, without those inside a flat face. */
function sharp({ vertices_mm: vertices, faces }) {
  const seen = new Map();
  for (const face of faces) {
    const normal = unit(
      cross(subtract(vertices[face[1]], vertices[face[0]]), subtract(vertices[face[2]], vertices[face[0]])),
    );
    face.forEach((from, index) => {
      const to = face[(index + 1) % face.length];
      const key = from < to ? `${from} ${to}` : `${to} ${from}`;
      const other = seen.get(key);
      const flush =
        other &&
        Math.abs(other.normal[0] * normal[0] + other.normal[1] * normal[1] + other.normal[2] * normal[2]) >
          0.999;
      seen.set(key, { normal, ends: [vertices[from], vertices[to]], flush });
    });
  }
  return [...seen.values()].filter(({ flush }) => !flush).map(({ ends }) => ends);
}

/** A grid of points as triangles; normals follow from neighbouring points. */
function grid(x, y, z) {
  const rows = x.length;
  const columns = x[0].length;
  /** @type {(row: number, column: number) => Vector} */
  const at = (row, column) => [x[row][column], y[row][column], z[row][column]];
  const positions = [];
  const normals = [];
  const triangles = [];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const here = at(row, column);
      const [up, down] = [at(Math.max(row - 1, 0), column), at(Math.min(row + 1, rows - 1), column)];
      const [left, right] = [at(row, Math.max(column - 1, 0)), at(row, Math.min(column + 1, columns - 1))];
      let normal = cross(subtract(down, up), subtract(right, left));
      if (Math.hypot(...normal) < 1e-9) normal = here;
      // Normals point outwards, so that they do not cancel where the grid closes.
      if (normal[0] * here[0] + normal[1] * here[1] + normal[2] * here[2] < 0)
        normal = [-normal[0], -normal[1], -normal[2]];
      positions.push(...here);
      normals.push(...unit(normal));
      if (row && column) {
        const [a, b, c, d] = [
          (row - 1) * columns + column - 1,
          (row - 1) * columns + column,
          row * columns + column - 1,
          row * columns + column,
        ];
        triangles.push(a, c, b, b, c, d);
      }
    }
  }
  return [positions, normals, triangles];
}

export class PadScene {
  constructor({ forceSvg = false } = {}) {
    this.view = { ...START };
    /** @type {any} */
    this.meshes = {};
    this.canvas = h("canvas");
    this.surface = s("g.surface");
    this.marks = s("g.marks");
    this.svg = s("svg", { "aria-hidden": "true" }, this.surface, this.marks);
    this.root = h(
      "div.pad-scene",
      { tabindex: 0, role: "img", "aria-label": "The pad in three dimensions" },
      this.canvas,
      this.svg,
    );
    this.painter = forceSvg ? null : Painter.on(this.canvas);
    this.canvas.hidden = !this.painter;
    this.root.dataset.drawn = this.painter ? "webgl" : "svg";
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.root);
    this.#listen();
  }

  #listen() {
    let last = null;
    this.root.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      this.root.setPointerCapture(event.pointerId);
    });
    this.root.addEventListener("pointermove", (event) => {
      if (!last) return;
      this.#turn((event.clientX - last[0]) * 0.009, (event.clientY - last[1]) * 0.009);
      last = [event.clientX, event.clientY];
    });
    const release = () => (last = null);
    this.root.addEventListener("pointerup", release);
    this.root.addEventListener("pointercancel", release);
    this.root.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[
        event.key
      ];
      if (step) this.#turn(step[0], step[1]);
      else if (event.key === "0") this.look(START);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /**
   * @param {number} by
   * @param {number} tilt
   */
  #turn(by, tilt) {
    this.view.turn += by;
    this.view.tilt = Math.max(-1.5, Math.min(1.5, this.view.tilt + tilt));
    this.draw();
  }

  look(view) {
    this.view = { ...view };
    this.draw();
  }

  /**
   * @param {Answers["PadGeometry"]} scene
   * @param {string} label
   */
  show(scene, label) {
    this.scene = scene;
    this.root.setAttribute("aria-label", label);
    const { x_mm: x, y_mm: y, z_mm: z } = scene.mesh;
    const all = scene.platen.corners_mm.concat(scene.wedge.vertices_mm);
    this.meshes = {
      pad: grid(x, y, z),
      platen: flat(scene.platen.corners_mm, [[0, 1, 2, 3]]),
      wedge: flat(scene.wedge.vertices_mm, scene.wedge.faces),
    };
    this.edges = sharp(scene.wedge);
    this.far = Math.max(...all.map((point) => Math.hypot(...point)));
    if (this.painter)
      for (const [name, mesh] of Object.entries(this.meshes)) this.painter.keep(name, ...mesh);
    this.reach = 0.93 * this.far;
    this.draw();
  }

  /**
   * Directions on the screen: right, up and towards the viewer. The platen is on top.
   *
   * @returns {[Vector, Vector, Vector]}
   */
  #axes() {
    const { turn, tilt } = this.view;
    const { up } = this;
    const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
    const side = unit(cross(this.along, up));
    const away = sum(sin, this.along, cos, side);
    const right = unit(cross(up, away));
    const eye = sum(Math.cos(tilt), away, Math.sin(tilt), up);
    return [right, unit(cross(eye, right)), eye];
  }

  draw() {
    const { scene } = this;
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!scene || !width || !height) return;
    this.up = scene.normal;
    this.along = unit(scene.principal_directions[0]);
    if (this.along[1] < 0) this.along = [-this.along[0], -this.along[1], -this.along[2]];
    const axes = this.#axes();
    const scale = Math.min(width, height) / 2 / this.reach;
    this.project = (point) => {
      const [x, y, depth] = axes.map((axis) => axis[0] * point[0] + axis[1] * point[1] + axis[2] * point[2]);
      return [width / 2 + x * scale, height / 2 - y * scale, depth];
    };
    attributes(this.svg, { viewBox: `0 0 ${width} ${height}`, width, height });
    if (this.painter) this.#paint(axes, scale, width, height);
    else this.#polygons();
    this.#names();
  }

  #paint([right, up, eye], scale, width, height) {
    const ratio = window.devicePixelRatio || 1;
    if (
      this.canvas.width !== Math.round(width * ratio) ||
      this.canvas.height !== Math.round(height * ratio)
    ) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const [sx, sy, sz] = [(2 * scale) / width, (2 * scale) / height, 1 / (3 * this.far)];
    const place = [];
    for (let column = 0; column < 3; column += 1)
      place.push(right[column] * sx, up[column] * sy, -eye[column] * sz, 0);
    place.push(0, 0, 0, 1);
    const turn = [];
    for (let column = 0; column < 3; column += 1) turn.push(right[column], up[column], eye[column]);
    this.painter.begin(this.canvas.width, this.canvas.height);
    const shared = { place, turn };
    this.painter.draw("pad", { ...shared, colour: SKIN, back: BACK, cut: 0, rings: 1 });
    this.painter.draw("wedge", { ...shared, colour: WEDGE, clear: true });
    this.painter.draw("platen", { ...shared, colour: PLATEN, clear: true });
  }

  #polygons() {
    const faces = [];
    /** @type {(mesh: any, colour: number[], back: number[], opacity: number) => void} */
    const add = ([positions, normals, triangles], colour, back, opacity) => {
      for (let index = 0; index < triangles.length; index += 3) {
        const corners = [0, 1, 2].map((offset) => {
          const at = triangles[index + offset] * 3;
          return positions.slice(at, at + 3);
        });
        const seen = corners.map(this.project);
        const at = triangles[index] * 3;
        const base = corners.every((corner) => corner[0] < 0) ? back : colour;
        const normal = normals.slice(at, at + 3);
        faces.push([(seen[0][2] + seen[1][2] + seen[2][2]) / 3, seen, base, normal, opacity]);
      }
    };
    add(this.meshes.pad, SKIN, BACK, 1);
    add(this.meshes.wedge, WEDGE, WEDGE, 0.5);
    add(this.meshes.platen, PLATEN, PLATEN, 0.35);
    faces.sort((a, b) => a[0] - b[0]);
    const origin = this.project([0, 0, 0]);
    render(
      this.surface,
      faces.map(([, seen, base, normal, opacity]) => {
        const tip = this.project(normal);
        const light = Math.min(1, 0.62 + 0.38 * Math.abs(tip[2] - origin[2]));
        const fill = `rgb(${base
          .slice(0, 3)
          .map((value) => Math.round(value * light * 255))
          .join(" ")})`;
        return s("path", {
          d: `M${seen.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}Z`,
          fill,
          stroke: opacity === 1 ? fill : "none",
          "stroke-width": 0.6,
          "fill-opacity": opacity,
        });
      }),
    );
  }

  #names() {
    const { scene, project } = this;
    const line = (points, kind) =>
      s(`path.${kind}`, {
        d: `M${points
          .map(project)
          .map(([x, y]) => `${x} ${y}`)
          .join("L")}`,
      });
    const label = (point, words, kind = "") => {
      const [x, y] = project(point);
      return s("text", { x, y, class: kind, "text-anchor": "middle" }, words);
    };
    const ends = (points) => points[points.length - 1];
    const [x, y] = project(scene.contact_point_mm);
    render(
      this.marks,
      line([...scene.platen.corners_mm, scene.platen.corners_mm[0]], "platen-edge"),
      this.edges.map((edge) => line(edge, "wedge-edge")),
      scene.lines.map(({ name, points_mm: points }) => {
        const kind = { "principal direction along": "along", "principal direction across": "across" }[name];
        if (!kind) return line(points, `aid.${name.replace(" ", "-")}`);
        return [
          line(points, `direction.${kind}`),
          label(
            ends(points),
            kind === "across"
              ? `across ${scene.transverse_radius_mm.toFixed(1)} mm`
              : `along ${scene.in_plane_radius_mm.toFixed(1)} mm`,
            kind,
          ),
        ];
      }),
      s("circle.contact", { cx: x, cy: y, r: 5 }),
      scene.points?.map(({ u_deg: u, point_mm: point }, place) => {
        const [px, py] = project(point);
        return [
          s("circle.station", { cx: px, cy: py, r: 2.6 }),
          s("text.station-name", { x: px + 6, y: py - 4 }, `${place ? "" : "u = "}${u}°`),
        ];
      }),
    );
    this.#separateLabels();
  }

  /** Move the name of a direction above another that it would cover; leave out angles that it covers. */
  #separateLabels() {
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
    this.canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
