// Scales: by a line on a ruler, a coin, or a resolution.

import { get, LatestRequest, post } from "../core/api.js";
import { h, pathOf, render, s } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { showError, toast } from "../core/messages.js";
import { plain, withStd } from "../core/quantity.js";
import { describeCode, workspace } from "../core/workspace.js";
import { button, chip, choose, faultList, field, NAME, number, segments, text } from "../parts/forms.js";
import { COINS } from "../parts/scale_choice.js";
import { Stage } from "../parts/stage.js";
import { Line, ThreePoints } from "../parts/tools.js";

/** @type {[key: string, words: string][]} */
const WAYS = [
  ["line", "Ruler"],
  ["coin", "Coin"],
  ["circle", "Circle"],
  ["grid", "Grid"],
  ["ppi", "ppi"],
  ["mm_per_px", "mm/px"],
];

// Defaults of a new scale: the ends of a line are drawn to about one pixel.
const DEFAULTS = {
  line: { ends_px_std: 1 },
  circle: { points_px_std: 1 },
  grid: { pattern: "checkerboard" },
};
// Ways that need a picture.
const PICTURED = ["line", "coin", "circle", "grid"];

// ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
const KNOWN_LENGTHS = [
  ["", "a ruler, or other"],
  ["85.6", "a bank card's long side, 85.60 mm"],
  ["53.98", "a bank card's short side, 53.98 mm"],
];
// A scale that is not saved yet, kept while other steps are shown, and over a reload.
const UNSAVED = "fingerpad.scale";
const unsavedScale = () => {
  const draft = JSON.parse(sessionStorage.getItem(UNSAVED) ?? "null");
  return draft?.study === workspace.study?.name ? draft : null;
};

class Scales {
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
    this.list = h("div.scale-list");
    this.live = new LatestRequest(
      (table) => post("/api/measure/scale", { table }),
      (answer) => this.#showResult(answer),
      (error) => this.#failed(error),
      this.result,
    );
    render(
      root,
      h(
        "header.head",
        null,
        h(
          "div",
          null,
          h("h1", null, "Scale"),
          h("p", null, "Every image needs a scale. Images that share a named scale share its uncertainty."),
        ),
        (this.actions = h("div.actions")),
      ),
      h(
        "div.panes.no-tools.scale-panes",
        null,
        h(
          "div.scale-main",
          null,
          this.list,
          this.stage.root,
          (this.plainWords = h(
            "div.empty",
            { hidden: true },
            h("h2", null, "This scale needs no image"),
            h("p", null, "See the data sheet of the scanner or camera. The uncertainty enters every result."),
          )),
        ),
        h("aside.inspector", { "aria-label": "Selected scale", tabindex: 0 }, this.form),
      ),
    );
    bindHere([
      ["n", "New scale", () => this.#start(null)],
      ["Ctrl+Enter", "Save scale", () => this.#keep()],
      ["+ - 0", "Zoom in, zoom out, fit the image", null],
      ["Space", "Start and end the line at the cross-hair", null],
    ]);
    const first = workspace.study.scales.find(({ name }) => name === rest[0]) ?? workspace.study.scales[0];
    this.#start(unsavedScale() ? null : (first ?? null));
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
    this.table = structuredClone(scale?.table ?? draft?.table ?? DEFAULTS.line);
    this.way = draft?.way ?? this.#wayOf(this.table) ?? "line";
    this.answer = null;
    this.file = this.table.coin ?? this.table.grid ?? this.#guess();
    this.#drawList();
    this.#drawForm();
    this.#show(this.file);
    this.line.set(this.table.line ?? null);
    this.line.kept = this.table.line;
    this.#useTool();
    this.#ask();
  }

  #pictures() {
    const study = workspace.study;
    const used = [
      ...study.fingers.flatMap(({ photographs }) =>
        (photographs ?? []).filter(({ outline }) => !outline).map(({ file }) => file),
      ),
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
    render(
      this.actions,
      button("New scale", () => this.#start(null), { key: "n" }),
      workspace.study.ready && h("a.button.primary", { href: "#/run/start" }, "Run the study"),
    );
    render(
      this.list,
      workspace.study.scales.map(({ name, table, used_by: uses }) =>
        h(
          "button.scale-item",
          {
            type: "button",
            "aria-pressed": String(this.old?.name === name),
            onclick: () => this.#start(workspace.study.scales.find((scale) => scale.name === name)),
          },
          h("strong", null, name),
          h("span.soft", null, words(table)),
          chip(`${uses} image${uses === 1 ? "" : "s"}`),
        ),
      ),
      h(
        "button.scale-item.new",
        { type: "button", "aria-pressed": String(!this.old), onclick: () => this.#start(null) },
        h("strong", null, "+ New scale"),
        h("span.soft", null, "ruler, coin, grid or resolution"),
      ),
    );
  }

  #drawForm() {
    const pictures = this.#pictures();
    this.fields = h("div.fields");
    this.nameField = text({
      value: this.name,
      onset: (value) => (this.name = value),
      placeholder: "reader, camera …",
      pattern: NAME,
    });
    this.nameField.addEventListener("input", () => (this.name = this.nameField.value.trim()));
    render(
      this.form,
      h(
        "section",
        null,
        h("h2", null, this.old ? `Scale ${this.old.name}` : "New scale"),
        field("Name", this.nameField, { hint: this.old ? "A new name creates a new scale." : undefined }),
      ),
      h(
        "section",
        null,
        h("h3", null, "Type of scale"),
        segments("Type of scale", WAYS, this.way, (way) => this.#choose(way)),
      ),
      PICTURED.includes(this.way) &&
        h(
          "section",
          null,
          field(
            "Image",
            choose({
              value: this.file,
              options: pictures.length ? pictures : [["", "no images"]],
              onset: (file) => this.#take(file),
            }),
            {
              hint: {
                line: "Draw a line between two marks of the ruler.",
                coin: "The whole coin, parallel to the image plane, on a plain background.",
                circle: "Click three points on the rim of a coin, far apart; drag them to move them.",
                grid: "A flat checkerboard or grid of dots where the finger touches, on a light margin.",
              }[this.way],
            },
          ),
        ),
      h("section", null, this.fields),
      h("section", null, this.result),
      h("section", null, this.#uses()),
      h(
        "section",
        null,
        h(
          "div.actions",
          null,
          (this.keepButton = button("Save scale", () => this.#keep(), {
            kind: "primary",
            key: "Ctrl+Enter",
          })),
          this.old && button("Delete", () => this.#delete(), { kind: "bad" }),
        ),
        (this.problem = h("div")),
      ),
    );
    this.#drawFields();
    this.stage.root.hidden = !PICTURED.includes(this.way);
    this.plainWords.hidden = !this.stage.root.hidden;
  }

  #drawFields() {
    const set = (key) => (value) => {
      if (value === null) delete this.table[key];
      else this.table[key] = value;
      this.#ask();
    };
    const of = (key, more) => number({ value: this.table[key], min: 0, onset: set(key), ...more });
    const diameter = () => [
      field(
        "Coin type",
        choose({
          value: String(this.table.diameter_mm ?? ""),
          options: COINS,
          onset: (value) => value && (set("diameter_mm")(Number(value)), this.#drawFields()),
        }),
        { wide: true },
      ),
      field("Diameter", of("diameter_mm"), { unit: "mm" }),
      field("Uncertainty", of("diameter_mm_std", { placeholder: "not stated" }), { unit: "mm" }),
    ];
    const ways = {
      line: () => [
        field(
          "Line along",
          choose({
            value: String(this.table.length_mm ?? ""),
            options: KNOWN_LENGTHS,
            onset: (value) => value && (set("length_mm")(Number(value)), this.#drawFields()),
          }),
        ),
        field("Length of the line", of("length_mm"), { unit: "mm" }),
        field("Uncertainty", of("length_mm_std", { placeholder: "not stated" }), { unit: "mm" }),
        field("Uncertainty of each end", of("ends_px_std", { placeholder: "not stated" }), { unit: "px" }),
      ],
      coin: diameter,
      circle: () => [
        ...diameter(),
        field("Uncertainty of each point", of("points_px_std", { placeholder: "not stated" }), {
          unit: "px",
        }),
      ],
      grid: () => [
        field(
          "Pattern",
          choose({
            value: this.table.pattern ?? "checkerboard",
            options: [
              ["checkerboard", "checkerboard: inner corners count"],
              ["dots", "grid of dots"],
            ],
            onset: set("pattern"),
          }),
          { wide: true },
        ),
        ...["down", "along"].map((words, place) =>
          field(
            `Points ${words}`,
            number({
              value: this.table.points?.[place] ?? null,
              min: 3,
              onset: (value) => {
                const points = [...(this.table.points ?? [null, null])];
                points[place] = value === null ? null : Math.round(value);
                this.table.points = points;
                this.#ask();
              },
            }),
          ),
        ),
        field("Spacing", of("spacing_mm"), { unit: "mm" }),
        field("Uncertainty", of("spacing_mm_std", { placeholder: "not stated" }), { unit: "mm" }),
      ],
      ppi: () => [
        field("Pixels per inch", of("ppi"), { unit: "ppi" }),
        field("Relative uncertainty", of("relative_std", { placeholder: "not stated", max: 1 }), {
          hint: "0.01 is 1 %",
        }),
      ],
      mm_per_px: () => [
        field("Millimetres per pixel", of("mm_per_px"), { unit: "mm/px" }),
        field("Relative uncertainty", of("relative_std", { placeholder: "not stated", max: 1 }), {
          hint: "0.01 is 1 %",
        }),
      ],
    };
    render(this.fields, ways[this.way]());
  }

  #choose(way) {
    this.live.cancel();
    this.way = way;
    this.table =
      way === this.#wayOf(this.old?.table) ? structuredClone(this.old.table) : { ...DEFAULTS[way] };
    if (way === "coin" || way === "grid") this.table[way] = this.file;
    this.answer = null;
    this.#drawForm();
    this.form.querySelector("[role=radio][aria-checked=true]")?.focus();
    this.coin.setAttribute("d", "");
    this.grid.setAttribute("d", "");
    this.line.set(way === "line" ? (this.table.line ?? null) : null);
    this.#useTool();
    if (!this.stage.root.hidden) this.#show(this.file);
    this.#ask();
  }

  /** The tool of this type of scale; the others' marks are hidden. */
  #useTool() {
    this.rim.set(this.way === "circle" ? (this.table.circle ?? []) : []);
    this.stage.use({ line: this.line, circle: this.rim }[this.way] ?? null);
  }

  #wayOf(table) {
    return WAYS.map(([key]) => key).find((key) => table?.[key] !== undefined);
  }

  #take(file) {
    this.live.cancel();
    this.file = file;
    if (this.way === "coin" || this.way === "grid") this.table[this.way] = file;
    this.coin.setAttribute("d", "");
    this.grid.setAttribute("d", "");
    this.line.set(null);
    delete this.table.line;
    this.rim.set([]);
    delete this.table.circle;
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
      const info = await get("/api/picture/info", { item: `file:${file}` });
      if (file === this.file) this.stage.show(info.preview, info.rows_px, info.columns_px, file);
    } catch (error) {
      if (file === this.file) this.stage.setMessage(error.message, "bad");
    }
  }

  #drawn(ends) {
    this.table.line = ends.map((point) => point.map((value) => Math.round(value * 100) / 100));
    if (this.table.length_mm === undefined) this.fields.querySelector("input")?.focus();
    this.#ask();
  }

  /** The table with the keys of this type of scale that are filled in. */
  #definition() {
    const keys = {
      line: ["line", "length_mm", "length_mm_std", "ends_px_std"],
      coin: ["coin", "diameter_mm", "diameter_mm_std"],
      circle: ["circle", "diameter_mm", "diameter_mm_std", "points_px_std"],
      grid: ["grid", "pattern", "points", "spacing_mm", "spacing_mm_std"],
      ppi: ["ppi", "relative_std"],
      mm_per_px: ["mm_per_px", "relative_std"],
    }[this.way];
    return Object.fromEntries(
      keys.filter((key) => this.table[key] !== undefined).map((key) => [key, this.table[key]]),
    );
  }

  /** What is still to be entered, null when the scale is complete. */
  #lacking() {
    const needs = {
      line: ["line", "length_mm"],
      coin: ["coin", "diameter_mm"],
      circle: ["circle", "diameter_mm"],
      grid: ["grid", "points", "spacing_mm"],
      ppi: ["ppi"],
      mm_per_px: ["mm_per_px"],
    }[this.way];
    const given = (value) =>
      value !== undefined && value !== "" && !(Array.isArray(value) && value.includes(null));
    if (needs.every((key) => given(this.table[key]))) return null;
    return {
      line: this.table.line ? "Enter the length of the line." : "Draw a line on the ruler.",
      coin: "Select or enter the coin's diameter.",
      circle: this.table.circle ? "Enter the diameter." : "Click three points on the rim.",
      grid: "Count the points of the grid, and enter their spacing.",
      ppi: "Enter the resolution.",
      mm_per_px: "Enter the size of a pixel.",
    }[this.way];
  }

  #ask() {
    const lacking = this.#lacking();
    if (lacking) {
      this.live.cancel();
      render(this.result, h("p.soft", null, lacking));
      this.line.write("");
    } else this.live.request(this.#definition());
  }

  /** @param {ScaleMeasurement} answer */
  #showResult(answer) {
    this.answer = answer;
    this.stage.setScale(answer.mm_per_px);
    this.coin.setAttribute("d", pathOf(answer.coin?.outline_px));
    this.grid.setAttribute(
      "d",
      (answer.grid?.points_px ?? []).map(([row, column]) => `M${column} ${row}h0`).join(""),
    );
    if (this.way === "line") this.line.write(`${plain(this.table.length_mm)} mm`);
    render(
      this.result,
      h("h3", null, "Scale"),
      h(
        "p.figure-big.number",
        { "data-live": "scale" },
        withStd(answer.mm_per_px, answer.mm_per_px_std),
        h("span.unit", null, " mm/px"),
      ),
      h(
        "p.soft.number",
        null,
        `${plain(answer.resolution_ppi)} ppi`,
        answer.relative_std > 0
          ? `, relative uncertainty ${plain(answer.relative_std * 100)} %`
          : ", uncertainty not stated",
      ),
      answer.coin &&
        h(
          "p.soft.number",
          null,
          `${this.way === "circle" ? "circle" : "coin"}: radius ${withStd(answer.coin.radius_px, answer.coin.radius_px_std)} px`,
        ),
      answer.grid && gridWords(answer.grid),
      answer.flags?.length > 0 &&
        h(
          "div.note",
          null,
          answer.flags.map((flag) => h("p", null, describeCode(flag))),
        ),
      answer.grid && this.#rectification(),
    );
  }

  /** Contact images with this scale, and the button that rectifies them. */
  #rectification() {
    const images = workspace.study.observations.filter(
      ({ file, scale }) => file && this.old && scale === this.old.name,
    );
    if (!images.length)
      return h("p.soft", null, "Once contact images use this scale, they can be rectified here.");
    return button(
      `Rectify ${images.length} contact image${images.length > 1 ? "s" : ""}`,
      () => this.#rectify(images),
      { kind: "small", title: "Write them as if seen straight on, and measure these instead" },
    );
  }

  async #rectify(images) {
    const name = `${this.old.name}_rectified`;
    try {
      const { files, mm_per_px, relative_std } = await post("/api/scale/rectify", {
        table: /** @type {any} */ (this.#definition()),
        files: [...new Set(images.map(({ file }) => file))],
      });
      await workspace.edit(
        { kind: "scale", key: name, set: { mm_per_px, relative_std } },
        ...images.map(({ item, file }) => ({
          kind: "observation",
          key: item,
          set: { file: files[file], scale: name },
        })),
      );
      toast(`${images.length} rectified, with the scale ${name}. The pictures before stay where they are.`, {
        kind: "good",
      });
      this.#start(workspace.study.scales.find((scale) => scale.name === name) ?? null);
    } catch (error) {
      render(this.problem, faultList(error));
    }
  }

  #failed(error) {
    this.answer = null;
    render(this.result, faultList(error));
  }

  /** Choice of the images with this scale. */
  #uses() {
    const study = workspace.study;
    const rows = [
      ...study.fingers.flatMap((finger) =>
        (finger.photographs ?? [])
          .filter(({ outline }) => !outline)
          .map((each) => ["photograph", each.item, `${finger.name}, ${each.face ?? "?"} face`, each.scale]),
      ),
      ...study.observations
        .filter(({ file }) => file)
        .map((each) => ["observation", each.item, each.item, each.scale]),
      ...study.sequences.map((each) => ["sequence", each.name, `sequence ${each.name}`, each.scale]),
    ];
    this.takers = new Map();
    // Photographs and contact images rarely share a camera: select those of the first kind that lacks a scale.
    const lacking = rows.find((row) => !row[3])?.[0];
    const boxes = rows.map(([kind, key, label, scale]) => {
      const mine = this.old && scale === this.old.name;
      const box = h("input", {
        type: "checkbox",
        checked: mine || (!this.old && !scale && kind === lacking),
      });
      this.takers.set(box, { kind, key, scale });
      return h(
        "label.check",
        { "data-kind": kind },
        box,
        h("span", null, label),
        h(
          "span.soft",
          null,
          scale ? (mine ? "" : typeof scale === "string" ? scale : "own scale") : "none yet",
        ),
      );
    });
    const only = (kind) => {
      for (const [box, taker] of this.takers) box.checked = taker.kind === kind;
    };
    const has = (kind) => rows.some(([other]) => other === kind);
    return [
      h("h3", null, "Images with this scale"),
      rows.length
        ? h("div.takers", { tabindex: 0, role: "group", "aria-label": "Images with this scale" }, boxes)
        : h("p.soft", null, "No images yet; choose this scale when you add them."),
      h(
        "div.actions",
        null,
        has("photograph") && button("Only photographs", () => only("photograph"), { kind: "small" }),
        has("observation") && button("Only contact images", () => only("observation"), { kind: "small" }),
      ),
    ];
  }

  async #keep() {
    render(this.problem);
    if (!this.name) return this.#wrong("Enter a name for the scale, for example camera.", this.nameField);
    if (!this.nameField.reportValidity())
      return this.#wrong("Name: letters, digits and . _ + - only.", this.nameField);
    const lacking = this.#lacking();
    if (lacking) return this.#wrong(lacking);
    /** @type {Edit[]} */
    const edits = [{ kind: "scale", key: this.name, set: this.#definition() }];
    for (const [box, { kind, key, scale }] of this.takers) {
      if (box.checked && scale !== this.name) edits.push({ kind, key, set: { scale: this.name } });
    }
    try {
      await workspace.edit(...edits);
      toast(
        edits.length > 1
          ? `Scale ${this.name} saved and set for ${edits.length - 1} image${edits.length > 2 ? "s" : ""}.`
          : `Scale ${this.name} saved.`,
        { kind: "good" },
      );
      this.#start(workspace.study.scales.find(({ name }) => name === this.name) ?? null);
    } catch (error) {
      render(this.problem, faultList(error));
    }
  }

  #wrong(words, control) {
    render(this.problem, h("div.faults", { role: "alert" }, h("p", null, words)));
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
    if (this.old || !(this.name || JSON.stringify(this.table) !== JSON.stringify(DEFAULTS[this.way] ?? {})))
      return;
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

/** @param {ScaleTable} table */
function words(table) {
  if (table.ppi !== undefined) return `${table.ppi} ppi`;
  if (table.mm_per_px !== undefined) return `${table.mm_per_px} mm/px`;
  if (table.line) return `line of ${table.length_mm} mm`;
  if (table.coin) return `coin of ${table.diameter_mm} mm`;
  if (table.circle) return `circle of ${table.diameter_mm} mm`;
  if (table.grid) return `grid of ${table.spacing_mm} mm`;
  return "incomplete";
}

/** @param {NonNullable<ScaleMeasurement["grid"]>} grid */
function gridWords(grid) {
  const percent = (share) => `${(100 * share).toFixed(share < 0.001 ? 2 : 1)} %`;
  return h(
    "dl.grid-words.number",
    null,
    [
      ["Points off the plane", `${grid.residual_px.toFixed(2)} px`],
      ["Sides of a pixel differ by", percent(grid.anisotropy)],
      ["Scale differs over the grid by", percent(grid.variation)],
      ["Left once rectified", percent(grid.unevenness)],
      [
        "Once rectified, mm/px",
        `${withStd(grid.rectified_mm_per_px, grid.rectified_mm_per_px * grid.rectified_relative_std)}`,
      ],
    ].map(([words, value]) => [h("dt", null, words), h("dd", null, value)]),
  );
}

export const open = (root, rest) => new Scales(root, rest);
