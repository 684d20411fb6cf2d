// Corrections of one picture: each is on the disk before it is shown as kept.

import { ApiError, get, post } from "./api.js";
import { bench, who } from "./bench.js";
import { question } from "./messages.js";
import { h } from "./dom.js";

export class Corrections {
  /** `changed(document)` hears every new state of the picture's corrections. */
  constructor(item, changed) {
    this.item = item;
    this.changed = changed;
    this.document = { number: 0, corrections: [], now: {}, own: null, can_undo: false, can_redo: false };
    this.queue = Promise.resolve();
    this.heard = ({ detail }) => detail.item === item && detail.number !== this.document.number && this.load();
    bench.addEventListener("corrections", this.heard);
  }

  close() {
    bench.removeEventListener("corrections", this.heard);
    this.changed = () => {};
  }

  async load() {
    return this.#take(await get("/api/corrections", { item: this.item }));
  }

  #take(document) {
    this.document = document;
    this.changed(document);
    return document;
  }

  /** Keep one correction. One after the other, so that quick work does not overtake itself. */
  keep(what, value) {
    return this.#next("/api/corrections", { what, value });
  }

  undo() {
    return this.#next("/api/corrections/undo", {});
  }

  redo() {
    return this.#next("/api/corrections/redo", {});
  }

  #next(path, body) {
    const done = this.queue.then(() => this.#send(path, body));
    this.queue = done.catch(() => {});
    return done;
  }

  async #send(path, body) {
    const send = () => post(path, { item: this.item, after: this.document.number, who: who(), ...body });
    try {
      return this.#take(await send());
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 409) throw error;
      await this.load();
      const theirs = this.document.corrections.at(-1);
      const answer = await question(
        "Another window corrected this picture",
        h("p", null, theirs ? `${theirs.who || "Someone"} changed ${wordFor(theirs.what)} just now. Nothing is lost: theirs is shown behind this question.` : "It was changed just now."),
        [
          ["theirs", "Keep theirs only"],
          ["both", "Keep mine on top", "primary"],
        ],
      );
      return answer === "both" ? this.#take(await send()) : this.document;
    }
  }
}

const WORDS = {
  dark_on_light: "the polarity",
  threshold: "the threshold",
  seed_px: "the seed point",
  region_of_interest_px: "the region of interest",
  mask_px: "the mask",
  strokes: "the region, by brush",
  ellipse: "the ellipse",
  reject: "the rejection",
  accept: "the acceptance",
  note: "the note",
  points_px: "the outline's points",
  handles: "the axes",
  tip: "where the tip points",
  palmar_side: "where the palmar side lies",
};

export const wordFor = (what) => WORDS[what] ?? what;
