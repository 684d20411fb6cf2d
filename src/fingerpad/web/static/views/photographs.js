// Review of the photographs of a finger's faces.

import { LatestRequest, post } from "../core/api.js";
import { dotsOf, render, s } from "../core/dom.js";
import { goTo } from "../core/messages.js";
import { Click } from "../editor/drawing.js";
import { handle } from "../editor/handle.js";
import { Line } from "../editor/shapes.js";
import { missingOf, photographs } from "../parts/missing_fields.js";
import { faceWords, PhotographInspector } from "./photograph_inspector.js";
import { Review } from "./review.js";
import { renderNone, reviewMarks } from "./review_layout.js";

/** @type {Tool[]} */
const TOOLS = [
  ["ellipse", "Drag axes and rotation", "v"],
  ["points", "Add points on the outline", "b"],
  ["erase", "Erase points of the outline", "e"],
  ["box", "Region of interest", "o"],
  ["length", "Measure a length", "l"],
];

const NONE =
  "Photograph two or three faces of the finger (palmar, distal, radial or ulnar) on a plain background " +
  "next to a ruler or coin, and drop the images on the Study page. Semi-axes can also be entered.";

export class Photographs extends Review {
  /** @type {Photograph[]} */
  entries = [];

  nothingToAccept = "No outline was found. Draw a region of interest, add points, or drag the axes.";
  last = ["This was the last photograph.", { kind: "good", action: goTo("Go to contacts", "contacts") }];
  added = [];

  constructor(root, rest) {
    super();
    this.root = root;
    this.entries = photographs();
    if (!this.entries.length) renderNone(root, "Photographs", "No photographs yet", NONE);
    else this.#build(rest[0]);
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
    this.strip.set(this.entries);
    const at = this.entries.findIndex(({ item }) => item === wanted);
    this.choose(Math.max(0, at));
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
    this.line.write("");
    this.inspector.length(null);
    this.#points(null);
  }

  /** Draw the points of the outline. @param {PhotographMeasurement | null} answer */
  #points(answer) {
    this.used.setAttribute("d", dotsOf(answer?.points_px));
    this.out.setAttribute("d", dotsOf(answer?.outliers_px));
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
      this.stage.setMessage("");
      this.editor.place(...answer.handles_px);
      this.#points(answer);
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
      const keep = (edit) =>
        this.keep((change) => ({ ...change, added_points_px: edit(change.added_points_px) }));
      const mark = handle(this.stage, {
        label: `Point ${index + 1} added; Delete removes it`,
        move: (to) => mark.put((now = to)),
        commit: () => keep((kept) => kept.with(index, now)),
        remove: () => keep((kept) => kept.toSpliced(index, 1)),
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

  /** @returns {NonNullable<BodyOf<"/measure/photograph", "post">["handles_px"]>} */
  #handles() {
    return [this.editor.value.centre, this.editor.end(0), this.editor.end(1)];
  }

  dragged() {
    return { change: this.corrections.change, handles_px: this.#handles() };
  }

  /** Save the ellipse of the handles. */
  dropped() {
    const { item } = this.corrections;
    const handles_px = this.#handles();
    this.keep(async (change) => {
      const { ellipse_px: ellipse } = await post("/measure/photograph", { item, change, handles_px });
      return { ...change, ellipse_px: ellipse };
    });
  }

  navigate([wanted]) {
    this.choose(this.entries.findIndex(({ item }) => item === wanted));
    return true;
  }

  update() {
    const now = photographs();
    if (!this.stage) {
      if (!now.length) return;
      this.entries = now;
      render(this.root);
      this.#build();
      return;
    }
    this.renew(this.entries, now);
    this.inspector.head();
    this.refreshMissing();
  }

  close() {
    this.lengths?.cancel();
    super.close();
  }
}

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
