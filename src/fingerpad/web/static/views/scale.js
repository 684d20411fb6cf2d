// Scales: by a line on a ruler, a coin, or a resolution.

import { get, LatestRequest, post } from "../core/api.js";
import { button, dotsOf, h, pathOf, render, s } from "../core/dom.js";
import { rounded } from "../core/gestures.js";
import { bindHere } from "../core/keys.js";
import { showError, toast } from "../core/messages.js";
import { counted, short } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { Line, ThreePoints } from "../editor/shapes.js";
import { Stage } from "../editor/stage.js";
import {
  attempt,
  chip,
  choiceField,
  empty,
  faultList,
  field,
  head,
  namePattern,
  segments,
  text,
} from "../parts/forms.js";
import { photographs } from "../parts/missing_fields.js";
import { definitionOf, lackingOf, scaleFields, startOf, WAYS, wayOf } from "../parts/scale_ways.js";
import { flagNote } from "./inspector.js";
import { gridWords, rectification, scaleImages } from "./scale_parts.js";

// A scale that is not saved yet, kept while other steps are shown, and over a reload.
const UNSAVED = "fingerpad.scale";
const unsavedScale = () => {
  const draft = JSON.parse(sessionStorage.getItem(UNSAVED) ?? "null");
  return draft?.study === workspace.study?.name ? draft : null;
};

const scaleNamed = (wanted) => workspace.study.scales.find(({ name }) => name === wanted) ?? null;

export class Scales {
  constructor(root, rest) {
    this.root = root;
    this.study = workspace.study.name;
    this.stage = new Stage(
      "Image of a ruler or coin. Arrow keys move the cross-hair, space starts and ends the line.",
    );
    this.line = new Line(this.stage, (ends) => this.#drawn(ends));
    this.coin = s("path.coin");
    this.grid = s("path.grid-points");
    this.stage.world.append(this.coin, this.grid);
    this.rim = new ThreePoints(this.stage, (points) => {
      this.table.circle = points;
      this.#ask();
    });
    this.stage.use(this.line);
    this.result = h("div.result", { "aria-live": "polite" });
    this.form = h("div.stack");
    this.footer = h("div.footer");
    this.list = h("div.scale-list");
    this.actions = h("div.actions");
    this.live = new LatestRequest(
      (table) => post("/measure/scale", { table }),
      (answer) => this.#showResult(answer),
      (error) => this.#failed(error),
      this.result,
    );
    render(root, [
      head("Scale", "Images that share a named scale share its uncertainty.", this.actions),
      h("div.panes.no-tools.scale-panes", [
        h("div.scale-main", [
          this.list,
          this.stage.root,
          (this.plainWords = empty(
            "This scale needs no image",
            "See the data sheet of the scanner or camera. The uncertainty enters every result.",
          )),
        ]),
        h("aside.inspector", { "aria-label": "Selected scale", tabindex: 0 }, [this.form, this.footer]),
      ]),
    ]);
    bindHere([
      ["n", "New scale", () => this.#start(null)],
      ["Ctrl+Enter", "Save scale", () => this.#keep()],
      ["+ - 0", "Zoom in, zoom out, fit the image", null],
      ["Space", "Start and end the line at the cross-hair", null],
    ]);
    const isNew = rest[0] === "+" || unsavedScale();
    this.#start(isNew ? null : (scaleNamed(rest[0]) ?? workspace.study.scales[0] ?? null));
    this.leaving = () => this.#keepDraft();
    addEventListener("pagehide", this.leaving);
  }

  /** @param {State["scales"][number] | null} scale */
  #start(scale) {
    this.live.cancel();
    this.old = scale;
    const draft = scale ? null : unsavedScale();
    sessionStorage.removeItem(UNSAVED);
    this.stage.setScale(null);
    this.name = scale?.name ?? draft?.name ?? "";
    /** @type {ScaleTable} */
    this.table = structuredClone(scale?.table ?? draft?.table ?? startOf("line"));
    this.way = draft?.way ?? wayOf(this.table) ?? "line";
    this.answer = null;
    this.file = this.table.coin ?? this.table.grid ?? this.#guess();
    this.#drawList();
    this.#drawForm();
    this.#show(this.file);
    this.#useTool();
    this.#ask();
  }

  #pictures() {
    const study = workspace.study;
    const used = [
      ...photographs().map(({ file }) => file),
      ...study.observations.map(({ file }) => file),
      ...study.scales.map(({ table }) => /** @type {string | undefined} */ (table.coin)),
      ...study.files.filter(({ kind }) => kind === "picture").map(({ file }) => file),
    ];
    return [...new Set(used.filter(Boolean))];
  }

  #guess() {
    const pictures = this.#pictures();
    return pictures.find((file) => /ruler|scale|coin|euro|cent/i.test(file)) ?? pictures[0] ?? "";
  }

  #drawList() {
    render(this.actions, [
      button("New scale", () => this.#start(null), { key: "n" }),
      workspace.study.ready && h("a.button.primary", { href: "#/run/start" }, "Run the study"),
    ]);
    const item = (kind, name, title, words, uses = null) =>
      button([h("strong", title), h("span.soft", words), uses], () => this.#start(scaleNamed(name)), {
        kind: `scale-item ${kind}`,
        "aria-pressed": String(this.old?.name === name),
      });
    render(this.list, [
      workspace.study.scales.map(({ name, words, used_by: uses }) =>
        item("", name, name, words, chip(counted(uses, "image"))),
      ),
      item("new", undefined, "+ New scale", "ruler, coin, grid or resolution"),
    ]);
  }

  #drawForm() {
    const pictures = this.#pictures();
    const options = pictures.length ? pictures : [["", "no images"]];
    const hint = WAYS[this.way].picture;
    this.images = scaleImages(this.old?.name);
    this.fields = h("div.fields");
    this.nameField = text({
      value: this.name,
      onset: (value) => (this.name = value),
      placeholder: "reader, camera …",
      pattern: namePattern(),
    });
    this.nameField.addEventListener("input", () => (this.name = this.nameField.value.trim()));
    render(this.form, [
      h("section", [
        h("h2", this.old ? `Scale ${this.old.name}` : "New scale"),
        field("Name", this.nameField, { hint: this.old ? "A new name creates a new scale." : undefined }),
      ]),
      h("section", [
        h("h3", "Type of scale"),
        segments(
          "Type of scale",
          Object.entries(WAYS).map(([key, { words }]) => [key, words]),
          this.way,
          (way) => this.#choose(way),
        ),
      ]),
      hint &&
        h(
          "section",
          choiceField("Image", { value: this.file, options, onset: (file) => this.#take(file), hint }),
        ),
      [this.fields, this.result, this.images.parts].map((part) => h("section", part)),
    ]);
    render(this.footer, [
      h("div.actions", [
        button("Save scale", () => this.#keep(), { kind: "primary", key: "Ctrl+Enter" }),
        this.old && button("Delete", () => this.#delete(), { kind: "bad" }),
      ]),
      (this.problem = h("div")),
    ]);
    this.#drawFields();
    this.stage.root.hidden = !hint;
    this.plainWords.hidden = !this.stage.root.hidden;
  }

  #drawFields() {
    const set = (key) => (value) => {
      if (value === null) delete this.table[key];
      else this.table[key] = value;
      this.#ask();
    };
    const fields = { table: this.table, set, redraw: () => this.#drawFields() };
    render(this.fields, scaleFields(this.way, fields));
  }

  #choose(way) {
    this.live.cancel();
    this.way = way;
    this.table = way === wayOf(this.old?.table) ? structuredClone(this.old.table) : startOf(way);
    if (way === "coin" || way === "grid") this.table[way] = this.file;
    this.answer = null;
    this.#drawForm();
    this.form.querySelector("[role=radio][aria-checked=true]")?.focus();
    this.#mark(null);
    this.#useTool();
    if (!this.stage.root.hidden) this.#show(this.file);
    this.#ask();
  }

  /** Draw what is found in the picture. @param {ScaleMeasurement | null} answer */
  #mark(answer) {
    const points = answer?.grid?.points_px ?? [];
    this.coin.setAttribute("d", pathOf(answer?.outline_px));
    this.grid.setAttribute("d", dotsOf(points));
  }

  /** The tool of this type of scale; the others' marks are hidden. */
  #useTool() {
    this.line.set((this.way === "line" && this.table.line) || null);
    this.rim.set((this.way === "circle" && this.table.circle) || []);
    this.stage.use({ line: this.line, circle: this.rim }[this.way] ?? null);
  }

  #take(file) {
    this.live.cancel();
    this.file = file;
    if (this.way === "coin" || this.way === "grid") this.table[this.way] = file;
    this.#mark(null);
    delete this.table.line;
    delete this.table.circle;
    this.#useTool();
    this.#show(file);
    this.#ask();
  }

  async #show(file) {
    if (file !== this.stage.file) this.stage.setScale(null);
    this.stage.file = file;
    if (!file)
      return this.stage.setMessage(
        "Drop an image of a ruler or a coin on the Study page, or enter the resolution.",
      );
    try {
      const info = await get("/picture/info", { item: `file:${file}` });
      if (file === this.file) this.stage.show(info.preview, info.rows_px, info.columns_px, file);
    } catch (error) {
      if (file === this.file) this.stage.setMessage(error.message, "bad");
    }
  }

  #drawn(ends) {
    this.table.line = ends.map(rounded);
    if (this.table.length_mm === undefined) this.fields.querySelector("input")?.focus();
    this.#ask();
  }

  #ask() {
    const lacking = lackingOf(this.table, this.way);
    if (lacking) {
      this.live.cancel();
      render(this.result, h("p.soft", lacking));
      this.line.write("");
    } else this.live.request(definitionOf(this.table, this.way));
  }

  /** @param {ScaleMeasurement} answer */
  #showResult(answer) {
    this.answer = answer;
    this.stage.setScale(answer.mm_per_px.value);
    this.#mark(answer);
    if (this.way === "line") this.line.write(`${this.table.length_mm} mm`);
    const uncertainty =
      answer.relative_std > 0
        ? `relative uncertainty ${short(answer.relative_std * 100, 2)} %`
        : "uncertainty not stated";
    render(this.result, [
      h("h3", "Scale"),
      h("p.figure-big.number", { "data-live": "scale" }, answer.mm_per_px.words),
      h("p.soft.number", `${answer.resolution_ppi.words}, ${uncertainty}`),
      answer.radius_px &&
        h("p.soft.number", `${this.way === "circle" ? "circle" : "coin"}: radius ${answer.radius_px.words}`),
      answer.grid && gridWords(answer.grid),
      flagNote(answer.flags),
      answer.grid &&
        rectification(
          this.old?.name,
          () => definitionOf(this.table, this.way),
          (name) => this.#start(scaleNamed(name)),
          (error) => render(this.problem, faultList(error)),
        ),
    ]);
  }

  #failed(error) {
    this.answer = null;
    render(this.result, faultList(error));
  }

  async #keep() {
    render(this.problem);
    if (!this.name) return this.#wrong("Enter a name for the scale, for example camera.", this.nameField);
    if (!this.nameField.reportValidity())
      return this.#wrong("Name: letters, digits and . _ + - only.", this.nameField);
    const lacking = lackingOf(this.table, this.way);
    if (lacking) return this.#wrong(lacking);
    /** @type {Edit[]} */
    const edits = [
      { kind: "scale", key: this.name, set: definitionOf(this.table, this.way) },
      ...this.images.edits(this.name),
    ];
    if (!(await attempt(this.problem, () => workspace.edit(...edits)))) return;
    const images = edits.length - 1;
    const set = images ? ` and set for ${counted(images, "image")}` : "";
    toast(`Scale ${this.name} saved${set}.`, { kind: "good" });
    this.#start(scaleNamed(this.name));
  }

  #wrong(words, control) {
    render(this.problem, faultList({ message: words }));
    control?.focus();
  }

  async #delete() {
    if (this.old.used_by)
      return this.#wrong(`${this.old.used_by} images use this scale. Choose another scale for them first.`);
    await workspace.edit({ kind: "scale", key: this.old.name, set: null }).catch(showError);
    this.#start(workspace.study.scales[0] ?? null);
  }

  update() {
    this.#drawList();
  }

  #keepDraft() {
    if (this.old || !(this.name || JSON.stringify(this.table) !== JSON.stringify(startOf(this.way)))) return;
    const draft = { study: this.study, name: this.name, way: this.way, table: this.table };
    sessionStorage.setItem(UNSAVED, JSON.stringify(draft));
  }

  close() {
    removeEventListener("pagehide", this.leaving);
    this.#keepDraft();
    this.live.cancel();
    this.stage.close();
  }
}
