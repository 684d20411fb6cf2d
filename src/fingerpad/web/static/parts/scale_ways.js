// Ways to state a scale: what each needs, and the fields in which it is entered.

import { choose, field, number } from "./forms.js";

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

// ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
const KNOWN_LENGTHS = [
  ["", "a ruler, or other"],
  ["85.6", "a bank card's long side, 85.60 mm"],
  ["53.98", "a bank card's short side, 53.98 mm"],
];

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
const known = ({ table, set, redraw }, words, key, options, more = {}) =>
  field(
    words,
    choose({
      value: options.map(([size]) => size).find((size) => size === String(table[key])) ?? "",
      options,
      onset: (value) => value && (set(key)(Number(value)), redraw()),
    }),
    more,
  );

/** @param {Fields} fields */
const diameter = (fields) => [
  known(fields, "Coin type", "diameter_mm", COINS, { wide: true }),
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
  field(
    `Points ${words}`,
    number({
      value: table.points?.[place] ?? null,
      min: 3,
      onset: (value) => {
        const points = [...(table.points ?? [null, null])];
        points[place] = value === null ? null : Math.round(value);
        set("points")(points);
      },
    }),
  );

/**
 * What each way is called, the keys that it needs and may have, what it starts with (the ends of a line are
 * drawn to about one pixel), what to do with its picture, what to say while something lacks, its fields, and
 * it in short.
 *
 * @type {Record<string, {
 *   words: string, needs: string[], may: string[], defaults?: Record<string, any>, picture?: string,
 *   lacking: (table: any) => string, fields: (fields: Fields) => any[], summary: (table: any) => string }>}
 */
export const WAYS = {
  line: {
    words: "Ruler",
    needs: ["line", "length_mm"],
    may: ["length_mm_std", "ends_px_std"],
    defaults: { ends_px_std: 1 },
    picture: "Draw a line between two marks of the ruler.",
    lacking: ({ line }) => (line ? "Enter the length of the line." : "Draw a line on the ruler."),
    fields: (fields) => [
      known(fields, "Line along", "length_mm", KNOWN_LENGTHS),
      field("Length of the line", numberOf(fields, "length_mm"), { unit: "mm" }),
      uncertainty(fields, "length_mm_std", "Uncertainty", "mm"),
      uncertainty(fields, "ends_px_std", "Uncertainty of each end", "px"),
    ],
    summary: ({ length_mm }) => `line of ${length_mm} mm`,
  },
  coin: {
    words: "Coin",
    needs: ["coin", "diameter_mm"],
    may: ["diameter_mm_std"],
    picture: "The whole coin, parallel to the image plane, on a plain background.",
    lacking: () => "Select or enter the coin's diameter.",
    fields: diameter,
    summary: ({ diameter_mm }) => `coin of ${diameter_mm} mm`,
  },
  circle: {
    words: "Circle",
    needs: ["circle", "diameter_mm"],
    may: ["diameter_mm_std", "points_px_std"],
    defaults: { points_px_std: 1 },
    picture: "Click three points on the rim of a coin, far apart; drag them to move them.",
    lacking: ({ circle }) => (circle ? "Enter the diameter." : "Click three points on the rim."),
    fields: (fields) => [
      ...diameter(fields),
      uncertainty(fields, "points_px_std", "Uncertainty of each point", "px"),
    ],
    summary: ({ diameter_mm }) => `circle of ${diameter_mm} mm`,
  },
  grid: {
    words: "Grid",
    needs: ["grid", "points", "spacing_mm"],
    may: ["pattern", "spacing_mm_std"],
    defaults: { pattern: "checkerboard" },
    picture: "A flat checkerboard or grid of dots where the finger touches, on a light margin.",
    lacking: () => "Count the points of the grid, and enter their spacing.",
    fields: (fields) => [
      field(
        "Pattern",
        choose({
          value: fields.table.pattern ?? "checkerboard",
          options: [
            ["checkerboard", "checkerboard: inner corners count"],
            ["dots", "grid of dots"],
          ],
          onset: fields.set("pattern"),
        }),
        { wide: true },
      ),
      count(fields, "down", 0),
      count(fields, "along", 1),
      field("Spacing", numberOf(fields, "spacing_mm"), { unit: "mm" }),
      uncertainty(fields, "spacing_mm_std", "Uncertainty", "mm"),
    ],
    summary: ({ spacing_mm }) => `grid of ${spacing_mm} mm`,
  },
  ppi: {
    words: "ppi",
    needs: ["ppi"],
    may: ["relative_std"],
    lacking: () => "Enter the resolution.",
    fields: (fields) => [
      field("Pixels per inch", numberOf(fields, "ppi"), { unit: "ppi" }),
      relative(fields),
    ],
    summary: ({ ppi }) => `${ppi} ppi`,
  },
  mm_per_px: {
    words: "mm/px",
    needs: ["mm_per_px"],
    may: ["relative_std"],
    lacking: () => "Enter the size of a pixel.",
    fields: (fields) => [
      field("Millimetres per pixel", numberOf(fields, "mm_per_px"), { unit: "mm/px" }),
      relative(fields),
    ],
    summary: ({ mm_per_px }) => `${mm_per_px} mm/px`,
  },
};

/** The way in which a scale is stated, undefined if in none yet. */
export const wayOf = (table) => Object.keys(WAYS).find((key) => table?.[key] !== undefined);

/** A scale in short. */
export const scaleWords = (table) => WAYS[wayOf(table)]?.summary(table) ?? "incomplete";

/** The keys of a way that are filled in. */
export function definitionOf(table, way) {
  const keys = [...WAYS[way].needs, ...WAYS[way].may];
  return Object.fromEntries(keys.filter((key) => table[key] !== undefined).map((key) => [key, table[key]]));
}

/** What is still to be entered, null when the scale is complete. */
export function lackingOf(table, way) {
  const given = (value) =>
    value !== undefined && value !== "" && !(Array.isArray(value) && value.includes(null));
  return WAYS[way].needs.every((key) => given(table[key])) ? null : WAYS[way].lacking(table);
}
