// Phases of a sequence as bands over time, whose limits are moved by pointer or keys.

import { Corrections, NO_REASON } from "../core/corrections.js";
import { attributes, h, render, s, small } from "../core/dom.js";
import { drag } from "../core/gestures.js";
import { showError } from "../core/messages.js";
import { ago, short } from "../core/quantity.js";
import { text } from "../parts/forms.js";

/** A move by keys is saved after this pause. */
const PAUSE_MS = 450;

export class PhaseLimits {
  /** @type {Corrections | null} */
  #corrections = null;
  /** @type {PhaseStart[]} */
  #found = [];
  /** @type {PhaseStart[] | null} while a limit is moved, and until that is saved */
  #moved = null;
  #timer = null;
  #dragged = false;
  #saves = 0;
  /** @type {TimeAxis | null} */
  #place = null;
  /** @type {Frame[]} */
  #frames = [];

  constructor() {
    this.bands = s("g");
    this.layer = h("div.limits");
    this.words = h("span.soft", { role: "status" });
    this.why = text({
      value: "",
      placeholder: NO_REASON,
      label: "Reason of the phases",
      onset: () => this.#manual && this.#save(this.#starts),
    });
    const act = (words, label, doing) => small(words, () => void doing()?.catch(showError), { label });
    this.undoButton = act("Undo", "Undo the change of phases", () => this.#corrections?.undo());
    this.redoButton = act("Redo", "Redo the change of phases", () => this.#corrections?.redo());
    this.resetButton = act("Reset", "Reset the phases to automatic", () =>
      this.#corrections?.keep(() => ({})),
    );
    this.reason = h("label.why", ["Reason", this.why]);
    const buttons = [this.undoButton, this.redoButton, this.resetButton];
    this.bar = h("div.trace-bar", { hidden: true }, [this.words, this.reason, buttons]);
  }

  /**
   * Show the phases of a sequence; null hides them.
   *
   * @param {string | null} sequence
   * @param {PhaseStart[]} found automatically
   * @param {Frame[]} frames as the last run measured them
   */
  set(sequence, found, frames) {
    this.close();
    this.#found = found;
    this.#frames = frames;
    this.bar.hidden = !sequence || !found.length;
    if (!sequence) return;
    this.#corrections = new Corrections(`${sequence}#phases`, {
      changed: () => this.#corrected(),
      conflict: () => {},
    });
    this.#corrections.load().catch(showError);
  }

  /** The manual phases; undefined without a correction. */
  get #manual() {
    /** @type {any} */
    const change = this.#corrections?.change;
    return change?.phases;
  }

  /** @returns {PhaseStart[]} */
  get #starts() {
    return this.#moved ?? this.#manual?.starts ?? this.#found;
  }

  #corrected() {
    if (!this.#corrections) return;
    const { can_undo, can_redo } = this.#corrections.document;
    // What is not saved yet outlasts the answer to an earlier change.
    if (!this.#dragged && this.#timer === null && !this.#saves) this.#moved = null;
    if (document.activeElement !== this.why) this.why.value = this.#manual?.why ?? "";
    this.reason.hidden = this.resetButton.hidden = !this.#manual;
    this.undoButton.hidden = !can_undo;
    this.redoButton.hidden = !can_redo;
    this.words.textContent = this.#described();
    this.#draw();
  }

  #described() {
    const record = this.#corrections.document.history.at(-1);
    const words = this.#manual
      ? `Phases set manually by ${record.who}, ${ago(record.when)}.`
      : "Phases follow from the force; drag the limits below to set them.";
    const replaced = this.#corrections.document.on_another_image
      ? " The force has been replaced since: look at them again."
      : "";
    return `${words}${replaced}${this.#outdated() ? " They count from the next run on." : ""}`;
  }

  /** Whether the last run used other phases. */
  #outdated() {
    const starts = this.#starts;
    const rows = this.#frames.filter(({ phase }) => phase);
    const manual = rows.some(({ phase_corrected_by: who }) => who);
    if (manual !== Boolean(this.#manual)) return rows.length > 0;
    if (!manual) return false;
    const at = (time) => starts.findLast(({ start_s }) => start_s < time)?.phase;
    return rows.some(({ time_s, phase }) => at(time_s) !== phase);
  }

  /** Draw the bands over a time axis. @param {TimeAxis} place */
  draw(place) {
    this.#place = place;
    this.#draw();
  }

  #draw() {
    if (!this.#place) return;
    const starts = this.#starts;
    this.#drawBands(starts);
    const held = this.layer.children.length === starts.length;
    if (!held) render(this.layer, [starts.map((_, k) => this.#limit(k))]);
    for (const [k, node] of [...this.layer.children].entries()) this.#put(node, k, starts);
  }

  #drawBands(starts) {
    const { x, ends, top, bottom, height } = this.#place;
    const inside = (time) => x(Math.max(ends[0], Math.min(ends[1], time)));
    render(this.bands, [
      starts.flatMap(({ phase, start_s }, k) => {
        const [left, right] = [inside(start_s), inside(starts[k + 1]?.start_s ?? ends[1])];
        const inContact = phase !== "before" && phase !== "after";
        return [
          inContact &&
            s("g.band", { "data-phase": phase }, [
              s("rect", { x: left, y: top, width: right - left, height: bottom - top }),
              right - left > 22 + 5.6 * phase.length &&
                s("text", { x: (left + right) / 2, y: height - 7, "text-anchor": "middle" }, phase),
            ]),
          s("path.limit", { d: `M${left.toFixed(1)} ${top}V${bottom}` }),
        ];
      }),
    ]);
  }

  /** The handle of a limit. */
  #limit(k) {
    const node = h("div.limit", { role: "slider", tabindex: 0, "aria-orientation": "horizontal" }, h("i"));
    node.addEventListener("pointerdown", (event) => this.#press(event, node, k));
    node.addEventListener("keydown", (event) => this.#key(event, k));
    node.addEventListener("blur", () => this.#confirm());
    return node;
  }

  #put(node, k, starts) {
    const { x, ends, bottom } = this.#place;
    const { phase, start_s: start } = starts[k];
    const same = starts.filter((one) => one.phase === phase);
    const number = same.length > 1 ? ` ${same.indexOf(starts[k]) + 1}` : "";
    const name = phase === "after" ? `End of contact${number}` : `Start of ${phase}${number}`;
    const [low, high] = this.#bounds(k, starts);
    node.style.left = `${x(Math.max(ends[0], Math.min(ends[1], start)))}px`;
    node.style.top = `${bottom}px`;
    node.title = `${name}: drag it, or use the arrow keys`;
    attributes(node, {
      "aria-label": name,
      "aria-valuemin": low,
      "aria-valuemax": high,
      "aria-valuenow": start,
      "aria-valuetext": `${short(start)} s`,
    });
  }

  /** Between which times a limit can be moved: no phase passes another. */
  #bounds(k, starts) {
    const { ends } = this.#place;
    return [starts[k - 1]?.start_s ?? ends[0], starts[k + 1]?.start_s ?? ends[1]];
  }

  /** Show a limit at another time. */
  #move(k, time) {
    const starts = this.#starts;
    const [low, high] = this.#bounds(k, starts);
    const start = Math.max(low, Math.min(high, Number(time.toFixed(6))));
    this.#moved = starts.map((one, at) => (at === k ? { ...one, start_s: start } : one));
    this.#draw();
  }

  #press(event, node, k) {
    if (event.button) return;
    this.#confirm();
    node.focus({ preventScroll: true });
    this.#dragged = true;
    const { x, time } = this.#place;
    const offset = x(this.#starts[k].start_s) - event.clientX;
    drag(node, event, {
      move: ({ clientX }) => this.#move(k, time(clientX + offset)),
      end: () => {
        this.#dragged = false;
        this.#save(this.#moved);
        node.blur(); // arrow keys go to the next image again
      },
    });
  }

  #key(event, k) {
    const { ctrlKey, metaKey, shiftKey, altKey, key } = event;
    const control = ctrlKey || metaKey;
    const step = this.#place.step * (shiftKey ? 10 : altKey ? 0.2 : 1);
    const [low, high] = this.#bounds(k, this.#starts);
    const now = this.#starts[k].start_s;
    const to = {
      ArrowLeft: now - step,
      ArrowDown: now - step,
      ArrowRight: now + step,
      ArrowUp: now + step,
      PageDown: now - 10 * step,
      PageUp: now + 10 * step,
      Home: low,
      End: high,
    }[key];
    if (to !== undefined && !control) {
      this.#move(k, to);
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#confirm(), PAUSE_MS);
    } else if ((key === "u" && !control) || (control && key === "z")) this.#step("undo");
    else if ((key === "r" && !control) || (control && (key === "y" || key === "Z"))) this.#step("redo");
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  #step(action) {
    this.#confirm();
    this.#corrections[action]().catch(showError);
  }

  /** Save what was moved by keys. */
  #confirm() {
    if (this.#timer === null) return;
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#save(this.#moved);
  }

  /** @param {PhaseStart[] | null} starts */
  #save(starts) {
    if (!starts) return;
    const phases = { starts, why: this.why.value.trim() || NO_REASON };
    this.#saves += 1;
    this.#corrections
      .keep(() => ({ phases }))
      .catch(showError)
      .finally(() => {
        this.#saves -= 1;
        this.#corrected();
      });
  }

  close() {
    this.#confirm();
    this.#corrections?.close();
    this.#corrections = null;
    this.#moved = null;
    this.#found = [];
    render(this.layer);
    render(this.bands);
  }
}
