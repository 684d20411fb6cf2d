// Contact images and frames: what the program found, what a person says of it, and on to the next.

import { get, Newest, picture, post } from "../core/api.js";
import { bench, doubts } from "../core/bench.js";
import { Corrections, plainChange } from "../core/corrections.js";
import { h, place } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { complain, say } from "../core/messages.js";
import { plain } from "../core/quantity.js";
import { EllipseEditor } from "../parts/ellipse_editor.js";
import { Filmstrip } from "../parts/filmstrip.js";
import { button, choose, empty, segments } from "../parts/forms.js";
import { icons } from "../parts/icons.js";
import { Stage } from "../parts/stage.js";
import { Box, Brush, Click } from "../parts/tools.js";
import { whoButton } from "../parts/who.js";
import { scaleWords } from "../parts/scale_choice.js";
import { describe, FILTERS, WANTED } from "./contact_entries.js";
import { ContactInspector } from "./contact_inspector.js";
import { ContactOverlay } from "./contact_overlay.js";

const TOOLS = [
  ["ellipse", "Look and drag the ellipse", { icon: icons.ellipse, shortcut: "v" }],
  ["add", "Brush: add to the region", { icon: icons.add, shortcut: "b" }],
  ["remove", "Brush: take from the region", { icon: icons.remove, shortcut: "e" }],
  ["seed", "Seed point inside the right patch", { icon: icons.seed, shortcut: "s" }],
  ["box", "Region of interest", { icon: icons.box, shortcut: "o" }],
];

class Contacts {
  constructor(root, rest) {
    this.root = root;
    this.filter = "";
    this.tool = "ellipse";
    this.radius = 14;
    this.at = -1;
    this.entries = [];
    this.measured = null;
    this.source = this.#sources().some(([key]) => key === rest[0]) ? rest[0] : this.#sources()[0]?.[0];
    this.wanted = rest[1];
    if (!this.source) this.#nothing();
    else this.#build();
  }

  #sources() {
    const images = bench.study.observations.filter(({ file }) => file).length;
    return [
      ...(images ? [["images", `Contact images (${images})`]] : []),
      ...bench.study.sequences.filter(({ file }) => file).map(({ name, frames }) => [`film:${name}`, `Film ${name}${frames ? ` (${frames})` : ""}`]),
    ];
  }

  #nothing() {
    place(
      this.root,
      h("header.head", null, h("h1", null, "Contacts")),
      empty(
        "No contact images yet",
        "Drop pictures of the contact, or the frames of a film, on the Study page and say finger, angle and load.",
        h("a.button.primary", { href: "#/study" }, "To the study"),
      ),
    );
  }

  #build() {
    this.stage = new Stage("Contact image. Arrow keys move the cross-hair of a brush, space presses it.");
    this.overlay = new ContactOverlay(this.stage);
    this.mark = h("span.synthetic.stage-synthetic", { hidden: true }, "synthetic");
    this.stage.root.append(this.mark);
    this.editor = new EllipseEditor(this.stage, ["semi-major axis", "semi-minor axis"], (shape, final) => this.#dragged(final));
    this.box = new Box(this.stage, (box) => this.#keep((change) => ({ ...change, region_of_interest_px: box })));
    this.toolbar = segments("Tools", TOOLS, this.tool, (tool) => this.#use(tool), { vertical: true });
    this.strip = new Filmstrip({
      label: "Filmstrip",
      chosen: (index) => this.#choose(index),
      describe: (entry) => describe(entry),
    });
    this.count = h("span.count.number", { role: "status" });
    this.sourceChoice = choose({ value: this.source, label: "Pictures", options: this.#sources(), onset: (key) => (location.hash = `#/contacts/${encodeURIComponent(key)}`) });
    this.filterChoice = choose({ value: this.filter, label: "Show", options: FILTERS, onset: (key) => this.#filter(key) });
    this.inspector = new ContactInspector(this);
    place(
      this.root,
      h(
        "header.head",
        null,
        h("div", null, h("h1", null, "Contacts"), h("p", null, "Check each region and its ellipse. Enter accepts and goes on.")),
        h("div.actions", null, whoButton()),
      ),
      h(
        "div.bench",
        null,
        this.toolbar,
        this.stage.root,
        h("aside.inspector", { "aria-label": "The contact that is open", tabindex: 0 }, this.inspector.root, this.inspector.footer),
        h(
          "section.film",
          { "aria-label": "Pictures" },
          h("div.film-bar", null, h("label", null, "Pictures", this.sourceChoice), h("label", null, "Show", this.filterChoice), this.count),
          this.strip.root,
        ),
      ),
    );
    this.live = new Newest((change) => this.#measure(change), (answer) => this.#show(answer, { live: true }), (error) => this.stage.say(error.message, "bad"));
    this.#keys();
    this.load();
  }

  #keys() {
    bindHere([
      ["Enter", "Accept and go to the next", () => this.accept()],
      ["ArrowRight .", "Next picture", () => this.#step(1)],
      ["ArrowLeft ,", "Picture before", () => this.#step(-1)],
      ["n", "Next flagged picture", () => this.#nextFlagged()],
      ["x", "Reject, or take back", () => this.reject()],
      ["u Ctrl+z", "Undo", () => this.undo()],
      ["r Ctrl+y Ctrl+Z", "Redo", () => this.redo()],
      ["v", "Look and drag the ellipse", () => this.#use("ellipse")],
      ["b", "Brush: add (Alt: take away)", () => this.#use("add")],
      ["e", "Brush: take away", () => this.#use("remove")],
      ["s", "Seed point", () => this.#use("seed")],
      ["o", "Region of interest", () => this.#use("box")],
      ["[ ]", "Smaller or larger brush", (event) => this.#resize(event.key === "]" ? 1.25 : 0.8)],
      ["p", "Hold: the program's own result", () => this.#showOwn(true)],
      ["+ - 0", "Zoom in, zoom out, fit the picture", null],
      ["Tab", "To the handles; arrow keys move one, Shift ×10, Alt ×⅕", null],
      ["Space", "Press or lift the brush at the cross-hair", null],
    ]);
    this.keyup = (event) => event.key === "p" && this.#showOwn(false);
    document.addEventListener("keyup", this.keyup);
  }

  async load() {
    this.count.textContent = "loading …";
    if (this.source === "images") {
      this.all = bench.study.observations.filter(({ file }) => file).map((entry) => ({ ...entry, flags: doubts(entry) }));
    } else {
      const name = this.source.slice(5);
      this.film = bench.study.sequences.find((entry) => entry.name === name);
      this.all = [];
      for (let total = 1; this.all.length < total; ) {
        const page = await get("/api/study/frames", { sequence: name, offset: this.all.length, limit: 2000 });
        total = page.total;
        this.all.push(...page.frames.map((entry) => ({ ...entry, flags: doubts(entry) })));
        if (!page.frames.length) break;
      }
    }
    this.#filter(this.filter, this.wanted);
  }

  #filter(key, wanted) {
    const item = wanted ?? this.entries[this.at]?.item;
    this.filter = key;
    this.entries = this.all.filter(WANTED[key]);
    this.strip.set(this.entries);
    if (!this.entries.length) {
      this.count.textContent = `none of ${this.all.length}`;
      this.stage.say(this.all.length ? "No picture is left under this filter." : "This film has no frames.");
      return;
    }
    this.at = -1;
    const found = this.entries.findIndex((entry) => entry.item === item);
    this.#choose(found < 0 ? Math.max(0, this.#firstInContact()) : found);
  }

  #firstInContact() {
    return this.source === "images" ? 0 : this.entries.findIndex(({ status }) => status !== "none");
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
    this.#counted();
    history.replaceState(null, "", `#/contacts/${encodeURIComponent(this.source)}/${encodeURIComponent(item)}`);
    this.corrections?.close();
    this.measured = null;
    this.#blank();
    this.corrections = new Corrections(item, () => this.#corrected());
    const mine = this.corrections;
    this.inspector.wait();
    try {
      const [info] = await Promise.all([get("/api/picture/info", { item }), mine.load()]);
      if (this.corrections !== mine) return;
      this.info = info;
      this.inspector.head();
      this.stage.show(info.preview ?? picture("preview", item), info.rows_px, info.columns_px, `Contact image ${item}`);
      this.mark.hidden = !(this.entry.synthetic ?? this.film?.synthetic);
      this.#ahead();
      await this.remeasure();
    } catch (error) {
      if (this.corrections === mine) this.stage.say(error.message, "bad");
    }
  }

  /** Have the next picture at hand before it is asked for. */
  #ahead() {
    const next = this.entries[this.at + 1];
    if (!next) return;
    clearTimeout(this.soon);
    this.soon = setTimeout(() => get("/api/picture/info", { item: next.item }).then((info) => (new Image().src = info.preview)).catch(() => {}), 300);
  }

  #blank() {
    this.overlay.clear();
    this.editor.hide();
    this.box.set(null);
  }

  #counted() {
    this.count.textContent = `${this.at + 1} of ${this.entries.length}${this.filter ? ` shown, ${this.all.length} in all` : ""}`;
  }

  #measure(change) {
    this.asked = this.entry.item;
    return post("/api/measure/contact", { item: this.entry.item, change });
  }

  /** Ask for the picture's result under the correction that rules. */
  async remeasure() {
    const mine = this.corrections;
    try {
      const answer = await post("/api/measure/contact", { item: mine.item });
      if (this.corrections === mine) this.#show(answer);
    } catch (error) {
      if (this.corrections !== mine) return;
      this.measured = null;
      this.#blank();
      this.stage.say(error.message, "bad");
      this.inspector.show(null, error.message);
    }
  }

  #show(answer, { live = false } = {}) {
    if (answer.item !== this.entry.item) return;
    this.measured = answer;
    if (!live) this.stage.say("");
    this.stage.setScale(answer.mm_per_px);
    this.overlay.region(answer.outline_px);
    if (!live) {
      const { centre_px: centre, major_ends_px: major, minor_ends_px: minor } = answer.handles;
      this.editor.show(centre, major[0], minor[0]);
      this.#showTool();
      this.brush?.dry();
    }
    this.inspector.show(answer);
  }

  #corrected() {
    const { change, history: records } = this.corrections.document;
    const entry = this.entries.find(({ item }) => item === this.corrections.item);
    if (entry) {
      entry.accepted = Boolean(change.accepted);
      entry.rejected = change.rejected ?? null;
      entry.corrected = Object.keys(change).some((key) => !["accepted", "rejected"].includes(key) && change[key] !== null);
      this.strip.refresh();
    }
    this.stage.root.classList.toggle("rejected", Boolean(change.rejected));
    this.overlay.correction(change);
    this.box.set(change.region_of_interest_px ?? null);
    this.#showTool();
    if (records) this.inspector.corrected();
  }

  #use(tool) {
    this.tool = tool;
    this.toolbar.show(tool);
    this.brush = null;
    if (tool === "add" || tool === "remove") {
      this.brush = new Brush(this.stage, { action: tool, radius: this.radius, done: (stroke) => this.#stroke(stroke) });
      this.stage.use(this.brush);
    } else if (tool === "seed") this.stage.use(new Click((at) => this.#keep((change) => ({ ...change, seed_px: at }))));
    else if (tool === "box") this.stage.use(this.box);
    else this.stage.use(null);
    this.#showTool();
    this.inspector.tool();
    this.stage.root.focus({ preventScroll: true });
  }

  #showTool() {
    const editing = this.tool === "ellipse" && this.measured && !this.corrections?.change.rejected;
    this.editor.layer.classList.toggle("quiet", !editing);
    for (const { node } of Object.values(this.editor.handles)) node.style.display = editing ? "" : "none";
    this.editor.stalk.style.display = editing ? "" : "none";
    this.box.layer.style.display = this.tool === "box" || this.box.box ? "" : "none";
    for (const { node } of this.box.handles) node.style.display = this.tool === "box" ? "" : "none";
  }

  #resize(factor) {
    this.setRadius(Math.round(Math.min(200, Math.max(1, this.radius * factor + (factor > 1 ? 0.5 : -0.5)))));
  }

  setRadius(radius) {
    this.radius = radius;
    this.brush?.setRadius(radius);
    this.inspector.tool();
  }

  #stroke(stroke) {
    this.#keep((change) => ({ ...change, ellipse_px: null, strokes: [...(change.strokes ?? []), stroke] }));
  }

  #ellipse() {
    const { centre, lengths } = this.editor.shape;
    const turned = lengths[1] > lengths[0];
    return {
      centre: [...centre],
      semi_axes: turned ? [lengths[1], lengths[0]] : [...lengths],
      orientation_deg: this.editor.fromUp + (turned ? 90 : 0),
    };
  }

  #dragged(final) {
    const change = { ...this.corrections.change, ellipse_px: this.#ellipse(), rejected: null, accepted: false };
    this.live.ask(plainChange(change));
    if (final) this.#keep((now) => ({ ...now, ellipse_px: change.ellipse_px }), { measure: false });
  }

  set(key, value) {
    return this.#keep((change) => ({ ...change, [key]: value }));
  }

  /** Keep a change of what is measured: it takes back an earlier accept or reject. */
  async #keep(edit, { measure = true } = {}) {
    const mine = this.corrections;
    try {
      await mine.keep((change) => plainChange({ ...edit(change), accepted: false, rejected: null }));
      if (measure && this.corrections === mine) await this.remeasure();
    } catch (error) {
      if (this.corrections === mine) await this.remeasure();
      complain(error);
    }
  }

  async accept() {
    const mine = this.corrections;
    if (!this.measured) return say("There is no contact to accept here. Reject the picture, or set the threshold, polarity or seed point.", { kind: "error" });
    if (!mine.change.accepted) await mine.keep((change) => plainChange({ ...change, accepted: true, rejected: null })).catch(complain);
    return this.#step(1, { done: true });
  }

  async reject() {
    const rejected = this.corrections.change.rejected;
    await this.corrections.keep((change) => plainChange({ ...change, accepted: false, rejected: rejected ? null : this.inspector.reason() })).catch(complain);
    if (!rejected) this.#step(1);
  }

  async undo() {
    const mine = this.corrections;
    if (!mine.document.can_undo) return;
    await mine.undo().catch(complain);
    if (this.corrections === mine) await this.remeasure();
  }

  async redo() {
    const mine = this.corrections;
    if (!mine.document.can_redo) return;
    await mine.redo().catch(complain);
    if (this.corrections === mine) await this.remeasure();
  }

  async revert() {
    const mine = this.corrections;
    await mine.keep(() => ({})).catch(complain);
    if (this.corrections === mine) await this.remeasure();
  }

  #step(by, { done = false } = {}) {
    const to = this.at + by;
    if (this.entries[to]) this.#choose(to);
    else if (done) say("That was the last picture. Run the study to see what follows.", { kind: "good", action: { words: "Run", do: () => (location.hash = "#/run") } });
  }

  #nextFlagged() {
    const from = this.at + 1;
    const order = [...this.entries.slice(from), ...this.entries.slice(0, from)];
    const next = order.find((entry) => entry.flags?.length && !entry.accepted && !entry.rejected);
    if (next) this.#choose(this.entries.indexOf(next));
    else say("No flagged picture is left to look at.", { kind: "good" });
  }

  #showOwn(show) {
    const own = this.measured?.program;
    this.overlay.own(show && own ? own.outline_px : null);
    this.stage.root.classList.toggle("comparing", show);
    if (show && !own) this.stage.say(this.measured?.program_error ?? "The program found no contact here.");
    else if (!show) this.stage.say("");
  }

  showOwn(show) {
    this.#showOwn(show);
  }

  context() {
    const entry = this.entry;
    const of = this.film ?? entry;
    return {
      entry,
      lines: [
        of.finger ?? "which finger?",
        `θ ${plain(of.wedge_angle_deg)}°`,
        ...(of.roll_angle_deg ? [`φ ${plain(of.roll_angle_deg)}°`] : []),
        ...(entry.load_N === null || entry.load_N === undefined ? [] : [`${plain(entry.load_N)} N`]),
        ...(entry.time_s === undefined || entry.time_s === null ? [] : [`${plain(entry.time_s)} s${entry.phase ? `, ${entry.phase}` : ""}`]),
        `scale ${scaleWords(of.scale)}`,
        ...(this.info?.bits > 8 ? [`${this.info.bits} bit, shown in 8`] : []),
      ],
    };
  }

  turn(rest) {
    if (rest[0] === this.source || !rest[0]) return;
    this.close();
    place(this.root);
    Object.assign(this, new Contacts(this.root, rest));
  }

  update() {
    if (!this.stage || this.source !== "images") return;
    const now = new Map(bench.study.observations.map((entry) => [entry.item, entry]));
    for (const entry of this.all ?? []) Object.assign(entry, now.get(entry.item) ?? {});
    this.strip.refresh();
  }

  close() {
    document.removeEventListener("keyup", this.keyup);
    clearTimeout(this.soon);
    this.corrections?.close();
    this.live?.drop();
    this.stage?.close();
    this.strip?.close();
  }
}

export const open = (root, rest) => new Contacts(root, rest);
