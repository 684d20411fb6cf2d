// Quantities in rows, and numbers where no uncertainty rounds them. The library sends quantities in words.

import { h } from "./dom.js";
import { symbol } from "./glossary.js";

/** A number of a scale or a handle, to some digits. @param {number | null} value */
export const short = (value, digits = 4) =>
  value === null ? "–" : String(Number(value.toPrecision(digits)));

/** A share in per cent. @param {number | null} share */
export const percent = (share, digits = 1) => (share === null ? "–" : `${(100 * share).toFixed(digits)} %`);

/** A difference in per cent, with its sign. @param {number | null} share */
export const signedPercent = (share) =>
  share === null ? "–" : `${share < 0 ? "−" : "+"}${percent(Math.abs(share))}`;

/**
 * A quantity with its label, and what stands beside it; `was` is the value of the automatic measurement.
 *
 * @param {any} label
 * @param {any} text
 * @param {{ was?: string, mark?: string, title?: string, beside?: any }} [options]
 */
export function quantityRow(label, text, { was, mark, title, beside } = {}) {
  return h("div.reading", { title }, [
    h("dt", [mark && h("span.swatch", { style: { background: `var(--${mark})` } }), label]),
    h("dd", [
      h("span.number", beside ? [text, " ", beside] : text),
      was && was !== text && h("span.was", `automatic ${was}`),
    ]),
  ]);
}

/**
 * Rows of quantities of an answer, by their keys.
 *
 * @param {Shown[]} shown
 * @param {any} answer
 * @param {{ automatic?: any, beside?: (key: string) => any }} [options] the automatic answer, to compare
 */
export const quantityRows = (shown, answer, { automatic, beside } = {}) =>
  shown.map(([key, words, term, title, mark]) =>
    quantityRow([words, words && term && " ", term && symbol(term)], answer[key].words, {
      mark,
      title,
      was: automatic?.[key].words,
      beside: beside?.(key),
    }),
  );

/** How many there are of something. */
export const counted = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/** How many sequences there are, and frames in them. @param {{ frames: number | null }[]} sequences */
export function countedFrames(sequences) {
  const frames = sequences.reduce((all, one) => all + (one.frames ?? 0), 0);
  return `${counted(sequences.length, "sequence")} of ${counted(frames, "frame")}`;
}

export function ago(when) {
  const seconds = (Date.now() - Date.parse(when)) / 1000;
  if (!Number.isFinite(seconds)) return "";
  if (seconds < 90) return "just now";
  if (seconds < 5400) return `${Math.round(seconds / 60)} min ago`;
  if (seconds < 129600) return `${Math.round(seconds / 3600)} h ago`;
  return new Date(when).toISOString().slice(0, 10);
}

export function bytes(count) {
  if (count < 1e3) return `${count} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(0)} kB`;
  if (count < 1e9) return `${(count / 1e6).toFixed(1)} MB`;
  return `${(count / 1e9).toFixed(2)} GB`;
}
