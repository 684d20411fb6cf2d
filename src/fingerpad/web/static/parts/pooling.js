// Whether a contact counts in the pooled radius: why, and its correction.

import { contactAddress } from "../core/api.js";
import { Corrections, NO_REASON, withoutDefaults } from "../core/corrections.js";
import { h, small, update } from "../core/dom.js";
import { ago, short } from "../core/quantity.js";
import { describeCode } from "../core/workspace.js";
import { text } from "./forms.js";

/** @param {Answers["CorrectedPooling"]} correction */
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

/** Buttons that correct whether a contact is pooled. */
function actionsOf(pooled, correction, set, item) {
  const words = pooled ? "Leave out" : "Include";
  const correct = () => set({ include: !pooled, why: NO_REASON });
  return h("div.actions", [
    small(words, correct, { label: `${words} ${item}` }),
    correction && small("Undo the correction", () => set(null), { label: `Undo the correction of ${item}` }),
  ]);
}

/**
 * Which contacts of a group are pooled, who is out and why, with a button for each.
 *
 * @param {Answers["PlottedGroup"]["pooling"]} pooling
 */
export function poolingList(pooling) {
  const { contacts, contacts_pooled: pooled, contacts_rejected: rejected } = pooling;
  const { frames, frames_pooled: framesPooled } = pooling;
  const why = text({ value: "", placeholder: NO_REASON, label: "Reason of the correction" });
  const list = h("ul.pooling-list");
  const draw = () => update(list, [pooling.in_question.map((one) => row(one))]);
  /** @param {Answers["PooledContact"]} one */
  const row = (one) => {
    const wanted = one.correction?.include ?? one.pooled;
    const set = async (pooling) => {
      const reason = why.value.trim() || NO_REASON;
      one.correction = await correctPooling(one.item, pooling && { ...pooling, why: reason });
      draw();
    };
    const load = one.load_N === null ? "" : `, ${short(one.load_N)} N`;
    return h("li", { "data-pooled": String(one.pooled) }, [
      h("div", [
        h("a", { href: contactAddress(one.item) }, one.item),
        `${load} is ${one.pooled ? "pooled" : "left out"}${one.why ? `: ${one.why}` : ""}. `,
        one.correction && h("strong", [correctionWords(one.correction), ". "]),
        one.correction && one.correction.include !== one.pooled && "It takes effect with the next run.",
      ]),
      actionsOf(wanted, one.correction, set, one.item),
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
    actionsOf(pooled, correction, set, "this contact"),
  ]);
}
