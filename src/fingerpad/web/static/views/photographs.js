// Photographs of the finger's faces: the outline found, the ellipse fitted, and all faces together as one pad.

import { get, Newest, picture, post } from "../core/api.js";
import { bench } from "../core/bench.js";
import { Corrections, plainChange } from "../core/corrections.js";
import { h, place, s } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { complain, say } from "../core/messages.js";
import { quantityText } from "../core/quantity.js";
import { EllipseEditor } from "../parts/ellipse_editor.js";
import { Filmstrip } from "../parts/filmstrip.js";
import { empty, segments } from "../parts/forms.js";
import { icons } from "../parts/icons.js";
import { handle } from "../parts/handle.js";
import { Stage } from "../parts/stage.js";
import { Box, Brush, Click, Line } from "../parts/tools.js";
import { whoButton } from "../parts/who.js";
import { PhotographInspector } from "./photograph_inspector.js";

const TOOLS = [
  ["ellipse", "Look, drag the axes and turn", { icon: icons.ellipse, shortcut: "v" }],
  ["points", "Add points on the outline", { icon: icons.points, shortcut: "b" }],
  ["erase", "Rub out points of the outline", { icon: icons.eraser, shortcut: "e" }],
  ["box", "Region of interest", { icon: icons.box, shortcut: "o" }],
  ["length", "Measure a length", { icon: icons.ruler, shortcut: "l" }],
];

class Photographs {
  constructor(root, rest) {
    this.root = root;
    this.tool = "ellipse";
    this.radius = 12;
    this.at = -1;
    this.entries = this.#photographs();
    if (!this.entries.length) this.#nothing();
    else this.#build(rest[0]);
  }

  #photographs() {
    return bench.study.fingers.flatMap((finger) => (finger.photographs ?? []).filter(({ outline }) => !outline).map((photograph) => ({ ...photograph, finger: finger.name, synthetic: finger.synthetic || photograph.synthetic })));
  }

  #nothing() {
    place(
      this.root,
      h("header.head", null, h("h1", null, "Photographs")),
      empty(
        "No photographs yet",
        "Photograph two or three faces of the finger (palmar, distal, radial or ulnar) before a plain backdrop, with a ruler or a coin beside it, and drop the pictures on the Study page. A finger may also have its semi-axes typed in.",
        h("a.button.primary", { href: "#/study" }, "To the study"),
      ),
    );
  }

  #build(wanted) {
    this.stage = new Stage("Photograph of a finger. Arrow keys move the cross-hair of a tool, space presses it.");
    this.stage.root.classList.add("face");
    this.used = s("path.arc-points");
    this.out = s("path.out-points");
    this.mark = h("span.synthetic.stage-synthetic", { hidden: true }, "synthetic");
    this.stage.root.append(this.mark);
    this.editor = new EllipseEditor(this.stage, ["semi-axis across", "semi-axis along"], (shape, final) => this.#dragged(final));
    this.editor.layer.before(this.used, this.out);
    this.box = new Box(this.stage, (box) => this.#keep((change) => ({ ...change, region_of_interest_px: box })));
    this.line = new Line(this.stage, (ends) => this.lengths.ask(ends));
    this.added = [];
    this.toolbar = segments("Tools", TOOLS, this.tool, (tool) => this.use(tool), { vertical: true });
    this.strip = new Filmstrip({ label: "Photographs", chosen: (index) => this.#choose(index), describe });
    this.inspector = new PhotographInspector(this);
    this.live = new Newest((asked) => post("/api/measure/photograph", { item: this.entry.item, with_finger: true, ...asked }), (answer) => this.#show(answer, { live: true }), (error) => this.stage.say(error.message, "bad"));
    this.lengths = new Newest(
      (ends) => post("/api/measure/length", { scale: this.entry.scale, line_px: ends, ends_std_px: 1 }),
      (answer) => this.#length(answer),
      (error) => this.stage.say(error.message, "bad"),
    );
    place(
      this.root,
      h("header.head", null, h("div", null, h("h1", null, "Photographs"), h("p", null, "Drag the ellipse onto the arc that is pad; the three faces together give the semi-axes.")), h("div.actions", null, whoButton())),
      h(
        "div.bench",
        null,
        this.toolbar,
        this.stage.root,
        h("aside.inspector", { "aria-label": "The photograph that is open", tabindex: 0 }, this.inspector.root, this.inspector.footer),
        h("section.film", { "aria-label": "All photographs" }, this.strip.root),
      ),
    );
    this.#keys();
    this.strip.set(this.entries);
    this.#choose(Math.max(0, this.entries.findIndex(({ item }) => item === wanted)));
  }

  #keys() {
    bindHere([
      ["Enter", "Accept and go to the next", () => this.accept()],
      ["ArrowRight .", "Next photograph", () => this.#step(1)],
      ["ArrowLeft ,", "Photograph before", () => this.#step(-1)],
      ["x", "Reject, or take back", () => this.reject()],
      ["u Ctrl+z", "Undo", () => this.undo()],
      ["r Ctrl+y Ctrl+Z", "Redo", () => this.redo()],
      ["v", "Look, drag the axes and turn", () => this.use("ellipse")],
      ["b", "Add points on the outline", () => this.use("points")],
      ["e", "Rub out points", () => this.use("erase")],
      ["o", "Region of interest", () => this.use("box")],
      ["l", "Measure a length", () => this.use("length")],
      ["[ ]", "Smaller or larger rubber", (event) => this.setRadius(Math.round(Math.min(200, Math.max(2, this.radius * (event.key === "]" ? 1.25 : 0.8)))))],
      ["+ - 0", "Zoom in, zoom out, fit the picture", null],
      ["Tab", "To the handles; arrow keys move one, Shift ×10, Alt ×⅕", null],
      ["Space", "Press the tool at the cross-hair", null],
    ]);
  }

  get entry() {
    return this.entries[this.at];
  }

  async #choose(index) {
    if (index === this.at || !this.entries[index]) return;
    this.at = index;
    const { item } = this.entry;
    this.strip.choose(index);
    if (document.activeElement?.closest(".handle")) this.stage.root.focus({ preventScroll: true });
    history.replaceState(null, "", `#/photographs/${encodeURIComponent(item)}`);
    this.corrections?.close();
    this.measured = null;
    this.line.set(null);
    this.editor.hide();
    this.used.setAttribute("d", "");
    this.out.setAttribute("d", "");
    this.mark.hidden = !this.entry.synthetic;
    this.corrections = new Corrections(item, () => this.#corrected());
    const mine = this.corrections;
    this.inspector.wait();
    try {
      const [info] = await Promise.all([get("/api/picture/info", { item }), mine.load()]);
      if (this.corrections !== mine) return;
      this.stage.show(info.preview ?? picture("preview", item), info.rows_px, info.columns_px, `Photograph, ${this.entry.face} face of ${this.entry.finger}`);
      await this.remeasure();
    } catch (error) {
      if (this.corrections === mine) this.#failed(error);
    }
  }

  async remeasure() {
    const mine = this.corrections;
    try {
      // This face first: the other faces of the finger may still have to be measured.
      const answer = await post("/api/measure/photograph", { item: mine.item });
      if (this.corrections !== mine) return;
      this.#show(answer);
      const whole = await post("/api/measure/photograph", { item: mine.item, with_finger: true });
      if (this.corrections !== mine) return;
      this.#show(whole, { live: true });
      if (answer.by !== "program" && !this.own?.[mine.item]) this.#askOwn(mine);
    } catch (error) {
      if (this.corrections === mine) this.#failed(error);
    }
  }

  /** The program's own result, to stand beside the correction. */
  async #askOwn(mine) {
    const answer = await post("/api/measure/photograph", { item: mine.item, change: {} }).catch(() => null);
    this.own = { ...this.own, [mine.item]: answer };
    if (this.corrections === mine && this.measured) this.inspector.show(this.measured);
  }

  #failed(error) {
    this.measured = null;
    this.editor.hide();
    this.stage.say(error.message, "bad");
    this.inspector.show(null, error.message);
  }

  #show(answer, { live = false } = {}) {
    if (answer.item !== this.entry.item) return;
    this.measured = answer;
    this.stage.setScale(answer.mm_per_px);
    if (!live) {
      this.stage.say("");
      const { centre_px: centre, across_end_px: across, along_end_px: along } = answer.handles;
      this.editor.show(centre, across, along);
      this.used.setAttribute("d", dots(answer.points_px));
      this.out.setAttribute("d", dots(answer.outliers_px));
      this.brush?.dry();
      this.#showTool();
    }
    if (answer.by === "program" && !live) this.own = { ...this.own, [answer.item]: answer };
    this.inspector.show(answer, null, this.own?.[answer.item]);
  }

  #length(answer) {
    this.line.write(quantityText(answer, "length_mm"));
    this.inspector.length(answer);
  }

  #corrected() {
    const { change } = this.corrections.document;
    const entry = this.entries.find(({ item }) => item === this.corrections.item);
    entry.accepted = Boolean(change.accepted);
    entry.rejected = change.rejected ?? null;
    entry.corrected = Object.keys(change).some((key) => !["accepted", "rejected"].includes(key));
    this.strip.refresh();
    this.stage.root.classList.toggle("rejected", Boolean(change.rejected));
    this.box.set(change.region_of_interest_px ?? null);
    this.#drawAdded(change.added_points_px ?? []);
    this.#showTool();
    this.inspector.corrected();
  }

  #drawAdded(points) {
    for (const each of this.added) each.remove();
    this.added = points.map((at, index) => {
      let now = at;
      const mark = handle(this.stage, {
        label: `Point ${index + 1} added; Delete takes it away`,
        move: (to) => mark.put((now = to)),
        commit: () => now !== at && this.#keep((change) => ({ ...change, added_points_px: change.added_points_px.map((point, other) => (other === index ? now : point)) })),
        remove: () => this.#keep((change) => ({ ...change, added_points_px: change.added_points_px.filter((_, other) => other !== index) })),
      });
      this.stage.world.append(mark.node);
      mark.put(at);
      return mark;
    });
  }

  use(tool) {
    this.tool = tool;
    this.toolbar.show(tool);
    this.brush = null;
    if (tool === "points") {
      this.stage.use(new Click((at) => this.#keep((change) => ({ ...change, ellipse_px: null, added_points_px: [...(change.added_points_px ?? []), at] }))));
    } else if (tool === "erase") {
      const done = ({ points_px, radius_px }) => this.#keep((change) => ({ ...change, ellipse_px: null, erased: [...(change.erased ?? []), { points_px, radius_px }] }));
      this.brush = new Brush(this.stage, { action: "remove", radius: this.radius, done });
      this.stage.use(this.brush);
    } else if (tool === "box") this.stage.use(this.box);
    else if (tool === "length") this.stage.use(this.line);
    else this.stage.use(null);
    this.#showTool();
    this.inspector.tool();
    this.stage.root.focus({ preventScroll: true });
  }

  #showTool() {
    const editing = this.tool === "ellipse" && this.measured && !this.corrections?.change.rejected;
    for (const { node } of Object.values(this.editor.handles)) node.style.display = editing ? "" : "none";
    this.editor.stalk.style.display = editing ? "" : "none";
    this.box.layer.style.display = this.tool === "box" || this.box.box ? "" : "none";
    for (const { node } of this.box.handles) node.style.display = this.tool === "box" ? "" : "none";
    this.line.layer.style.display = this.tool === "length" ? "" : "none";
  }

  setRadius(radius) {
    this.radius = radius;
    this.brush?.setRadius(radius);
    this.inspector.tool();
  }

  #dragged(final) {
    const handles = { centre_px: this.editor.shape.centre, across_end_px: this.editor.end(0), along_end_px: this.editor.end(1) };
    const { ellipse_px: _, ...change } = this.corrections.change;
    if (!final) this.live.ask({ change, handles });
    else this.#place(change, handles);
  }

  /** The library turns handles into the ellipse that is kept. */
  async #place(change, handles) {
    const mine = this.corrections;
    const answer = await post("/api/measure/photograph", { item: mine.item, change, handles, with_finger: true }).catch(complain);
    if (!answer?.ellipse_px) return;
    if (this.corrections === mine) this.#show(answer, { live: true });
    await this.#keep((now) => ({ ...now, ellipse_px: answer.ellipse_px }), { measure: false });
    if (!this.own?.[mine.item]) this.#askOwn(mine);
  }

  set(key, value) {
    return this.#keep((change) => ({ ...change, [key]: value }));
  }

  async #keep(edit, { measure = true } = {}) {
    const mine = this.corrections;
    try {
      await mine.keep((change) => plainChange({ ...edit(change), accepted: false, rejected: null }));
      if (measure && this.corrections === mine) await this.remeasure();
    } catch (error) {
      complain(error);
      if (this.corrections === mine) await this.remeasure();
    }
  }

  async accept() {
    const mine = this.corrections;
    if (!this.measured) return say("There is no outline to accept. Draw a region of interest, add points, or drag the axes.", { kind: "error" });
    if (!mine.change.accepted) await mine.keep((change) => plainChange({ ...change, accepted: true, rejected: null })).catch(complain);
    if (this.entries[this.at + 1]) this.#step(1);
    else say("That was the last photograph.", { kind: "good", action: { words: "To the contacts", do: () => (location.hash = "#/contacts") } });
  }

  async reject() {
    const { rejected } = this.corrections.change;
    await this.corrections.keep((change) => plainChange({ ...change, accepted: false, rejected: rejected ? null : this.inspector.reason() })).catch(complain);
  }

  async undo() {
    await this.#history("undo");
  }

  async redo() {
    await this.#history("redo");
  }

  async #history(way) {
    const mine = this.corrections;
    if (!mine.document[`can_${way}`]) return;
    await mine[way]().catch(complain);
    if (this.corrections === mine) await this.remeasure();
  }

  async revert() {
    const mine = this.corrections;
    await mine.keep(() => ({})).catch(complain);
    if (this.corrections === mine) await this.remeasure();
  }

  #step(by) {
    if (this.entries[this.at + by]) this.#choose(this.at + by);
  }

  turn(rest) {
    const index = this.entries.findIndex(({ item }) => item === rest[0]);
    if (index >= 0 && this.stage) this.#choose(index);
  }

  update() {
    if (!this.stage && this.#photographs().length) {
      this.entries = this.#photographs();
      place(this.root);
      this.#build();
    }
  }

  close() {
    this.corrections?.close();
    this.live?.drop();
    this.lengths?.drop();
    this.stage?.close();
    this.strip?.close();
  }
}

/** Many points as one path: a stroke of no length with round ends is a dot. */
const dots = (points) => (points ?? []).map(([row, column]) => `M${column} ${row}h.01`).join("");

function describe(entry) {
  const marks = [];
  if (entry.flags?.length) marks.push(["flag", entry.flags.join(", ")]);
  if (entry.corrected) marks.push(["corrected", "corrected by a person"]);
  if (entry.accepted) marks.push(["accepted", "accepted"]);
  if (entry.rejected) marks.push(["rejected", `rejected: ${entry.rejected}`]);
  return { label: entry.face, name: [`${entry.finger}, ${entry.face} face`, ...marks.map(([, words]) => words)].join(", "), state: entry.rejected ? "rejected" : "done", marks };
}

export const open = (root, rest) => new Photographs(root, rest);
