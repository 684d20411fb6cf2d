// Review of contact images and frames.

import { get, LatestRequest, post } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { goTo, showError, toast } from "../core/messages.js";
import { counted, short } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { SequenceTraces } from "../editor/sequence_traces.js";
import { figureButton } from "../parts/figure_settings.js";
import { choose } from "../parts/forms.js";
import { missingOf } from "../parts/missing_fields.js";
import { whichScale } from "../parts/scale_ways.js";
import { ContactInspector } from "./contact_inspector.js";
import { ContactReview } from "./contact_review.js";
import { describeContact, FILTERS, renderNone } from "./review_layout.js";

/** @type {Tool[]} */
const TOOLS = [
  ["ellipse", "Drag the ellipse", "v"],
  ["add", "Brush: add to the region", "b", "Brush: add (Alt: remove)"],
  ["remove", "Brush: remove from the region", "e"],
  ["lasso", "Lasso: draw around an area", "l", "Lasso (Alt: remove)"],
  ["polygon", "Polygon: corners of an area", "g", "Polygon: Space sets a corner, Enter closes it"],
  ["threshold", "Threshold on the histogram", "t", "Threshold: arrow keys move it"],
  ["seed", "Seed point inside the contact", "s"],
  ["box", "Region of interest", "o"],
];

const NONE =
  "Drop contact images or frames of a sequence on the Study page, and enter finger, angle and load.";

const isKnown = (value) => value !== null && value !== undefined;

export class Contacts extends ContactReview {
  /** @type {((Observation | Frame) & { finger?: string | null })[]} */
  all = [];
  /** @type {((Observation | Frame) & { finger?: string | null })[]} */
  entries = [];
  /** @type {Sequence | undefined} */
  sequence;

  last = [
    "This was the last image. Run the study to see the results.",
    { kind: "good", action: goTo("Run", "run") },
  ];

  constructor(root, rest) {
    super();
    this.root = root;
    this.filter = "all";
    this.finger = "";
    this.source = this.#sources().some(([key]) => key === rest[0]) ? rest[0] : this.#sources()[0]?.[0];
    this.wanted = rest[1];
    if (this.source === "second") {
      this.operator = /** @type {const} */ ("second");
      this.tool = "lasso";
      this.nothingToAccept = "Outline the contact first: lasso, polygon or threshold.";
    }
    const typed = workspace.study.observations.length;
    const none = typed
      ? `${counted(typed, "contact")} typed as ellipses, no images`
      : "No contact images yet";
    if (!this.source) renderNone(root, "Contacts", none, NONE);
    else this.#build();
  }

  #sources() {
    const count = this.#images().length;
    const images = [
      ["images", `Contact images (${count})`],
      ["second", "Second operator, blind"],
    ];
    return [
      ...(count ? images : []),
      ...workspace.study.sequences
        .filter(({ file }) => file)
        .map(({ name, frames }) => [`sequence:${name}`, `Sequence ${name}${frames ? ` (${frames})` : ""}`]),
    ];
  }

  #images() {
    return workspace.study.observations.filter(({ file }) => file);
  }

  #build() {
    this.count = h("span.count.number", { role: "status" });
    const sourceChoice = choose({
      value: this.source,
      label: "Images",
      options: this.#sources(),
      onset: (key) => (location.hash = `#/contacts/${encodeURIComponent(key)}`),
    });
    const onset = (key) => this.#filter(key);
    this.filterChoice = choose({ value: this.filter, label: "Show", options: Object.keys(FILTERS), onset });
    this.fingers = h("label", { hidden: true });
    this.scrubbed = new LatestRequest(
      (frame) => this.#show(frame),
      () => {},
      showError,
    );
    this.traces = new SequenceTraces({
      chosen: (frame) => this.#show(frame),
      scrubbed: (frame) => this.scrubbed.request(frame),
      aligned: (start) => this.#align(start),
    });
    this.layOut({
      title: "Contacts",
      words: "Check each region and its ellipse. Enter accepts and goes to the next image.",
      label: "Contact image. Arrow keys move the cross-hair of a brush, space presses it.",
      axes: ["semi-major axis", "semi-minor axis"],
      tools: TOOLS,
      radius: 14,
      measureDragged: (change) => post("/measure/contact", { item: this.entry.item, change }),
      describe: (entry) => describeContact(entry, { named: !this.fingers.hidden }),
      inspector: new ContactInspector(this),
      keys: [
        ["k", "Key frame of a sequence", () => this.setKeyFrame(!this.corrections?.change.key_frame)],
        ["n", "Next flagged image", () => this.#nextFlagged()],
        ["p", "Hold: show the automatic outline", () => this.showAutomatic(true)],
      ],
      bar: [
        this.traces.root,
        h("div.filmstrip-bar", [
          h("label", ["Images", sourceChoice]),
          h("label", ["Show", this.filterChoice]),
          this.fingers,
          this.count,
        ]),
      ],
    });
    this.keyup = (event) => event.key === "p" && this.showAutomatic(false);
    document.addEventListener("keyup", this.keyup);
    if (this.blind) this.use(this.tool);
    this.load();
  }

  async load() {
    this.count.textContent = "loading …";
    if (this.source === "images") {
      this.all = this.#images().map((entry) => ({ ...entry }));
    } else if (this.blind) {
      this.agreement = await get("/second-operator");
      if (this.closed) return;
      const known = new Map(workspace.study.observations.map((entry) => [entry.item, entry]));
      this.all = this.agreement.images.map((image) => ({
        ...known.get(image.item),
        flags: [],
        status: "done",
        ...image,
      }));
    } else {
      const name = this.source.slice("sequence:".length);
      this.sequence = workspace.study.sequences.find((entry) => entry.name === name);
      this.all = [];
      for (let total = 1; this.all.length < total; ) {
        const page = await get("/frames", { sequence: name, offset: this.all.length, limit: 2000 });
        if (this.closed) return;
        total = page.total;
        this.all.push(...page.frames);
        if (!page.frames.length) break;
      }
    }
    // Without the force the frames are shown alone.
    const signal = this.sequence
      ? await get("/signal", { sequence: this.sequence.name }).catch((error) => (showError(error), null))
      : null;
    this.traces.set(this.sequence?.name ?? null, signal, /** @type {Frame[]} */ (this.all));
    if (this.closed) return;
    this.#drawFingers();
    this.#filter(this.filter, this.wanted);
    await this.#figure();
  }

  /** Show the way to the sequence's figure in the report, if there is one. */
  async #figure() {
    const name = `sequence_${this.sequence?.name}`;
    const there = this.sequence && workspace.study.results.there;
    const figures = there ? await get("/results/figures") : [];
    const figure = figures.find((each) => [name, `${name}_synthetic`].includes(each.name));
    if (name === `sequence_${this.sequence?.name}`) render(this.traces.figure, figureButton(figure));
  }

  /** Show a frame of the traces with its result, whatever the filter is. */
  async #show(frame) {
    const index = this.entries.findIndex(({ item }) => item === frame.item);
    if (index >= 0) return this.choose(index);
    this.filterChoice.value = "all";
    return this.#filter("all", frame.item);
  }

  /** Offer the fingers that contact images are of. */
  #drawFingers() {
    const of = this.sequence ? [] : this.all.map(({ finger }) => finger).filter(Boolean);
    const names = [...new Set(of)].sort();
    this.fingers.hidden = names.length < 2;
    const onset = (name) => {
      this.finger = name;
      this.#filter(this.filter);
    };
    const options = [["", "all"], ...names];
    render(this.fingers, ["Finger", choose({ value: this.finger, label: "Finger", options, onset })]);
  }

  async #align(start) {
    const set = { start_s: Number(start.toFixed(4)), contact_load_N: null };
    try {
      await workspace.edit({ kind: "sequence", key: this.sequence.name, set });
      toast("The alignment is saved. Run the study to use it.", { kind: "good", action: goTo("Run", "run") });
    } catch (error) {
      showError(error);
    }
  }

  #filter(key, wanted) {
    const item = wanted ?? this.entries[this.at]?.item;
    this.filter = key;
    this.entries = this.all.filter(
      (entry) => FILTERS[key](entry) && (!this.finger || entry.finger === this.finger),
    );
    this.strip.set(this.entries);
    if (!this.entries.length) {
      this.nothing();
      this.count.textContent = `none of ${this.all.length}`;
      const none = this.blind
        ? "The first operator has not accepted or corrected any image yet."
        : "This sequence has no frames.";
      this.stage.setMessage(this.all.length ? "No image matches this filter." : none);
      return undefined;
    }
    this.at = -1;
    const found = this.entries.findIndex((entry) => entry.item === item);
    return this.choose(found < 0 ? Math.max(0, this.#firstInContact()) : found);
  }

  #firstInContact() {
    return this.source === "images" || this.blind
      ? 0
      : this.entries.findIndex(({ status }) => status !== "none");
  }

  address(item) {
    return `#/contacts/${encodeURIComponent(this.source)}/${encodeURIComponent(item)}`;
  }

  missing() {
    const { sequence } = this;
    return sequence ? missingOf("sequence", sequence.name) : missingOf("observation", this.entry.item);
  }

  title() {
    return `Contact image ${this.entry.item}`;
  }

  clearOverlay() {
    this.overlay.clear();
    const all = this.filter !== "all" || this.finger ? ` shown, ${this.all.length} in all` : "";
    this.count.textContent = `${this.at + 1} of ${this.entries.length}${all}`;
  }

  showInfo(info) {
    this.info = info;
    this.inspector.head();
    if (this.sequence) this.traces.choose(/** @type {Frame} */ (this.entry));
    this.mark.hidden = !(this.entry.synthetic ?? this.sequence?.synthetic);
    this.#ahead();
  }

  /** Preload the next image. */
  #ahead() {
    const next = this.entries[this.at + 1];
    if (!next) return;
    clearTimeout(this.soon);
    this.soon = setTimeout(
      () =>
        get("/picture/info", { item: next.item })
          .then((info) => (new Image().src = info.preview))
          .catch(() => {}),
      300,
    );
  }

  /** Carry the ellipse of this frame to those up to the next key frame, or no longer. */
  async setKeyFrame(on) {
    if (!this.sequence || !this.measured) return;
    await this.keep((change) => ({
      ...change,
      ellipse_px: on ? (change.ellipse_px ?? this.ellipse()) : change.ellipse_px,
      key_frame: on,
    }));
    await this.#refreshFrames();
    if (on && !this.all.some((frame) => "interpolated" in frame && frame.interpolated))
      toast("No other frame follows it: set a second key frame, and the frames between the two will.");
  }

  /** Read again which frames around this one are interpolated. */
  async #refreshFrames() {
    const offset = Math.max(0, this.entry.frame - 1000);
    const { frames } = await get("/frames", { sequence: this.sequence.name, offset, limit: 2000 });
    frames.forEach((frame, k) => {
      Object.assign(this.all[offset + k] ?? {}, frame);
    });
    this.strip.refresh();
  }

  #nextFlagged() {
    const from = this.at + 1;
    const order = [...this.entries.slice(from), ...this.entries.slice(0, from)];
    const next = order.find((entry) => entry.flags?.length && !entry.accepted && !entry.rejected);
    if (next) this.choose(this.entries.indexOf(next));
    else toast("No flagged images left to review.", { kind: "good" });
  }

  context() {
    const entry = this.entry;
    const of = this.sequence ?? entry;
    return {
      entry,
      lines: [
        of.finger ?? "no finger",
        of.wedge_angle_deg !== null && `θ ${of.wedge_angle_deg}°`,
        of.roll_angle_deg && `φ ${of.roll_angle_deg}°`,
        isKnown(entry.load_N) && `${short(entry.load_N)} N`,
        isKnown(entry.time_s) && `${short(entry.time_s)} s${entry.phase ? `, ${entry.phase}` : ""}`,
        whichScale(of),
        this.info?.bits > 8 && `${this.info.bits} bit, shown in 8`,
      ].filter(Boolean),
    };
  }

  navigate([source, item]) {
    if (source && source !== this.source) return false;
    this.choose(this.entries.findIndex((entry) => entry.item === item));
    return true;
  }

  update() {
    if (!this.stage || this.blind) return;
    const { sequences, observations } = workspace.study;
    this.sequence &&= sequences.find(({ name }) => name === this.sequence.name) ?? this.sequence;
    this.renew(this.all, observations);
    if (this.entry) this.inspector.head();
    this.refreshMissing();
  }

  close() {
    document.removeEventListener("keyup", this.keyup);
    clearTimeout(this.soon);
    this.traces?.close();
    super.close();
  }
}
