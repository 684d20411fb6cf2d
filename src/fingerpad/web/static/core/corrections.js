// Corrections of one image; each is shown once it is saved.

import { ApiError, get, post } from "./api.js";
import { h } from "./dom.js";
import { ask } from "./messages.js";
import { who, workspace } from "./workspace.js";

export class Corrections {
  /**
   * `changed` is called on every new state, `conflict` also if another window corrected the image.
   *
   * @param {string} item
   * @param {{ changed: () => void, conflict: () => void, operator?: "first" | "second" }} options
   */
  constructor(item, { changed, conflict, operator = "first" }) {
    this.item = item;
    /** @type {"first" | "second"} */
    this.operator = operator;
    this.changed = changed;
    this.conflict = conflict;
    // Until it is loaded.
    this.document = /** @type {Answers["Corrections"]} */ ({ item, last_id: 0, change: {}, history: [] });
    /** Whether a verdict is being saved. */
    this.judging = false;
    /** @type {Promise<any>} */
    this.queue = Promise.resolve();
    this.removeListener = workspace.on("corrections", (detail) => {
      if (detail.item === item) this.#next(() => this.#follow(detail.last_id));
    });
  }

  close() {
    this.removeListener();
    this.changed = this.conflict = () => {};
  }

  async #follow(id) {
    if (id === this.document.last_id) return;
    await this.#read();
    this.conflict();
  }

  load() {
    return this.#next(() => this.#read());
  }

  async #read() {
    return this.#take(await get("/corrections", { item: this.item, operator: this.operator }));
  }

  /** @returns {Partial<Change>} */
  get change() {
    return this.document.change;
  }

  #take(document) {
    this.document = document;
    this.changed();
    return document;
  }

  /**
   * Save a correction: `edit` returns it from the active one. Corrections are saved one after the other; if
   * another window saved one in the meantime, the user is asked.
   */
  keep(edit) {
    return this.#next(() =>
      this.#send("/corrections", async () => ({ change: await edit(structuredClone(this.change)) })),
    );
  }

  undo() {
    return this.#next(() => this.document.can_undo && this.#send("/corrections/undo", () => ({})));
  }

  redo() {
    return this.#next(() => this.document.can_redo && this.#send("/corrections/redo", () => ({})));
  }

  #next(send) {
    const done = this.queue.then(send);
    this.queue = done.catch(() => {});
    return done;
  }

  async #send(path, body) {
    const send = async () =>
      post(path, {
        item: this.item,
        operator: this.operator,
        expected: this.document.last_id,
        who: who(),
        ...(await body()),
      });
    try {
      return this.#take(await send());
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 409) throw error;
      await this.#read();
      const theirs = this.document.history.at(-1);
      const mine = await ask(
        "Another window corrected this image",
        h("p", [
          theirs
            ? `${theirs.who || "Someone"} saved ${describeChange(theirs)} just now. Yours is not saved yet.`
            : "It was changed just now.",
        ]),
        "Apply mine as well",
        { no: "Keep their correction" },
      );
      return mine ? this.#take(await send()) : this.document;
    }
  }
}

/** The reason of a correction that none is stated for. */
export const NO_REASON = "no reason given";

/** What is changed, by the keys of a correction. */
export const WORDS = {
  dark_on_light: "polarity",
  threshold: "threshold",
  seed_px: "seed point",
  region_of_interest_px: "region of interest",
  mask_px: "mask",
  strokes: "drawing",
  ellipse_px: "ellipse",
  key_frame: "key frame",
  added_points_px: "added points",
  erased: "erased points",
  tip: "side of the fingertip",
  palmar_side: "palmar side",
  accepted: "accepted",
  rejected: "rejected",
  pooling: "pooling",
  phases: "phases",
};

/** Describe a record of the history. */
export function describeChange({ action, change }) {
  if (action !== "change") return action;
  const parts = Object.keys(change).filter((key) => change[key] !== null && change[key] !== false);
  return parts.length ? parts.map((key) => WORDS[key] ?? key).join(", ") : "reset to automatic";
}

const isUnset = (value) => [null, undefined, false].includes(value) || value.length === 0;

/** A correction without default values. */
export const withoutDefaults = (change) =>
  Object.fromEntries(
    Object.entries(change).filter(
      ([key, value]) => !isUnset(value) || (key === "dark_on_light" && value === false),
    ),
  );
