// Choice of an image's scale: a named scale, or its own.

import { workspace } from "../core/workspace.js";
import { choose } from "./forms.js";
import { WAYS, wayOf } from "./scale_ways.js";

/**
 * @param {string | ScaleTable | null | undefined} scale
 * @param {string} [before] what stands before the scale, if there is one
 */
export function scaleWords(scale, before = "") {
  if (!scale) return "no scale";
  if (typeof scale === "string") return before + scale;
  const way = wayOf(scale);
  return way ? before + WAYS[way].summary(scale) : "own scale";
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
