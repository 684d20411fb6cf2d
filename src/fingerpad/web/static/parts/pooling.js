// Whether a contact counts in the pooled radius: why, and its correction.

import { contactAddress } from "../core/api.js";
import { Corrections, withoutDefaults } from "../core/corrections.js";
import { h, update } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { ago, short } from "../core/quantity.js";
import { describeCode } from "../core/workspace.js";
import { button, text } from "./forms.js";

const REASON = "no reason given";

/** @param {Answers["PoolingCorrectionRecord"]} correction */
const correctionWords = ({ include, why, who, when }) =>
  `${include ? "included" : "left out"} by ${who}, ${ago(when)}: ${why}`;

/** Save the correction of a contact's pooling, and return it; null goes back to the rule. */
async function correctPooling(item, pooling) {
  const corrections = new Corrections(item, { changed: () => {}, conflict: () => {} });
  try {
    await corrections.load();
    await corrections.keep((change) => withoutDefaults({ ...change, pooling }));
    return corrections.document.pooling;
  } finally {
    corrections.close();
  }
}

/**
 * Which contacts of a group are pooled, who is out and why, with a button for each.
 *
 * @param {Answers["PlottedGroup"]["pooling"]} pooling
 */
export function poolingList(pooling) {
  const { contacts, contacts_pooled: pooled, contacts_rejected: rejected } = pooling;
  const { frames, frames_pooled: framesPooled } = pooling;
  const why = text({ value: "", placeholder: REASON, label: "Reason of the correction" });
  const list = h("ul.pooling-list");
  const draw = () => update(list, [pooling.in_question.map((one) => row(one))]);
  /** @param {Answers["PooledContact"]} one */
  const row = (one) => {
    const wanted = one.correction?.include ?? one.pooled;
    const set = (value) => async () => {
      try {
        one.correction = await correctPooling(
          one.item,
          value && { ...value, why: why.value.trim() || REASON },
        );
        draw();
      } catch (error) {
        showError(error);
      }
    };
    const load = one.load_N === null ? "" : `, ${short(one.load_N)} N`;
    return h("li", { "data-pooled": String(one.pooled) }, [
      h("div", [
        h("a", { href: contactAddress(one.item) }, one.item),
        `${load} is ${one.pooled ? "pooled" : "left out"}${one.why ? `: ${one.why}` : ""}. `,
        one.correction && h("strong", [correctionWords(one.correction), ". "]),
        one.correction && one.correction.include !== one.pooled && "It takes effect with the next run.",
      ]),
      h("div.actions", [
        button(wanted ? "Leave out" : "Include", set({ include: !wanted }), {
          kind: "small",
          label: `${wanted ? "Leave out" : "Include"} ${one.item}`,
        }),
        one.correction &&
          button("Undo", set(null), { kind: "small", label: `Undo the correction of ${one.item}` }),
      ]),
    ]);
  };
  draw();
  const counts = [
    contacts > 0 && `${pooled} of ${contacts} contacts pooled`,
    rejected > 0 && `${rejected} rejected`,
    frames > 0 && `${framesPooled} of ${frames} frames pooled`,
  ].filter(Boolean);
  if (!pooling.in_question.length) return h("p.soft.pooling-count", counts.join(", "));
  return h("details.pooling", { open: pooled + rejected < contacts }, [
    h("summary", counts.join(", ")),
    h("label.why", [h("span", "Reason"), why]),
    list,
  ]);
}

/**
 * What keeps the contact beside an image out of the pooled radius, with a button.
 *
 * @param {NonNullable<ContactMeasurement["pooling"]>} pooling
 * @param {(pooling: object | null) => any} set
 */
export function poolingOf({ pooled, excluding_flags: flags, correction }, set) {
  return h(pooled ? "div.pooling-note" : "div.pooling-note.note", [
    h("strong", pooled ? "Counts in the pooled radius" : "Left out of the pooled radius"),
    flags.length > 0 && [": ", flags.map(describeCode).join("; ")],
    ". ",
    correction && [correctionWords(correction), ". "],
    h("div.actions", [
      button(pooled ? "Leave out" : "Include", () => set({ include: !pooled, why: REASON }), {
        kind: "small",
      }),
      correction && button("Undo the correction", () => set(null), { kind: "small" }),
    ]),
  ]);
}
