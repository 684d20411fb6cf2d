// The settings of one image's correction on all images of that finger and device: each is accepted or left.

import { get, post } from "../core/api.js";
import { describeChange, withoutDefaults } from "../core/corrections.js";
import { button, h, pathOf, render, s, small } from "../core/dom.js";
import { openDialog, showError } from "../core/messages.js";
import { signedPercent } from "../core/quantity.js";
import { describeCode, who } from "../core/workspace.js";
import { alarm } from "../parts/forms.js";

/** Settings that other images may share. */
export const SHARED = ["dark_on_light", "threshold", "region_of_interest_px", "mask_px"];

/** One image: its outline now and with the settings. */
class Card {
  /** @param {Answers["SimilarImage"]} image */
  constructor(image, reviewed) {
    this.image = image;
    this.reviewed = reviewed;
    this.picture = h("div.similar-picture", { "aria-hidden": "true" });
    this.words = h("div.similar-words", { "aria-live": "polite" }, h("p.loading", "Measuring …"));
    this.accept = button("Accept", () => this.#accept(), { kind: "primary small", disabled: true });
    this.leave = small("Leave", () => this.#decide("left"));
    this.root = h("li.similar-card", { "aria-label": image.item, "data-item": image.item }, [
      this.picture,
      h("strong", image.item),
      this.words,
      (this.actions = h("div.actions", [this.accept, this.leave])),
    ]);
  }

  async load() {
    const { item, change, proposed } = this.image;
    try {
      const info = await get("/picture/info", { item });
      this.#draw(info, null, null);
      const [now, then] = await Promise.all([
        post("/measure/contact", { item, change }).catch(() => null),
        post("/measure/contact", { item, change: proposed }),
      ]);
      this.#draw(info, now, then);
      this.#describe(now, then);
      this.accept.disabled = this.state !== undefined;
    } catch (error) {
      render(this.words, alarm(error.message));
    }
  }

  #draw(info, now, then) {
    render(this.picture, [
      h("img", { src: info.preview, alt: "", loading: "lazy" }),
      s("svg.overlay", { viewBox: `-0.5 -0.5 ${info.columns_px} ${info.rows_px}` }, [
        s("path.own", { d: pathOf(now?.outline_px) }),
        s("path.region", { d: pathOf(then?.outline_px) }),
      ]),
    ]);
    this.picture.style.aspectRatio = `${info.columns_px} / ${info.rows_px}`;
  }

  #describe(now, then) {
    const area = (answer) => answer.numbers.gross_area_mm2.value;
    render(this.words, [
      h("p.number", `Area ${then.numbers.gross_area_mm2.words}`),
      h(
        "p.soft.number",
        now ? `${signedPercent(area(then) / area(now) - 1)} from now` : "No contact is found now.",
      ),
      then.flags.length > 0 && h("p.soft", then.flags.map(describeCode).join("; ")),
    ]);
  }

  async #accept() {
    const { item, last_id: expected, proposed } = this.image;
    const change = withoutDefaults({ ...proposed, accepted: true, rejected: null });
    try {
      await post("/corrections", { item, expected, who: who(), change });
      this.#decide("accepted");
    } catch (error) {
      showError(error);
    }
  }

  /** @param {"accepted" | "left"} state */
  #decide(state) {
    this.state = state;
    this.root.dataset.state = state;
    render(this.actions, h("span.chip", { class: state === "accepted" ? "good" : "" }, state));
    this.reviewed();
  }
}

/** Show all similar images with the settings of an item. @param {string} item */
export async function applyToSimilar(item) {
  const { settings, images } = await get("/corrections/similar", { item });
  const cards = images.filter(({ differs }) => differs).map((image) => new Card(image, reviewed));
  const status = h("p.soft", { role: "status" });
  const dialog = h("dialog.similar", { "aria-label": "Apply to similar images" });
  function reviewed() {
    const left = cards.filter(({ state }) => !state);
    status.textContent = left.length
      ? `${cards.length - left.length} of ${cards.length} reviewed`
      : `${cards.filter(({ state }) => state === "accepted").length} accepted, the others are as before`;
    const next = left.find(({ accept }) => !accept.disabled) ?? left[0];
    (next?.accept ?? done).focus();
  }
  const done = button("Close", () => dialog.close());
  render(dialog, [
    h("header", [
      h("div", [
        h("h2", "Apply to similar images"),
        h(
          "p.soft",
          `The ${describeChange({ action: "change", change: settings })} of ${item} on the other images of ` +
            "this finger with the same scale. Dashed: the outline now. Each is kept only once you accept it.",
        ),
      ]),
      done,
    ]),
    cards.length
      ? h("ul.similar-cards", [cards.map(({ root }) => root)])
      : h("p", "No other image of this finger and scale would change."),
    h("footer", status),
  ]);
  openDialog(dialog);
  for (const card of cards) if (dialog.open) await card.load();
  if (dialog.open && cards.length && !cards.some(({ state }) => state)) cards[0].accept.focus();
}
