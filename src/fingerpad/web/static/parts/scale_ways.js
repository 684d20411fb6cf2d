// Scales: the choice of one, and the fields in which each way to state it is entered.

import { rules, workspace } from "../core/workspace.js";
import { choiceField, choose, field, number, numberField } from "./forms.js";

/** The choice of a coin by its diameter, mm. */
export const coinOptions = (diameter, none = "– other –") => sizeOptions(rules().coins, diameter, none);

/** The choice among sizes that everybody has at hand. */
const sizeOptions = (sizes, size, none) => ({
  value: String(sizes.find(({ size_mm }) => size_mm === size)?.size_mm ?? ""),
  options: [["", none], ...sizes.map(({ size_mm, words }) => [String(size_mm), words])],
});

/**
 * @typedef {object} Fields
 * @property {Record<string, any>} table the scale
 * @property {(key: string) => (value: any) => void} set
 * @property {() => void} redraw
 */

/** @param {Fields} fields */
const numberOf = ({ table, set }, key, more = {}) =>
  number({ value: table[key], min: 0, onset: set(key), ...more });

/** @param {Fields} fields */
const uncertainty = (fields, key, words, unit) =>
  field(words, numberOf(fields, key, { placeholder: "not stated" }), { unit });

/** A choice of known sizes that fills in a number. @param {Fields} fields */
const known = ({ set, redraw }, words, key, options, more = {}) =>
  field(words, choose({ ...options, onset: (value) => value && (set(key)(Number(value)), redraw()) }), more);

/** @param {Fields} fields */
const diameter = (fields) => [
  known(fields, "Coin type", "diameter_mm", coinOptions(fields.table.diameter_mm), { wide: true }),
  field("Diameter", numberOf(fields, "diameter_mm"), { unit: "mm" }),
  uncertainty(fields, "diameter_mm_std", "Uncertainty", "mm"),
];

/** @param {Fields} fields */
const relative = (fields) =>
  field("Relative uncertainty", numberOf(fields, "relative_std", { placeholder: "not stated", max: 1 }), {
    hint: "0.01 is 1 %",
  });

/** One of the two counts of a grid's points. @param {Fields} fields */
const count = ({ table, set }, words, place) =>
  numberField(`Points ${words}`, {
    value: table.points?.[place] ?? null,
    min: 3,
    onset: (value) => {
      const points = [...(table.points ?? [null, null])];
      points[place] = value === null ? null : Math.round(value);
      set("points")(points);
    },
  });

/**
 * What each way is called, what to do with its picture, what to say while something lacks, and its fields.
 *
 * @type {Record<string, { words: string, picture?: string, lacking: (table: any) => string,
 *   fields: (fields: Fields) => any[] }>}
 */
export const WAYS = {
  line: {
    words: "Ruler",
    picture: "Draw a line between two marks of the ruler.",
    lacking: ({ line }) => (line ? "Enter the length of the line." : "Draw a line on the ruler."),
    fields: (fields) => [
      known(
        fields,
        "Line along",
        "length_mm",
        sizeOptions(rules().card, fields.table.length_mm, "a ruler, or other"),
      ),
      field("Length of the line", numberOf(fields, "length_mm"), { unit: "mm" }),
      uncertainty(fields, "length_mm_std", "Uncertainty", "mm"),
      uncertainty(fields, "ends_px_std", "Uncertainty of each end", "px"),
    ],
  },
  coin: {
    words: "Coin",
    picture: "The whole coin, parallel to the image plane, on a plain background.",
    lacking: () => "Select or enter the coin's diameter.",
    fields: diameter,
  },
  circle: {
    words: "Circle",
    picture: "Click three points on the rim of a coin, far apart; drag them to move them.",
    lacking: ({ circle }) => (circle ? "Enter the diameter." : "Click three points on the rim."),
    fields: (fields) => [
      ...diameter(fields),
      uncertainty(fields, "points_px_std", "Uncertainty of each point", "px"),
    ],
  },
  grid: {
    words: "Grid",
    picture: "A flat checkerboard or grid of dots where the finger touches, on a light margin.",
    lacking: () => "Count the points of the grid, and enter their spacing.",
    fields: (fields) => [
      choiceField("Pattern", {
        value: fields.table.pattern ?? "checkerboard",
        options: [
          ["checkerboard", "checkerboard: inner corners count"],
          ["dots", "grid of dots"],
        ],
        onset: fields.set("pattern"),
        wide: true,
      }),
      count(fields, "down", 0),
      count(fields, "along", 1),
      field("Spacing", numberOf(fields, "spacing_mm"), { unit: "mm" }),
      uncertainty(fields, "spacing_mm_std", "Uncertainty", "mm"),
    ],
  },
  ppi: {
    words: "ppi",
    lacking: () => "Enter the resolution.",
    fields: (fields) => [
      field("Pixels per inch", numberOf(fields, "ppi"), { unit: "ppi" }),
      relative(fields),
    ],
  },
  mm_per_px: {
    words: "mm/px",
    lacking: () => "Enter the size of a pixel.",
    fields: (fields) => [
      field("Millimetres per pixel", numberOf(fields, "mm_per_px"), { unit: "mm/px" }),
      relative(fields),
    ],
  },
};

/** The way in which a scale is stated, undefined if in none yet. */
export const wayOf = (table) => Object.keys(WAYS).find((key) => table?.[key] !== undefined);

/** What a scale begins with. */
export const startOf = (way) => ({ ...rules().scale_ways[way].starts });

/** The keys of a way that are filled in. */
export function definitionOf(table, way) {
  const { needs, may } = rules().scale_ways[way];
  const keys = [...needs, ...may].filter((key) => table[key] !== undefined);
  return Object.fromEntries(keys.map((key) => [key, table[key]]));
}

/** What is still to be entered, null when the scale is complete. */
export function lackingOf(table, way) {
  const given = (value) =>
    value !== undefined && value !== "" && !(Array.isArray(value) && value.includes(null));
  return rules().scale_ways[way].needs.every((key) => given(table[key])) ? null : WAYS[way].lacking(table);
}

export const scaleNames = () => workspace.study?.scales.map(({ name }) => name) ?? [];

/** A drop-down list of named scales; an image's own scale, in `words`, is kept. */
export function scaleChoice({ value, words = "", onset, label = "Scale" }) {
  const own = value && typeof value === "object";
  const options = [["", "– none –"], ...scaleNames().map((name) => [name, name])];
  if (own) options.push(["\u0000own", `own: ${words}`]);
  return choose({
    value: own ? "\u0000own" : (value ?? ""),
    options,
    label,
    onset: (key) => key !== "\u0000own" && onset(key || null),
  });
}

/** Which scale an image has. @param {{ scale_words: string }} one */
export const whichScale = ({ scale_words: words }) => (words ? `scale ${words}` : "no scale");
