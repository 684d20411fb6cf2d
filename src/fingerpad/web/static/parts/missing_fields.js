// What a study lacks, each with the field that takes it, and notes about what is entered.

import { h, small } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { rules, workspace } from "../core/workspace.js";
import { chip, choose, number, text } from "./forms.js";
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
function fieldOf({ kind, key, place, words, proposed }) {
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
  if (place === "force") return list(files.flatMap(({ kind: type, file }) => (type === "table" ? file : [])));
  if (place === "scale")
    return [
      workspace.study.scales.length > 0 && scaleChoice({ value: null, label, onset: set }),
      h("a", { href: "#/scale/+" }, workspace.study.scales.length ? "New scale" : "Set the scale"),
    ];
  if (place.endsWith("_columns")) {
    const onsubmit = (event) => (event.preventDefault(), set(event.currentTarget[0].value));
    return h("form.control", { onsubmit }, [text({ value: proposed, label }), h("button.small", "Use")]);
  }
  if (place in NUMBERS) {
    const { unit, max } = NUMBERS[place];
    return h("div.control", [number({ min: 0, max, label, onset: set }), h("span.unit", unit)]);
  }
  if (kind === "scale")
    return h("a", { href: `#/scale/${encodeURIComponent(key)}` }, `Open the scale ${key}`);
  return null;
}

/** Whose entry is missing: of a photograph, whose words name the file, its finger; of a curve, its file. */
const nameOf = ({ kind, key }) =>
  kind === "photograph"
    ? key.split("/", 1)[0]
    : (kind === "curve" && workspace.study.curves[key]?.file) || key || kind;

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
      h("li", { key: `${entry.kind} ${entry.key} ${entry.place}` }, [
        named && h("strong", nameOf(entry)),
        h("span", entry.words),
        h("div.missing-field", [
          entry.place.startsWith("semi_axes_mm") && axes
            ? small("Enter the semi-axes", () => axes(entry.key))
            : fieldOf(entry),
        ]),
      ]),
    ),
  ]);
}

const CHANGED = "photographs, their scale or their corrections have changed since the last run";

const isStale = ({ status, semi_axes_mm: axes }) => status === "stale" && axes !== null;

/**
 * A mark beside semi-axes of a finger, or a radius from them; nothing where they are up to date.
 *
 * @param {string | null | undefined} name
 */
export function staleChip(name, words = "of the last run, out of date") {
  const finger = workspace.study.fingers.find((each) => each.name === name);
  return finger && isStale(finger) && chip(words, "warn", `Semi-axes of ${name}: ${CHANGED}.`);
}

/** Notes about fingers whose semi-axes are out of date, or have none after the last run. */
export const axesNotes = () =>
  workspace.study.fingers
    .filter(({ status }) => status === "stale" || status === "failed")
    .map(({ name, status, reason }) =>
      h("div.note", [
        status === "failed"
          ? [h("strong", "No semi-axes in the last run: "), `${reason}.`]
          : [h("strong", `Semi-axes of ${name} are out of date. `), `Its ${CHANGED}; run the study again.`],
      ]),
    );

/** Notes about values of the manifest that look as if they were meant otherwise, as full widths. */
export const doubtNotes = (name = "div.note") => workspace.study.doubts.map((words) => h(name, words));
