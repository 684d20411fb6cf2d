// The study: its contents, missing entries, and settings.

import { h, render, small, update } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { counted, countedFrames } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { Drop } from "../parts/drop.js";
import { attempt, choiceField, field, number, numberField, textField } from "../parts/forms.js";
import { axesNotes, doubtNotes, missingList, SURFACES } from "../parts/missing_fields.js";
import { NewFiles } from "./new_files.js";
import { StudyTables } from "./study_tables.js";

export class StudyView {
  constructor(root) {
    this.files = new NewFiles({ changed: () => this.update(), showMissing: () => this.#showMissing() });
    this.tables = new StudyTables();
    this.drop = new Drop({
      sent: (files) => {
        this.files.addInfo(files);
        this.files.draw();
        this.files.root.scrollIntoView({ block: "nearest" });
        this.files.root.querySelector("input")?.focus();
      },
    });
    this.side = h("aside.stack.study-side", { "aria-label": "Missing entries and settings of the study" });
    this.problems = Object.fromEntries(
      ["study", "uncertainty", "apparatus"].map((key) => [key, h("div", { key })]),
    );
    this.heading = h("div");
    this.ready = h("div.actions");
    render(root, [
      h("header.head", [this.heading, this.ready]),
      h("div.scroll.study-grid", [
        h("div.stack.across", [this.drop.root, this.files.root]),
        h("div.stack", [this.tables.root, this.files.rest]),
        this.side,
      ]),
    ]);
    this.close = this.drop.watch();
    bindHere([
      ["a", "Add files", () => this.drop.chooser.click()],
      ["g", "Go to missing entries", () => this.#showMissing()],
    ]);
    this.update();
  }

  #showMissing() {
    const first = this.side.querySelector("a, button, input, select");
    first?.scrollIntoView({ block: "center" });
    first?.focus();
  }

  update() {
    const { study } = workspace;
    const all = study.observations.length + study.sequences.length;
    this.drop.root.classList.toggle("slim", study.fingers.length + all > 0);
    const parts = [
      counted(study.fingers.length, "finger"),
      (study.observations.length || !study.sequences.length) && counted(study.observations.length, "contact"),
      study.sequences.length && countedFrames(study.sequences),
      study.curves.length && counted(study.curves.length, "loading data set"),
    ];
    update(this.heading, [h("h1", study.title || study.name), h("p", parts.filter(Boolean).join(", "))]);
    update(this.ready, [
      study.ready
        ? h("a.button.primary", { href: "#/run/start" }, "Run the study")
        : [
            h("span.soft", "Not ready to run"),
            study.missing.length > 0 &&
              study.fingers.length + all > 0 &&
              small("Show what is missing", () => this.#showMissing()),
          ],
    ]);
    this.files.draw();
    this.tables.draw();
    update(this.side, [this.#missing(), this.#uncertainty(), this.#settings(), this.#apparatus()]);
  }

  #missing() {
    const { missing, ready, observations, sequences } = workspace.study;
    const notes = [...doubtNotes(), ...axesNotes()];
    if (ready && !missing.length) {
      if (notes.length) return h("section.card", { "aria-label": "To check" }, h("div.stack", notes));
      const [kind, said, more] =
        observations.length + sequences.length
          ? ["good", "Nothing is missing.", " The study can run."]
          : ["", "No contacts yet.", " Drop contact images or a sequence, and enter finger, angle and load."];
      return h("section.card", h("div", { class: `note ${kind}` }, [h("strong", said), more]));
    }
    return h("section.card", { "aria-label": "Missing" }, [
      h("header", [h("h2", "Missing"), h("span.soft", missing.length)]),
      missing.length
        ? h("div.missing-box", { tabindex: 0, role: "group", "aria-label": "Missing entries" }, [
            missingList(missing.slice(0, 40), {
              named: true,
              axes: (name) => this.tables.fingers.askSemiAxes(name),
            }),
            missing.length > 40 && h("p.soft", `and ${missing.length - 40} more`),
          ])
        : h("p.soft", "Start by dropping files: photographs of the finger and contact images."),
      ready && h("p.soft", "The study can run without them."),
      notes,
    ]);
  }

  #change(kind, set) {
    return attempt(this.problems[kind], () => workspace.edit({ kind, key: "", set }));
  }

  #uncertainty() {
    const { uncertainty: now, stated } = workspace.study;
    const of = (key, max) =>
      number({
        value: stated.includes(key) ? now[key] : null,
        min: 0,
        max,
        placeholder: `${now[key]} assumed`,
        onset: (value) => this.#change("uncertainty", { [key]: value }),
      });
    return h("section.card", { "aria-label": "Common uncertainties" }, [
      h("header", h("h2", "Common uncertainties")),
      h("p.soft", "Standard uncertainties. A value of 0 makes the uncertainties of the results too small."),
      h("div.fields.two", [
        field("Wedge angle ±", of("wedge_angle_deg_std"), { unit: "°" }),
        field("Roll angle ±", of("roll_angle_deg_std"), { unit: "°" }),
        field("Load, relative ±", of("load_relative_std", 1), { hint: "0.01 is 1 %" }),
        field("Poisson's ratio ±", of("poisson_ratio_std", 0.5)),
        choiceField("Propagation of uncertainty", {
          value: now.method ?? "first_order",
          options: METHODS,
          onset: (value) => this.#change("uncertainty", { method: value }),
          wide: true,
        }),
      ]),
      this.problems.uncertainty,
    ]);
  }

  /** What the methods section of the report says of the experiment. */
  #apparatus() {
    const now = workspace.study.apparatus;
    const onset = (key) => (value) => this.#change("apparatus", { [key]: value || null });
    return h("section.card", { "aria-label": "Apparatus" }, [
      h("details", [
        h("summary", [h("strong", "Apparatus"), " – for the methods section of the report"]),
        h("div.fields.two", [
          APPARATUS.map(([key, words, placeholder]) =>
            textField(words, { value: now[key], placeholder, onset: onset(key), wide: true }),
          ),
          NUMBERS.map(([key, words, unit]) =>
            numberField(words, { value: now[key], min: 0, onset: onset(key), unit }),
          ),
        ]),
        this.problems.apparatus,
      ]),
    ]);
  }

  #settings() {
    const { study } = workspace;
    return h("section.card", { "aria-label": "Study settings" }, [
      h("header", h("h2", "Settings")),
      h("div.fields.two", [
        textField("Title", {
          value: study.title,
          onset: (title) => title && this.#change("study", { title }),
          wide: true,
        }),
        numberField("Poisson's ratio", {
          value: study.poisson_ratio,
          placeholder: "0.5",
          min: 0,
          max: 0.5,
          onset: (value) => value !== null && this.#change("study", { poisson_ratio: value }),
        }),
        choiceField("Contact surface", {
          value: study.surface,
          options: SURFACES,
          onset: (surface) => this.#change("study", { surface }),
        }),
      ]),
      study.description && h("details", [h("summary", "Description"), h("p.soft", study.description)]),
      this.problems.study,
      h("p.soft.folder", ["Folder: ", h("code", study.name)]),
    ]);
  }
}

const METHODS = [
  ["first_order", "linear (first order)"],
  ["monte_carlo", "Monte Carlo"],
];

/** Keys of the apparatus that are words: key, label, example. */
const APPARATUS = [
  ["imaging", "Contact images", "a glass prism and a monochrome camera"],
  ["scale_calibration", "Calibration of the scale", "a dot grid in the plane of contact"],
  ["platen", "Platen", "smooth glass"],
  ["force_sensor", "Force sensor", "a six-axis force sensor"],
  ["stage", "Stage", "a motorised linear stage"],
  ["poisson_ratio_basis", "Basis of Poisson's ratio", "as usual for soft tissue"],
  ["thickness_basis", "Basis of the thickness", "from a loading curve with areas"],
];

/** And numbers: key, label, unit. */
const NUMBERS = [
  ["approach_mm_per_s", "Velocity of approach", "mm/s"],
  ["dwell_s", "Dwell before the image", "s"],
];
