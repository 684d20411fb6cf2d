// The editor of a contact image: measurement, outline, tools, and the histogram of its levels.

import { post } from "../core/api.js";
import { withoutDefaults } from "../core/corrections.js";
import { showError, toast } from "../core/messages.js";
import { describeCode } from "../core/workspace.js";
import { Click, ContactOverlay, Lasso, Polygon } from "../editor/drawing.js";
import { Review } from "./review.js";
import { applyToSimilar } from "./similar.js";

/** Whether a person outlined the contact themselves. @param {Partial<Change>} change */
const outlined = ({ ellipse_px: ellipse, threshold, strokes }) =>
  Boolean(ellipse || threshold || strokes?.some(({ action }) => action === "replace"));

/** Review of contact images, whatever list they are chosen from. */
export class ContactReview extends Review {
  /** @type {"add" | "remove" | "replace"} */
  action = "replace";
  /** @type {Answers["ContactLevels"] | null} */
  levels = null;
  levelsKey = "";
  /** @type {ContactMeasurement | null} the last result that no hand was moving */
  lastShown = null;

  /** @type {Answers["SecondOperator"] | null} */
  agreement = null;

  nothingToAccept = "No contact was found. Reject the image, or set threshold, polarity or seed point.";
  /** Whether the person works without seeing any outline but their own. */
  get blind() {
    return this.operator === "second";
  }

  addOverlay() {
    this.overlay = new ContactOverlay(this.stage);
  }

  async measure(item, newest) {
    const change = this.blind ? this.corrections.change : undefined;
    if (this.blind && !outlined(change)) {
      this.measured = null;
      this.editor.set(null);
      this.overlay.clear();
      this.stage.tool?.dry?.();
      this.inspector.blind();
    } else {
      // Photographs that no run has measured take longer than the contact.
      const answer = await post("/measure/contact", { item, change, soon: true });
      if (!newest()) return;
      this.show(answer);
      if (answer.waits) {
        const whole = await post("/measure/contact", { item, change });
        if (!newest()) return;
        this.show(whole, { live: true });
        this.#say(whole);
      }
    }
    await this.#levels(item, newest);
  }

  /** Show the histogram; only some corrections change it. */
  async #levels(item, newest) {
    const { threshold, dark_on_light, seed_px, mask_px, region_of_interest_px } = this.corrections.change;
    const change = withoutDefaults({ dark_on_light, seed_px, mask_px, region_of_interest_px });
    const smooth = this.inspector.isSmooth(); // then no level tells the contact from the ground
    const key = JSON.stringify([item, change, smooth]);
    if (key !== this.levelsKey) {
      const levels = smooth ? null : await post("/measure/levels", { item, change }).catch(() => null);
      if (!newest()) return;
      [this.levels, this.levelsKey] = [levels, key];
    }
    const levels = this.levels && { ...this.levels, ...(this.blind && { automatic_threshold: null }) };
    this.inspector.levels(levels, threshold ?? null);
  }

  /** The correction with another threshold, while it is moved. */
  tryThreshold(threshold) {
    this.editor.set(null);
    this.tryOut(withoutDefaults({ ...this.corrections.change, threshold, accepted: false, rejected: null }));
  }

  setThreshold(threshold) {
    this.held = false;
    this.set("threshold", threshold);
  }

  /** @param {ContactMeasurement} answer @param {{ live?: boolean }} [options] */
  show(answer, { live = false } = {}) {
    if (!live && !answer.waits) this.#say(answer);
    this.measured = answer;
    this.stage.setScale(answer.mm_per_px);
    this.overlay.region(answer.outline_px);
    if (!live) {
      this.stage.setMessage("");
      this.editor.place(...answer.handles_px);
      this.showTool();
      this.stage.tool?.dry?.();
    }
    this.inspector.show(answer);
  }

  /** Say that a correction leaves the contact out: the reason may stand below what is in view. */
  #say(answer) {
    const { item, pooling } = answer;
    const left = this.lastShown?.item === item && this.lastShown.pooling?.pooled && !pooling?.pooled;
    this.lastShown = answer;
    if (left && !this.blind && pooling?.excluding_flags.length)
      toast(`Left out of the pooled radius: ${pooling.excluding_flags.map(describeCode).join("; ")}.`);
  }

  draw(change) {
    this.overlay.correction(change);
  }

  makeTool(tool) {
    if (tool === "seed") return new Click((at) => this.set("seed_px", at));
    if (tool === "ellipse" || tool === "threshold") return null;
    const done = (stroke) => {
      if (!this.corrections) return;
      if (this.blind && stroke.action !== "replace" && !outlined(this.corrections.change)) {
        toast(this.nothingToAccept);
        this.stage.tool?.dry?.();
        return;
      }
      this.keep((change) => ({
        ...this.withoutEllipse(change),
        strokes: [...(stroke.action === "replace" ? [] : (change.strokes ?? [])), stroke],
      }));
    };
    const Area = { lasso: Lasso, polygon: Polygon }[tool];
    if (Area) return new Area(this.stage, { action: this.action, done });
    return this.paint(tool, done);
  }

  applyToSimilar() {
    return applyToSimilar(this.entry.item).catch(showError);
  }

  /** @param {"add" | "remove" | "replace"} action what an area that is drawn around does */
  setAction(action) {
    this.action = action;
    this.stage.tool?.setAction?.(action);
    this.stage.root.focus({ preventScroll: true });
  }

  ellipse() {
    const { centre, lengths } = this.editor.value;
    const turned = lengths[1] > lengths[0];
    return {
      centre: [...centre],
      semi_axes: turned ? [lengths[1], lengths[0]] : [...lengths],
      orientation_deg: this.editor.fromUp + (turned ? 90 : 0),
    };
  }

  dragged() {
    return withoutDefaults({
      ...this.corrections.change,
      ellipse_px: this.ellipse(),
      rejected: null,
      accepted: false,
    });
  }

  dropped() {
    this.set("ellipse_px", this.ellipse());
  }

  showAutomatic(show) {
    if (this.blind) return;
    const own = this.measured?.automatic;
    this.overlay.own(show && own ? this.measured.automatic_outline_px : null);
    this.stage.root.classList.toggle("comparing", show);
    if (show && !own)
      this.stage.setMessage(this.measured?.automatic_error ?? "No contact was found automatically.");
    else if (!show) this.stage.setMessage("");
  }
}
