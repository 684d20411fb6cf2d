// Scales: the choice of one, and the fields in which each way to state it is entered.

import { rules, workspace } from "../core/workspace.js";
import { choiceField, choose, field, numberField } from "./forms.js";

/** The choice of a coin by its diameter, mm. */
export const coinOptions = (diameter, none = "– other –") => sizeOptions(rules().coins, diameter, none);

/** The choice among sizes that everybody has at hand. */
const sizeOptions = (sizes, size, none) => ({
  value: String(sizes.find(({ size_mm }) => size_mm === size)?.size_mm ?? ""),
  options: [["", none], ...sizes.map(({ size_mm, words }) => [String(size_mm), words])],
});

/** Numbers of scales: what each is called, and its unit. */
const NUMBERS = {
  length_mm: ["Length of the line", "mm"],
  length_mm_std: ["Uncertainty", "mm"],
  ends_px_std: ["Uncertainty of each end", "px"],
  diameter_mm: ["Diameter", "mm"],
  diameter_mm_std: ["Uncertainty", "mm"],
  points_px_std: ["Uncertainty of each point", "px"],
  spacing_mm: ["Spacing", "mm"],
  spacing_mm_std: ["Uncertainty", "mm"],
  ppi: ["Pixels per inch", "ppi"],
  mm_per_px: ["Millimetres per pixel", "mm/px"],
  relative_std: ["Relative uncertainty", ""],
};

/**
 * What each way is called, what to do with its picture, and what to say while something lacks.
 *
 * @type {Record<string, { words: string, picture?: string, lacking: (table: any) => string }>}
 */
export const WAYS = {
  line: {
    words: "Ruler",
    picture: "Draw a line between two marks of the ruler.",
    lacking: ({ line }) => (line ? "Enter the length of the line." : "Draw a line on the ruler."),
  },
  coin: {
    words: "Coin",
    picture: "The whole coin, parallel to the image plane, on a plain background.",
    lacking: () => "Select or enter the coin's diameter.",
  },
  circle: {
    words: "Circle",
    picture: "Click three points on the rim of a coin, far apart; drag them to move them.",
    lacking: ({ circle }) => (circle ? "Enter the diameter." : "Click three points on the rim."),
  },
  grid: {
    words: "Grid",
    picture: "A flat checkerboard or grid of dots where the finger touches, on a light margin.",
    lacking: () => "Count the points of the grid, and enter their spacing.",
  },
  ppi: { words: "ppi", lacking: () => "Enter the resolution." },
  mm_per_px: { words: "mm/px", lacking: () => "Enter the size of a pixel." },
};

const PATTERNS = [
  ["checkerboard", "checkerboard: inner corners count"],
  ["dots", "grid of dots"],
];

/**
 * The fields in which a scale is entered in one of the ways.
 *
 * @param {string} way
 * @param {{ table: Record<string, any>, set: (key: string) => (value: any) => void, redraw: () => void }} of
 */
export function scaleFields(way, { table, set, redraw }) {
  // A choice of known sizes that fills in a number.
  const known = (words, key, options, more = {}) =>
    field(
      words,
      choose({ ...options, onset: (value) => value && (set(key)(Number(value)), redraw()) }),
      more,
    );
  // One of the two counts of a grid's points.
  const count = (words, place) =>
    numberField(`Points ${words}`, {
      value: table.points?.[place] ?? null,
      min: 3,
      onset: (value) => {
        const points = [...(table.points ?? [null, null])];
        points[place] = value === null ? null : Math.round(value);
        set("points")(points);
      },
    });
  return [
    way === "line" &&
      known("Line along", "length_mm", sizeOptions(rules().card, table.length_mm, "a ruler, or other")),
    ["coin", "circle"].includes(way) &&
      known("Coin type", "diameter_mm", coinOptions(table.diameter_mm), { wide: true }),
    way === "grid" && [
      choiceField("Pattern", {
        value: table.pattern ?? "checkerboard",
        options: PATTERNS,
        onset: set("pattern"),
        wide: true,
      }),
      count("down", 0),
      count("along", 1),
    ],
    keysOf(way).map((key) => {
      if (!(key in NUMBERS)) return null;
      const [words, unit] = NUMBERS[key];
      const placeholder = key.endsWith("_std") ? "not stated" : undefined;
      const [max, hint] = key === "relative_std" ? [1, "0.01 is 1 %"] : [];
      return numberField(words, { value: table[key], min: 0, max, placeholder, onset: set(key), unit, hint });
    }),
  ];
}

/** The way in which a scale is stated, undefined if in none yet. */
export const wayOf = (table) => Object.keys(WAYS).find((key) => table?.[key] !== undefined);

/** What a scale begins with. */
export const startOf = (way) => ({ ...rules().scale_ways[way].starts });

/** The keys in which a scale is stated in one of the ways. */
const keysOf = (way) => [...rules().scale_ways[way].needs, ...rules().scale_ways[way].may];

/** The keys of a way that are filled in. */
export function definitionOf(table, way) {
  const keys = keysOf(way).filter((key) => table[key] !== undefined);
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
