// Tables of fingers, contacts, sequences and loading data, edited in place.

import { contactAddress } from "../core/api.js";
import { button, h, render, reset, small, update } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { ask } from "../core/messages.js";
import { countedFrames } from "../core/quantity.js";
import { describeCode, workspace } from "../core/workspace.js";
import { attempt, chip, choose, field, number, numberIn, synthetic } from "../parts/forms.js";
import { scaleChoice } from "../parts/scale_ways.js";
import { cell, paged, row, statusChip, tableCard } from "../parts/tables.js";
import { FingerTable, quantity } from "./study_fingers.js";

/** Contacts on a page. */
const PAGE = 50;
// So few are found at a glance.
const FEW = 15;

export class StudyTables {
  /** The page of contacts that is shown, and what of them is looked for. */
  page = 0;
  wanted = "";

  constructor() {
    this.problem = h("div");
    this.root = h("div.stack");
    this.fingers = new FingerTable(this);
  }

  draw() {
    const { fingers, observations, sequences, curves } = workspace.study;
    update(this.root, [
      this.problem,
      this.fingers.draw(fingers),
      this.#contacts(observations),
      sequences.length > 0 && this.#sequences(sequences),
      this.#curves(curves),
    ]);
  }

  async change(kind, key, set) {
    if (await attempt(this.problem, () => workspace.edit({ kind, key, set }))) return;
    const refusal = [...this.problem.childNodes];
    reset(this.root);
    this.draw();
    render(this.problem, refusal);
    this.problem.scrollIntoView({ block: "nearest" });
  }

  /**
   * Cells that change keys of an entry, each named by its words and those of the entry.
   *
   * @param {Edit["kind"]} kind
   * @param {string} key
   * @param {any} one
   */
  #cells(kind, key, one, named = key) {
    const set = (name) => (value) => this.change(kind, key, { [name]: value });
    const of = (name, control, needed = true) =>
      h("td", { "data-empty": needed && (one[name] ?? null) === null }, control);
    return {
      set,
      /**
       * @type {(
       *   name: string, words: string, more?: Parameters<typeof number>[0], needed?: boolean
       * ) => any}
       */
      number: (name, words, more, needed = true) => {
        const label = `${words} of ${named}`;
        return of(name, number({ value: one[name], min: 0, label, onset: set(name), ...more }), needed);
      },
      finger: () => {
        const names = workspace.study.fingers.map(({ name }) => name);
        const options = one.finger ? names : [["", "– select –"], ...names];
        const label = `Finger of ${named}`;
        return of("finger", choose({ value: one.finger ?? "", options, label, onset: set("finger") }), false);
      },
      scale: () => {
        const { scale: value, scale_words: words } = one;
        return of("scale", scaleChoice({ value, words, label: `Scale of ${named}`, onset: set("scale") }));
      },
    };
  }

  /** A button that removes an entry, once that is confirmed. */
  removal(kind, key, words) {
    const remove = async () => {
      const body = h("p", "Its file stays in the study folder.");
      if (await ask(`Remove ${words} from the study?`, body, "Remove", { kind: "bad" }))
        this.change(kind, key, null);
    };
    return button("×", remove, { kind: "icon", label: `Remove ${words}` });
  }

  #turn(page) {
    this.page = page;
    this.draw();
  }

  /** @param {Observation[]} observations */
  #contacts(observations) {
    const many = observations.length > FEW;
    const wanted = many ? this.wanted : "";
    const found = observations.filter((one) =>
      [one.item, one.finger ?? ""].some((words) => words.toLowerCase().includes(wanted)),
    );
    const { shown, pager } = paged(found, this.page, PAGE, (page) => this.#turn(page));
    const oninput = ({ currentTarget }) => {
      this.wanted = currentTarget.value.trim().toLowerCase();
      this.#turn(0);
    };
    const rolled =
      observations.some(({ roll_angle_deg: roll }) => roll) ||
      workspace.study.uncertainty.roll_angle_deg_std > 0;
    const roll = rolled ? ["Roll, °"] : [];
    const { sequences } = workspace.study;
    const none = sequences.length
      ? "No single contacts; those of sequences are below."
      : "No contacts yet. Drop contact images above; each is one contact at one load.";
    const more = sequences.length ? `, and ${countedFrames(sequences)}` : "";
    const find = { type: "search", placeholder: "name or finger", "aria-label": "Find contacts", oninput };
    return tableCard("Contacts", {
      words: wanted ? `${found.length} of ${observations.length}` : `${observations.length} in all${more}`,
      actions: (many || pager) && [many && h("input", find), pager],
      headings: ["Contact", "Finger", "Wedge, °", ...roll, "Load, N", "Scale", "Status", ""],
      rows: shown.map((one) => this.#contact(one, rolled)),
      none: !observations.length && none,
    });
  }

  /** @param {Observation} one @param {boolean} rolled */
  #contact(one, rolled) {
    const cells = this.#cells("observation", one.item, one);
    return row(
      one.item,
      cell(
        one.file ? h("a", { href: contactAddress(one.item) }, one.item) : one.item,
        " ",
        synthetic(one.synthetic),
        one.flags.length > 0 && [" ", chip("flagged", "warn", one.flags.map(describeCode).join("; "))],
      ),
      cells.finger(),
      cells.number("wedge_angle_deg", "Wedge angle", { max: 90 }),
      rolled && cells.number("roll_angle_deg", "Roll angle", { min: undefined }, false),
      cells.number("load_N", "Load"),
      one.file ? cells.scale() : h("td.soft", "ellipse given"),
      cell(statusChip(one)),
      cell(this.removal("observation", one.item, one.item)),
    );
  }

  /** @param {Sequence[]} sequences */
  #sequences(sequences) {
    return tableCard("Sequences", {
      words: "contact images with force",
      headings: ["Sequence", "Finger", "Wedge, °", "Force, frame rate", "Scale", "Status", ""],
      rows: sequences.map((one) => this.#sequence(one)),
    });
  }

  /** @param {Sequence} one */
  #sequence(one) {
    const cells = this.#cells("sequence", one.name, one);
    const files = workspace.study.files.filter(({ kind }) => kind === "table").map(({ file }) => file);
    const force = [...new Set([one.force, ...files].filter(Boolean))];
    const options = [["", "– select table –"], ...force.map((file) => [file, file.split("/").at(-1)])];
    const label = `Force of ${one.name}`;
    const rate = number({
      value: one.frames_per_second,
      min: 0,
      label: `Frames per second of ${one.name}`,
      onset: cells.set("frames_per_second"),
    });
    return row(
      one.name,
      cell(
        h("a", { href: contactAddress(null, one.name) }, one.name),
        " ",
        synthetic(one.synthetic),
        one.frames && h("div.soft.number", `${one.frames} frames`),
      ),
      cells.finger(),
      cells.number("wedge_angle_deg", "Wedge angle", { max: 90 }),
      cell(
        choose({ value: one.force ?? "", options, label, onset: cells.set("force") }),
        h("div.control.below", [rate, h("span.unit", "frames/s")]),
      ),
      cells.scale(),
      cell(statusChip(one)),
      cell(this.removal("sequence", one.name, one.name)),
    );
  }

  /** @param {State["curves"]} curves */
  #curves(curves) {
    const words = h("span", ["Add ", symbol("R_g", { inControl: true }), " from elsewhere"]);
    const disabled = !workspace.study.fingers.length;
    return tableCard("Loading data", {
      words: ["force–displacement curves, or ", symbol("R_g"), " from elsewhere"],
      actions: small(words, () => this.#addRadius(), { disabled }),
      headings: ["Source", "Finger", "Wedge, °", { words: [symbol("R_g"), ", mm"] }, "Status", ""],
      rows: curves.map((one) => this.#curve(one)),
      none: [
        "None. The study runs without them; ",
        symbol("R_g"),
        " is then not compared with the corrected radius.",
      ],
    });
  }

  /** @param {State["curves"][number]} one */
  #curve(one) {
    const name = `curve ${one.key}`;
    const cells = this.#cells("curve", one.key, one, name);
    return row(
      `${one.file ?? one.loading_radius_mm.words} ${one.finger}`,
      cell(one.file ?? "from elsewhere", " ", synthetic(one.synthetic)),
      cell(one.finger ?? "–"),
      cells.number("wedge_angle_deg", "Wedge angle", { max: 90 }),
      h("td.number", one.file ? "from the curve" : one.loading_radius_mm.words),
      cell(statusChip(one)),
      cell(this.removal("curve", one.key, one.file ?? `the radius of ${one.finger}`)),
    );
  }

  /** Ask for a radius of loading data that are not here. */
  async #addRadius() {
    const names = workspace.study.fingers.map(({ name }) => name);
    const finger = choose({ value: names[0], options: names });
    const wedge = number({ min: 0, max: 90 });
    const radius = quantity("R_g", null, null, { min: 0 });
    const fields = h("div.fields", [
      field("Finger", finger),
      field("Wedge angle", wedge, { unit: "°" }),
      radius.fields,
    ]);
    if (!(await ask("R_g from loading data", fields, "Add")) || numberIn(radius.value) === null) return;
    const entered = Object.entries({
      finger: finger.value,
      loading_radius_mm: numberIn(radius.value),
      wedge_angle_deg: numberIn(wedge),
      loading_radius_mm_std: numberIn(radius.its),
    }).filter(([, value]) => value !== null);
    this.change("curve", String(workspace.study.curves.length), Object.fromEntries(entered));
  }
}
