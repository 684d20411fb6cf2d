// What a study lacks, each with the field that takes it.

import { h } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { rules, workspace } from "../core/workspace.js";
import { button, choose, number } from "./forms.js";
import { scaleChoice } from "./scale_ways.js";

/** Semi-axes of a pad, and what they are called. */
export const AXES = [
  ["palmar", "Palmar"],
  ["distal", "Distal"],
  ["radial_ulnar", "Radial–ulnar"],
];

export const SURFACES = ["ridged", "smooth"];

/** Photographs of all fingers, without outlines. @returns {Photograph[]} */
export const photographs = () =>
  workspace.study.fingers.flatMap((finger) =>
    finger.photographs
      .filter(({ outline }) => !outline)
      .map((one) => ({ ...one, finger: finger.name, synthetic: finger.synthetic || one.synthetic })),
  );

/** Limits and unit of the numbers that may be missing. */
const NUMBERS = {
  wedge_angle_deg: { max: 90, unit: "°" },
  load_N: { unit: "N" },
  length_mm: { unit: "mm" },
  diameter_mm: { unit: "mm" },
};

/** The missing entries of an item: a photograph, a contact, a sequence or a finger. */
export const missingOf = (kind, key) =>
  workspace.study.missing.filter((entry) => entry.kind === kind && entry.key === key);

/**
 * The field that takes what is missing, or a way to where it is entered.
 *
 * @param {Answers["Missing"]} entry
 */
function fieldOf({ kind, key, place, words }) {
  const { fingers, files } = workspace.study;
  const label = `${words} (${key})`;
  const set = (value) =>
    value !== null &&
    value !== "" &&
    workspace
      .edit({ kind: /** @type {Edit["kind"]} */ (kind), key, set: { [place]: value } })
      .catch(showError);
  const list = (options) =>
    choose({ value: "", options: [["", "– select –"], ...options], label, onset: set });
  if (place === "face") return list(rules().faces);
  if (place === "finger") return list(fingers.map(({ name }) => name));
  if (place === "force")
    return list(files.filter(({ kind: type }) => type === "table").map(({ file }) => file));
  if (place === "scale")
    return [
      workspace.study.scales.length > 0 && scaleChoice({ value: null, label, onset: set }),
      h("a", { href: "#/scale" }, workspace.study.scales.length ? "New scale" : "Set the scale"),
    ];
  if (place in NUMBERS) {
    const { unit, max } = NUMBERS[place];
    return h("div.control", [number({ min: 0, max, label, onset: set }), h("span.unit", unit)]);
  }
  if (kind === "scale")
    return h("a", { href: `#/scale/${encodeURIComponent(key)}` }, `Open the scale ${key}`);
  return null;
}

/** Whose entry is missing: of a photograph, whose words name the file, its finger. */
const nameOf = ({ kind, key }) => (kind === "photograph" ? key.split("/", 1)[0] : key || kind);

/**
 * A list of missing entries with their fields.
 *
 * @param {Answers["Missing"][]} entries
 * @param {{ named?: boolean, axes?: (finger: string) => void }} [options] whether each is named, and what
 *   asks for the semi-axes of a finger
 */
export function missingList(entries, { named = false, axes } = {}) {
  return h("ul.missing", [
    entries.map((entry) =>
      h("li", [
        named && h("strong", nameOf(entry)),
        h("span", entry.words),
        h("div.missing-field", [
          entry.place.startsWith("semi_axes_mm") && axes
            ? button("Enter the semi-axes", () => axes(entry.key), { kind: "small" })
            : fieldOf(entry),
        ]),
      ]),
    ),
  ]);
}
