// The panel beside an image: results, accept and reject, and the history of corrections.

import { describeChange, NO_REASON, WORDS } from "../core/corrections.js";
import { button, h, render, small, update } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { ago } from "../core/quantity.js";
import { adviseCode, workspace } from "../core/workspace.js";
import { alarm, chip, list, slider, text } from "../parts/forms.js";
import { missingList } from "../parts/missing_fields.js";

/** The flags of a measurement in words. @param {string[]} flags */
export const flagNote = (flags, kinds) =>
  flags.length > 0 && h("div.note", list(flags.map((code) => adviseCode(code, kinds))));

export class Inspector {
  /** @type {Record<string, { words?: any, brush?: string, hint?: string }>} */
  tools = {};

  constructor(view, parts, reasons) {
    this.view = view;
    const section = (name) => [name, h("section", { "data-part": name })];
    const names = ["head", "missing", "tool", ...parts, "settings", "history"];
    this.parts = Object.fromEntries(names.map(section));
    this.parts.tool.hidden = true;
    this.parts.look = h("section", { "data-part": "look" }, this.#look());
    this.why = text({ value: "", placeholder: "reason", list: "reasons" });
    this.why.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || !this.why.value.trim()) return;
      this.view.stage.root.focus({ preventScroll: true });
      this.view.reject({ again: true });
    });
    this.root = h("div.stack", { "aria-busy": "true" }, [
      Object.values(this.parts),
      h("datalist", { id: "reasons" }, [reasons.map((value) => h("option", { value }))]),
    ]);
    this.footer = h("div.footer", this.#reviewButtons());
  }

  /** Brightness and contrast of the picture on the screen. */
  #look() {
    const look = [100, 100];
    const set = (place, value) => {
      look[place] = value;
      sliders[place].show(value);
      this.view.stage.setLook(...look);
    };
    const sliders = ["Brightness", "Contrast"].map((words, place) =>
      slider(words, { value: 100, min: 20, max: 400, unit: "%", onset: (value) => set(place, value) }),
    );
    const reset = small("Reset", () => look.forEach((_, place) => void set(place, 100)));
    return h("details", [
      h("summary", "Brightness and contrast, for looking only"),
      h("div.stack-small", [sliders, reset]),
    ]);
  }

  #reviewButtons() {
    this.buttons = {
      accept: button("Accept and next", () => this.view.accept(), { kind: "primary", key: "Enter" }),
      undo: button("Undo", () => void this.view.undo(), { key: "u" }),
      redo: button("Redo", () => void this.view.redo(), { key: "r" }),
      reject: button("Reject", () => this.view.reject(), { kind: "bad", key: "x" }),
      revert: small("Reset to automatic", () => this.view.revert(), {
        title: "Remove all corrections of this image; the history keeps them",
      }),
    };
    const { revert, ...below } = this.buttons;
    return [
      h("div.review-buttons", Object.values(below)),
      h("label.why", [h("span", "Reason to reject"), this.why]),
    ];
  }

  /** Show what the item lacks, with its fields. @param {Answers["Missing"][]} entries */
  missing(entries) {
    this.parts.missing.hidden = !entries.length;
    update(this.parts.missing, [h("h3", "Missing"), missingList(entries)]);
  }

  reason() {
    return this.why.value.trim() || NO_REASON;
  }

  /** Show the options of the tool: the radius of a brush, or an explanation. */
  tool() {
    const { tool, radius } = this.view;
    const { words, brush, hint } = this.tools[tool] ?? {};
    this.radius =
      brush &&
      slider(brush, {
        value: radius,
        min: 1,
        max: 100,
        unit: "px",
        hint,
        onset: (value) => this.view.setRadius(value),
      });
    this.parts.tool.hidden = !brush && !words;
    render(this.parts.tool, brush ? this.radius : words);
  }

  /** Draw what is set of this image: fields, and what stands below them. */
  drawSettings(fields, ...more) {
    const { item } = this.view.corrections;
    update(this.parts.settings, [h("h3", "Settings"), h("div.fields", fields), more], item);
  }

  /** Buttons that reset one part of a correction each. */
  resetButtons(...keys) {
    const { change } = this.view.corrections;
    const made = (value) => (Array.isArray(value) ? value.length > 0 : Boolean(value));
    const reset = (key) => (key === "ellipse_px" ? this.view.resetEllipse() : this.view.set(key, null));
    return h("div.actions", [
      keys.filter((key) => made(change[key])).map((key) => small(`Reset ${WORDS[key]}`, () => reset(key))),
    ]);
  }

  /** Change a table of the study, and measure the image again. @param {Edit} edit */
  edit(edit) {
    workspace
      .edit(edit)
      .then(() => this.view.remeasure())
      .catch(showError);
  }

  corrected() {
    const { document, change } = this.view.corrections;
    this.buttons.undo.disabled = !document.can_undo;
    this.buttons.redo.disabled = !document.can_redo;
    this.buttons.revert.disabled = !Object.keys(change).length;
    render(this.buttons.reject, [
      change.rejected ? "Undo rejection" : "Reject",
      h("kbd", { "aria-hidden": "true" }, "x"),
    ]);
    this.buttons.accept.classList.toggle("accepted", Boolean(change.accepted));
    const records = [...document.history].reverse();
    render(this.parts.history, [
      h("div.headline", [h("h3", "History"), this.buttons.revert]),
      document.on_another_image &&
        alarm("The image file has changed since this correction. Check it, then accept or reset it."),
      h("div.chips", [
        change.accepted && chip("accepted", "good"),
        change.rejected && chip(`rejected: ${change.rejected}`, "bad"),
      ]),
      records.length
        ? h("ol.history", { tabindex: 0, "aria-label": "History of corrections" }, [
            records.map((record) =>
              h("li", [
                h("span", describeChange(record)),
                h("time", { datetime: record.when, title: record.when }, [
                  `${record.who || "unknown"}, ${ago(record.when)}`,
                ]),
              ]),
            ),
          ])
        : h("p.soft", "Measured automatically."),
    ]);
  }
}
