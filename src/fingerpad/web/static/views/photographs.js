// Review of the photographs of a finger's faces.

import { LatestRequest, post } from "../core/api.js";
import { h, render, s } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { Click } from "../editor/drawing.js";
import { handle } from "../editor/handle.js";
import { Line } from "../editor/shapes.js";
import { empty } from "../parts/forms.js";
import { icon } from "../parts/icons.js";
import { missingOf } from "../parts/missing_fields.js";
import { faceWords, PhotographInspector } from "./photograph_inspector.js";
import { Review } from "./review.js";
import { reviewMarks } from "./review_layout.js";

/** @type {Parameters<typeof import("../parts/forms.js").segments>[1]} */
const TOOLS = [
  ["ellipse", "Drag axes and rotation", { icon: icon("ellipse"), shortcut: "v" }],
  ["points", "Add points on the outline", { icon: icon("points"), shortcut: "b" }],
  ["erase", "Erase points of the outline", { icon: icon("remove"), shortcut: "e" }],
  ["box", "Region of interest", { icon: icon("box"), shortcut: "o" }],
  ["length", "Measure a length", { icon: icon("ruler"), shortcut: "l" }],
];

class Photographs extends Review {
  /** @type {Photograph[]} */
  entries = [];

  nothingToAccept = "No outline was found. Draw a region of interest, add points, or drag the axes.";
  last = [
    "This was the last photograph.",
    { kind: "good", action: { words: "Go to contacts", do: () => (location.hash = "#/contacts") } },
  ];
  added = [];

  constructor(root, rest) {
    super();
    this.root = root;
    this.entries = this.#photographs();
    if (!this.entries.length) this.#nothing();
    else this.#build(rest[0]);
  }

  /** @returns {Photograph[]} */
  #photographs() {
    return workspace.study.fingers.flatMap((finger) =>
      (finger.photographs ?? [])
        .filter(({ outline }) => !outline)
        .map((photograph) => ({
          ...photograph,
          finger: finger.name,
          synthetic: finger.synthetic || photograph.synthetic,
        })),
    );
  }

  #nothing() {
    render(this.root, [
      h("header.head", h("h1", "Photographs")),
      empty(
        "No photographs yet",
        "Photograph two or three faces of the finger (palmar, distal, radial or ulnar) on a plain " +
          "background next to a ruler or coin, and drop the images on the Study page. Semi-axes can " +
          "also be entered.",
        h("a.button.primary", { href: "#/study" }, "Go to study"),
      ),
    ]);
  }

  #build(wanted) {
    this.layOut({
      title: "Photographs",
      words: "Fit the ellipse to the arc of the pad; all faces together give the semi-axes.",
      label: "Photograph of a finger. Arrow keys move the cross-hair of a tool, space presses it.",
      axes: ["semi-axis across", "semi-axis along"],
      tools: TOOLS,
      radius: 12,
      measureDragged: (asked) =>
        post("/measure/photograph", { item: this.entry.item, with_finger: true, ...asked }),
      describe,
      inspector: new PhotographInspector(this),
    });
    this.stage.root.classList.add("face");
    this.line = new Line(this.stage, (ends) => this.lengths.request(ends));
    this.lengths = new LatestRequest(
      (ends) => post("/measure/length", { scale: this.entry.scale, line_px: ends, ends_px_std: 1 }),
      (answer) => this.#length(answer),
      (error) => this.stage.setMessage(error.message, "bad"),
      this.inspector.parts.tool,
    );
    this.bind([
      ["b", "Add points on the outline", () => this.use("points")],
      ["e", "Erase points", () => this.use("erase")],
      ["l", "Measure a length", () => this.use("length")],
    ]);
    this.strip.set(this.entries);
    this.choose(
      Math.max(
        0,
        this.entries.findIndex(({ item }) => item === wanted),
      ),
    );
  }

  addOverlay() {
    this.used = s("path.arc-points");
    this.out = s("path.out-points");
    this.stage.world.append(this.used, this.out);
  }

  address(item) {
    return `#/photographs/${encodeURIComponent(item)}`;
  }

  missing() {
    return missingOf("photograph", this.entry.item);
  }

  title() {
    return `Photograph, ${faceWords(this.entry)} of ${this.entry.finger}`;
  }

  clearOverlay() {
    this.lengths.cancel();
    this.line.set(null);
    this.used.setAttribute("d", "");
    this.out.setAttribute("d", "");
  }

  showInfo() {
    this.mark.hidden = !this.entry.synthetic;
  }

  async measure(item, newest) {
    // Show this face first: the other faces may take longer.
    const face = await post("/measure/photograph", { item });
    if (!newest()) return;
    this.show(face);
    const whole = await post("/measure/photograph", { item, with_finger: true });
    if (newest()) this.show(whole, { live: true });
  }

  /** @param {PhotographMeasurement} answer @param {{ live?: boolean }} [options] */
  show(answer, { live = false } = {}) {
    this.measured = answer;
    this.stage.setScale(answer.mm_per_px);
    if (!live) {
      const { centre_px: centre, across_end_px: across, along_end_px: along } = answer.handles;
      this.stage.setMessage("");
      this.editor.place(centre, across, along);
      this.used.setAttribute("d", dots(answer.points_px));
      this.out.setAttribute("d", dots(answer.outliers_px));
      this.stage.tool?.dry?.();
      this.showTool();
    }
    this.inspector.show(answer);
  }

  /** @param {Answers["LengthMeasurement"]} answer */
  #length(answer) {
    this.line.write(answer.length_mm.words);
    this.inspector.length(answer);
  }

  draw(change) {
    this.#drawAdded(change.added_points_px ?? []);
  }

  #drawAdded(points) {
    for (const each of this.added) each.remove();
    this.added = points.map((at, index) => {
      let now = at;
      const mark = handle(this.stage, {
        label: `Point ${index + 1} added; Delete removes it`,
        move: (to) => mark.put((now = to)),
        commit: () =>
          this.keep((change) => ({
            ...change,
            added_points_px: change.added_points_px.map((point, other) => (other === index ? now : point)),
          })),
        remove: () =>
          this.keep((change) => ({
            ...change,
            added_points_px: change.added_points_px.filter((_, other) => other !== index),
          })),
      });
      this.stage.world.append(mark.node);
      mark.put(at);
      return mark;
    });
  }

  makeTool(tool) {
    if (tool === "points")
      return new Click((at) =>
        this.keep((change) => ({
          ...this.withoutEllipse(change),
          added_points_px: [...(change.added_points_px ?? []), at],
        })),
      );
    if (tool === "erase")
      return this.paint("remove", ({ points_px, radius_px }) =>
        this.keep((change) => ({
          ...this.withoutEllipse(change),
          erased: [...(change.erased ?? []), { points_px, radius_px }],
        })),
      );
    return tool === "length" ? this.line : null;
  }

  showTool() {
    super.showTool();
    this.line.layer.style.display = this.tool === "length" ? "" : "none";
  }

  /** @returns {NonNullable<BodyOf<"/measure/photograph", "post">["handles"]>} */
  #handles() {
    return {
      centre_px: this.editor.value.centre,
      across_end_px: this.editor.end(0),
      along_end_px: this.editor.end(1),
    };
  }

  dragged() {
    return { change: this.corrections.change, handles: this.#handles() };
  }

  /** Save the ellipse of the handles. */
  dropped() {
    const { item } = this.corrections;
    const handles = this.#handles();
    this.keep(async (change) => {
      const { ellipse_px: ellipse } = await post("/measure/photograph", { item, change, handles });
      return { ...change, ellipse_px: ellipse };
    });
  }

  navigate([wanted]) {
    this.choose(this.entries.findIndex(({ item }) => item === wanted));
    return true;
  }

  update() {
    const now = this.#photographs();
    if (!this.stage) {
      if (!now.length) return;
      this.entries = now;
      render(this.root);
      this.#build();
      return;
    }
    const known = new Map(now.map((entry) => [entry.item, entry]));
    for (const entry of this.entries) Object.assign(entry, known.get(entry.item) ?? {});
    this.strip.refresh();
    this.inspector.head();
    this.refreshMissing();
  }

  close() {
    this.lengths?.cancel();
    super.close();
  }
}

/** Many points as one path: a stroke without length, with round ends, is a dot. @param {Points} points */
const dots = (points) => (points ?? []).map(([row, column]) => `M${column} ${row}h.01`).join("");

/** @param {Photograph} entry */
function describe(entry) {
  const marks = reviewMarks(entry);
  return {
    label: entry.face ?? "face?",
    name: [`${entry.finger}, ${faceWords(entry)}`, ...marks.map(([, words]) => words)].join(", "),
    state: entry.rejected ? "rejected" : "done",
    marks,
  };
}

export const open = (root, rest) => new Photographs(root, rest);
