// Values with standard uncertainty to two digits (GUM 7.2.6), as in fingerpad.units.value_with_uncertainty.

import { h } from "./dom.js";

// Of a value at most so many significant digits are shown; its uncertainty is rounded up to the last of them.
const MOST_DIGITS = 5;
const EN = "–";
const SPACE = "\u00a0";

function decimalsOf(std) {
  const decimals = 1 - Math.floor(Math.log10(std));
  return round(std, decimals) >= 10 ** (2 - decimals) ? decimals - 1 : decimals;
}

const round = (value, decimals) => Math.round(value * 10 ** decimals) / 10 ** decimals;
const fixed = (value, decimals) => round(value, decimals).toFixed(Math.max(decimals, 0)).replace("-", "−");

/** Four significant digits; below one three decimals, and at least three digits. */
export function plain(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return EN;
  if (value !== 0 && Math.abs(value) < 1)
    return value
      .toFixed(Math.min(9, Math.max(3, 2 - Math.floor(Math.log10(Math.abs(value))))))
      .replace("-", "−");
  return String(Number(value.toPrecision(4))).replace("-", "−");
}

export function withStd(value, std) {
  if (value === null || value === undefined || !Number.isFinite(value)) return EN;
  if (!(std > 0) || !Number.isFinite(std)) return plain(value);
  const finest = value === 0 ? 99 : MOST_DIGITS - 1 - Math.floor(Math.log10(Math.abs(value)));
  if (decimalsOf(std) <= finest) {
    const decimals = decimalsOf(std);
    return `${fixed(value, decimals)}${SPACE}±${SPACE}${fixed(std, decimals)}`;
  }
  const least = Math.ceil(std * 10 ** finest) / 10 ** finest;
  return `${fixed(value, finest)}${SPACE}±${SPACE}${fixed(least, finest)}`;
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

const twoDigits = (value) => fixed(value, decimalsOf(value));

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
