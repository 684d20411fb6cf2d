// Review of images: measure, correct, accept or reject, and go to the next one.

import { get, LatestRequest } from "../core/api.js";
import { Corrections, withoutDefaults } from "../core/corrections.js";
import { h, render } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { showError, toast } from "../core/messages.js";
import { Brush } from "../editor/drawing.js";
import { Filmstrip } from "../editor/filmstrip.js";
import { Box, EllipseEditor } from "../editor/shapes.js";
import { Stage } from "../editor/stage.js";
import { segments } from "../parts/forms.js";
import { keysOf, panesOf } from "./review_layout.js";

const VERDICTS = ["accepted", "rejected", "pooling"];

/**
 * Base class of the views of contact images and of photographs.
 *
 * Every action of the user starts a new turn, and answers to earlier ones are ignored. The inspector is
 * `aria-busy` until the latest answer is shown.
 */
export class Review {
  /** @type {Element} */
  root;
  /** @type {any[]} */
  entries = [];
  /** @type {string} */
  nothingToAccept;
  /** @type {any[]} */
  last;
  /** @type {Corrections | null} */
  corrections = null;
  at = -1;
  /** @type {"first" | "second"} */
  operator = "first";
  /** @type {Answers["Missing"][] | undefined} */
  lacking;
  tool = "ellipse";
  measured = null;
  /** @type {Error | null} why the image could not be asked for: the server is gone, or was started again */
  unreached = null;
  #turn = 0;

  // Methods that subclasses override.
  addOverlay() {}
  clearOverlay() {}
  /** @param {Answers["PictureInfo"]} _info */
  showInfo(_info) {}
  /** @param {Partial<Change>} _change */
  draw(_change) {}
  /** @returns {any} */
  makeTool(_tool) {}
  /** @param {() => boolean} _latest whether no newer measurement was requested */
  async measure(_item, _latest) {}
  /** @param {{ live?: boolean }} [_options] */
  show(_answer, _options) {}
  /** @returns {object} */
  dragged() {
    return {};
  }
  dropped() {}
  /** @returns {Answers["Missing"][]} what the item of the entry lacks */
  missing() {
    return [];
  }
  address(_item) {
    return "";
  }
  title() {
    return "";
  }

  /**
   * Lay out the view; `measureDragged` is called while a handle is dragged.
   *
   * @param {{ title: string, words: string, label: string, axes: string[], tools: Tool[], radius: number,
   *   measureDragged: (state: any) => Promise<any>, describe: (entry: any) => any, inspector: any, bar?: any,
   *   keys?: any[] }} options
   */
  layOut({ title, words, label, axes, tools, radius, measureDragged, describe, inspector, bar, keys = [] }) {
    this.radius = radius;
    this.stage = new Stage(label);
    this.mark = h("span.synthetic.stage-synthetic", { hidden: true }, "synthetic");
    this.stage.root.append(this.mark);
    this.addOverlay();
    this.editor = new EllipseEditor(this.stage, axes, (_, final) => this.#dragged(final));
    this.box = new Box(this.stage, (box, final) => final && this.set("region_of_interest_px", box));
    this.tools = tools;
    this.toolbar = segments(
      "Tools",
      tools.map(([tool, words, shortcut]) => [tool, words, { icon: tool, shortcut }]),
      this.tool,
      (tool) => this.use(tool),
      { vertical: true },
    );
    this.strip = new Filmstrip({ label: "Images", chosen: (index) => this.choose(index), describe });
    this.live = new LatestRequest(
      measureDragged,
      (answer) => this.show(answer, { live: true }),
      (error) => this.stage.setMessage(error.message, "bad"),
    );
    this.inspector = inspector;
    render(this.root, panesOf(this, title, words, bar));
    bindHere(keysOf(this, keys));
  }

  get entry() {
    return this.entries[this.at];
  }

  async choose(index) {
    if (index === this.at || !this.entries[index]) return;
    // A handle moved by keys commits when it loses the focus.
    if (document.activeElement?.closest(".handle")) this.stage.root.focus({ preventScroll: true });
    this.at = index;
    this.held = false;
    this.unreached = null;
    const { item } = this.entry;
    this.strip.choose(index);
    history.replaceState(null, "", this.address(item));
    this.corrections?.close();
    this.corrections = new Corrections(item, {
      changed: () => this.#corrected(),
      conflict: () => this.#conflict(),
      operator: this.operator,
    });
    this.#turned();
    this.measured = undefined; // not known yet
    this.stage.root.classList.remove("rejected", "comparing"); // the image before may have been
    this.inspector.root.hidden = this.inspector.footer.hidden = false;
    this.#clear();
    this.lacking = undefined;
    this.inspector.wait();
    this.refreshMissing();
    this.inspector.why.value = "";
    this.stage.setScale(null);
    const mine = this.corrections;
    const loaded = mine.load();
    loaded.catch(() => {}); // awaited below
    // The picture shows whatever else is missing.
    const info = await get("/picture/info", { item }).catch((error) => error);
    if (this.corrections !== mine) return;
    if (info instanceof Error) this.stage.setMessage(info.message, "bad");
    else {
      this.showInfo(info);
      this.stage.show(info.preview, info.rows_px, info.columns_px, this.title());
    }
    try {
      await loaded;
      if (this.corrections === mine) await this.remeasure();
    } catch (error) {
      if (this.corrections === mine) this.#failed(error);
    }
  }

  /** Take what the study now says of entries. */
  renew(entries, now) {
    const known = new Map(now.map((entry) => [entry.item, entry]));
    for (const entry of entries) Object.assign(entry, known.get(entry.item));
    this.strip.refresh();
  }

  step(by) {
    this.choose(this.at + by);
  }

  /** Show that there is no image to review. */
  nothing() {
    this.#turned();
    this.#busy(false);
    this.at = -1;
    this.corrections?.close();
    this.corrections = this.measured = null;
    this.stage.hide();
    this.#clear();
    this.inspector.root.hidden = this.inspector.footer.hidden = true;
  }

  /** Draw no correction. */
  #clear() {
    this.editor.set(null);
    this.box.set(null);
    this.clearOverlay();
  }

  /** Start a turn: answers to earlier requests are ignored. */
  #turned() {
    this.live.cancel();
    this.#busy(true);
    return (this.#turn += 1);
  }

  #busy(yes) {
    this.inspector.root.setAttribute("aria-busy", String(yes));
  }

  /** Measure under the active correction. */
  async remeasure(turn = this.#turned()) {
    const newest = () => this.#turn === turn;
    try {
      await this.measure(this.corrections.item, newest);
    } catch (error) {
      if (newest()) this.#failed(error);
    }
    if (newest()) this.#busy(false);
  }

  #failed(error) {
    this.measured = null;
    this.unreached = [0, 403].includes(error.status) ? error : null;
    this.editor.set(null);
    this.clearOverlay();
    this.stage.setScale(null);
    this.inspector.show(null, error.message);
    this.#busy(false);
  }

  /** Show what the item lacks, and measure it again once that has changed. */
  refreshMissing() {
    if (!this.entry) return;
    if (this.unreached) {
      const { at } = this;
      this.at = -1;
      this.choose(at);
      return;
    }
    const before = JSON.stringify(this.lacking);
    this.lacking = this.missing();
    if (JSON.stringify(this.lacking) === before) return;
    this.inspector.missing(this.lacking);
    if (before !== undefined) this.remeasure();
  }

  #corrected() {
    const { change } = this.corrections.document;
    const entry = this.entries.find(({ item }) => item === this.corrections.item);
    if (entry) {
      entry.accepted = Boolean(change.accepted);
      entry.rejected = change.rejected ?? null;
      entry.corrected = Object.keys(withoutDefaults(change)).some((key) => !VERDICTS.includes(key));
      this.strip.refresh();
    }
    this.stage.root.classList.toggle("rejected", Boolean(change.rejected));
    this.box.set(change.region_of_interest_px ?? null);
    this.draw(change);
    this.showTool();
    this.inspector.corrected();
  }

  use(tool) {
    this.tool = tool;
    this.toolbar.show(tool);
    this.stage.use(tool === "box" ? this.box : this.makeTool(tool));
    this.showTool();
    this.stage.root.focus({ preventScroll: true });
    this.inspector.tool();
  }

  /** Make a brush; `done` is called with each stroke. */
  paint(action, done) {
    return new Brush(this.stage, { action, radius: this.radius, done });
  }

  showTool() {
    const editing = this.tool === "ellipse" && this.measured && !this.corrections?.change.rejected;
    const shown = (yes) => (yes ? "" : "none");
    this.editor.grips.style.display = shown(editing);
    this.box.layer.style.display = shown(this.tool === "box" || this.box.value);
    this.box.grips.style.display = shown(this.tool === "box");
  }

  setRadius(radius) {
    this.radius = Math.round(Math.min(200, Math.max(1, radius)));
    this.stage.tool?.setRadius?.(this.radius);
    this.inspector.radius?.show(this.radius);
  }

  /** Show a correction of another window unless a handle is being dragged. */
  #conflict() {
    if (!this.held) this.remeasure();
  }

  #dragged(final) {
    if (final) {
      this.held = false;
      this.dropped();
    } else this.tryOut(this.dragged());
  }

  /** Show what a correction would give while the hand still moves; nothing is saved. */
  tryOut(change) {
    this.held = true;
    this.#turn += 1;
    this.#busy(true);
    this.live.request(change);
  }

  set(key, value) {
    return this.keep((change) => ({ ...change, [key]: value }));
  }

  /** Save a correction; it resets an earlier accept or reject. */
  keep(edit) {
    return this.#change((mine) =>
      mine.keep(async (change) =>
        withoutDefaults({ ...(await edit(change)), accepted: false, rejected: null }),
      ),
    );
  }

  /** Remove the manual ellipse from a correction, with a message if there is one. */
  withoutEllipse(change) {
    if (change.ellipse_px) toast("This replaces the manual ellipse; Undo restores it.");
    return { ...change, ellipse_px: null, key_frame: false };
  }

  resetEllipse() {
    return this.keep((change) => ({ ...change, ellipse_px: null, key_frame: false }));
  }

  /** Save whether the contact is pooled; the verdict stays. */
  decidePooling(pooling) {
    return this.#change((mine) => mine.keep((change) => withoutDefaults({ ...change, pooling })));
  }

  undo() {
    return this.#change((mine) => mine.undo());
  }

  redo() {
    return this.#change((mine) => mine.redo());
  }

  revert() {
    return this.keep(() => ({}));
  }

  async #change(send) {
    if (!this.corrections) return;
    const turn = this.#turned();
    await send(this.corrections).catch(showError);
    if (turn === this.#turn) await this.remeasure(turn);
  }

  /** Save the verdict on a change that may still load; whether it was, and its image is still shown. */
  async #judge(verdict) {
    const mine = this.corrections;
    if (mine.judging) return false;
    mine.judging = true;
    const saved = mine.keep((change) => withoutDefaults({ ...change, ...verdict(change) }));
    const done = await saved.then(() => true, showError).finally(() => (mine.judging = false));
    return done === true && this.corrections === mine;
  }

  async accept() {
    if (!this.entry) return;
    if (this.measured === undefined) return; // it can be accepted once it is shown
    if (!this.measured) toast(this.unreached?.message ?? this.nothingToAccept, { kind: "error" });
    else if (
      this.corrections.change.accepted ||
      (await this.#judge(() => ({ accepted: true, rejected: null })))
    )
      this.#next();
  }

  /** Reject the image, or undo its rejection unless it is to be rejected `again`, for another reason. */
  async reject({ again = false } = {}) {
    if (!this.entry) return;
    const reason = this.inspector.reason();
    const judged = await this.#judge(({ rejected }) =>
      rejected && !again ? { rejected: null } : { accepted: false, rejected: reason },
    );
    if (judged && this.corrections.change.rejected && this.entries[this.at + 1]) this.step(1);
  }

  #next() {
    if (this.entries[this.at + 1]) this.step(1);
    else {
      toast(this.last[0], this.last[1]);
      this.remeasure(); // whether it is pooled may have changed
    }
  }

  /** Commit a handle that is being moved, and ignore later answers. */
  close() {
    if (document.activeElement?.closest(".handle"))
      /** @type {HTMLElement} */ (document.activeElement).blur();
    this.closed = true;
    this.#turn += 1;
    this.corrections?.close();
    this.corrections = null;
    this.live?.cancel();
    this.stage?.close();
    this.strip?.close();
  }
}
