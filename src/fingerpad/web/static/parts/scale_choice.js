// Choice of an image's scale: a named scale, or its own.

import { workspace } from "../core/workspace.js";
import { choose } from "./forms.js";

/** Diameters of coins, mm. */
export const COINS = [
  ["", "– other –"],
  ["16.25", "1 euro cent, 16.25 mm"],
  ["18.75", "2 euro cent, 18.75 mm"],
  ["21.25", "5 euro cent, 21.25 mm"],
  ["19.75", "10 euro cent, 19.75 mm"],
  ["22.25", "20 euro cent, 22.25 mm"],
  ["24.25", "50 euro cent, 24.25 mm"],
  ["23.25", "1 euro, 23.25 mm"],
  ["25.75", "2 euro, 25.75 mm"],
  ["24.26", "US quarter, 24.26 mm"],
  ["20.3", "UK penny, 20.3 mm"],
];

/**
 * @param {string | ScaleTable | null | undefined} scale
 * @param {string} [before] what stands before the scale, if there is one
 */
export function scaleWords(scale, before = "") {
  if (!scale) return "no scale";
  if (typeof scale === "string") return before + scale;
  if (scale.ppi !== undefined) return `${before}${scale.ppi} ppi`;
  if (scale.mm_per_px !== undefined) return `${before}${scale.mm_per_px} mm/px`;
  if (scale.line) return `${before}line of ${scale.length_mm} mm`;
  if (scale.circle) return `${before}circle of ${scale.diameter_mm} mm`;
  if (scale.grid) return `${before}grid of ${scale.spacing_mm} mm`;
  return scale.coin ? `${before}coin of ${scale.diameter_mm} mm` : "own scale";
}

export const scaleNames = () => workspace.study?.scales.map(({ name }) => name) ?? [];

/** A drop-down list of named scales; an image's own scale is kept. */
export function scaleChoice({ value, onset, label = "Scale" }) {
  const own = value && typeof value === "object";
  const options = [["", "– none –"], ...scaleNames().map((name) => [name, name])];
  if (own) options.push(["\u0000own", `own: ${scaleWords(value)}`]);
  return choose({
    value: own ? "\u0000own" : (value ?? ""),
    options,
    label,
    onset: (key) => key !== "\u0000own" && onset(key || null),
  });
}
