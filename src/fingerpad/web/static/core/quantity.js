// Values with standard uncertainty to two digits (GUM 7.2.6): the same digits as value_with_uncertainty in
// fingerpad._rounding.

import { h } from "./dom.js";

// Of a value at most so many significant digits are shown; its uncertainty is rounded up to the last of them.
const MOST_DIGITS = 5;
const MOST_DECIMALS = 100; // that toFixed writes
const EN = "–";
const SPACE = "\u00a0";

/** The decimal place of the first digit: 2 of 345. */
const magnitude = (value) => Number(value.toExponential().split("e")[1]);

/** A value to some decimals, as Python rounds: exactly, and halves to the even digit. */
function rounded(value, decimals) {
  if (Math.abs(value) >= 1e21) return String(value); // as toFixed
  const [whole, rest] = Math.abs(value).toFixed(MOST_DECIMALS).split(".");
  const unit = 10n ** BigInt(MOST_DECIMALS - decimals);
  const exact = BigInt(whole + rest);
  let count = exact / unit;
  const twice = 2n * (exact % unit);
  if (twice > unit || (twice === unit && count % 2n === 1n)) count += 1n;
  const digits = (decimals < 0 ? count * 10n ** BigInt(-decimals) : count).toString();
  const sign = value < 0 ? "−" : "";
  if (decimals <= 0) return sign + digits;
  const all = digits.padStart(decimals + 1, "0");
  return `${sign}${all.slice(0, -decimals)}.${all.slice(-decimals)}`;
}

/** The decimal place of the second digit, after rounding: 0.0996 becomes 0.10. */
function decimalsOf(std) {
  const decimals = 1 - magnitude(std);
  return Number(rounded(std, decimals)) >= Number(`1e${2 - decimals}`) ? decimals - 1 : decimals;
}

/** Four significant digits; below one three decimals, and at least three digits. */
export function plain(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return EN;
  if (value === 0) return "0";
  if (Math.abs(value) < 1) return rounded(value, Math.min(9, Math.max(3, 2 - magnitude(value))));
  const text = rounded(value, 3 - magnitude(value));
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

export function withStd(value, std) {
  if (value === null || value === undefined || !Number.isFinite(value)) return EN;
  if (!(std > 0) || !Number.isFinite(std)) return plain(value);
  const finest = value === 0 ? 99 : MOST_DIGITS - 1 - magnitude(value);
  const wanted = decimalsOf(std);
  const decimals = Math.min(wanted, finest);
  const shown = wanted <= finest ? std : Math.ceil(std * 10 ** finest) / 10 ** finest;
  return `${rounded(value, decimals)}${SPACE}±${SPACE}${rounded(shown, decimals)}`;
}

/**
 * The number that a text states with a decimal point or comma, null of an empty one; NaN, and what is wrong,
 * if it is none or could be two.
 *
 * @param {string} words
 * @returns {{ value: number | null, problem: string }}
 */
export function readNumber(words) {
  const plain = words.trim().replace("−", "-");
  if (plain === "") return { value: null, problem: "" };
  const refused = (problem) => ({ value: Number.NaN, problem: `"${words.trim()}" ${problem}` });
  if (/^[-+]?[1-9]\d{0,2},\d{3}$/.test(plain))
    return refused(`could be ${plain.replace(",", ".")} or ${plain.replace(",", "")}: write which.`);
  if (!/^[-+]?(\d+[.,]?\d*|[.,]\d+)(e[-+]?\d+)?$/i.test(plain))
    return refused(
      /^[-+]?\d[\d.,'’ \u00a0\u202f]*$/.test(plain)
        ? "is not a number here: write no thousands separator, and one decimal point."
        : "is not a number.",
    );
  const value = Number(plain.replace(",", "."));
  return Number.isFinite(value) ? { value, problem: "" } : refused("is too large.");
}

const UNITS = [
  ["_per_mm", "mm⁻¹"],
  ["_mm2", "mm²"],
  ["_mm", "mm"],
  ["_kpa", "kPa"],
  ["_deg", "°"],
  ["_px", "px"],
  ["_ppi", "ppi"],
  ["_N", "N"],
  ["_s", "s"],
];

export function unitOf(key) {
  if (key.endsWith("mm_per_px")) return "mm/px";
  return UNITS.find(([ending]) => key.endsWith(ending))?.[1] ?? "";
}

export const withUnit = (text, unit) => (unit ? (unit === "°" ? `${text}°` : `${text} ${unit}`) : text);

/** A positive value with its standard uncertainty; with a factor where two of them reach below zero. */
export function withTotal(value, std) {
  if (!(2 * std > value && value > 0) || !Number.isFinite(std)) return withStd(value, std);
  return `${twoDigits(value)}${SPACE}×/÷${SPACE}${twoDigits(1 + std / value)}`;
}

const twoDigits = (value) => rounded(value, decimalsOf(value));

/** A quantity by its key, with its standard uncertainty, in which the model's part is where it has one. */
export function quantityText(numbers, key) {
  const total = numbers?.[`${key}_total_std`];
  const text =
    total === undefined ? withStd(numbers?.[key], numbers?.[`${key}_std`]) : withTotal(numbers[key], total);
  return withUnit(text, unitOf(key));
}

/**
 * A quantity with its label; `was` is the value of the automatic measurement.
 *
 * @param {any} label
 * @param {any} text
 * @param {{ was?: string, mark?: string, title?: string }} [options]
 */
export function quantityRow(label, text, { was, mark, title } = {}) {
  return h(
    "div.reading",
    { title },
    h("dt", mark && h("span.swatch", { "data-of": mark }), label),
    h("dd", h("span.number", text), was && was !== text && h("span.was", h("span.sr", "automatic: "), was)),
  );
}

export const probability = (p) => (p < 0.001 ? "p < 0.001" : `p = ${p.toPrecision(2)}`);

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
