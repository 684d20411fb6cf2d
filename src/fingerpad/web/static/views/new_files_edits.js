// New files: what is entered for each, and the edits that add them to the study.

import { readNumber } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { asName } from "../parts/forms.js";
import { scaleNames } from "../parts/scale_choice.js";

/** What a file may be used as, by the content that was found in it. */
export const AS_OF_CONTENT = {
  "contact image": "observation",
  photograph: "photograph",
  coin: "coin",
  ruler: "ruler",
  sequence: "sequence",
  "loading curve": "curve",
  "force table": "force",
  outline: "outline",
  "table of files": "sheet",
  other: "",
};

/** Name and values of a new file, as a proposal; empty where its name leaves them open. */
export function draftOf({ file, reading }) {
  const { fingers } = workspace.study;
  return {
    name: file
      .split("/")
      .at(-1)
      .replace(/\.[^.]+$/, ""),
    as: reading.role ?? "",
    finger: reading.finger ?? (fingers.length === 1 ? fingers[0].name : ""),
    face: reading.face ?? undefined,
    wedge_angle_deg: reading.wedge_angle_deg ?? undefined,
    load_N: reading.load_N ?? undefined,
  };
}

// A resolution without its unit is a scanner's: 300, 500, 1000.
const LEAST_PPI = 72;

/**
 * A scale as it is written, "500 ppi", "500" or "0.05 mm/px", or the name of one; undefined if it is neither.
 */
export function parseScale(words) {
  if (scaleNames().includes(words)) return words;
  const found = /^([\d.,]+)\s*(ppi|dpi|mm\/px|[uµμ]m\/px|px\/mm|)$/i.exec(words.trim());
  const value = found && readNumber(found[1]).value;
  if (!(value > 0) || (!found[2] && value < LEAST_PPI)) return undefined;
  const unit = found[2].toLowerCase() || "ppi";
  if (unit === "ppi" || unit === "dpi") return `ppi:${value}`;
  if (unit === "mm/px") return `mm:${value}`;
  return `mm:${Number((unit === "px/mm" ? 1 / value : value / 1000).toPrecision(12))}`;
}

/** A scale that no table of the study states yet, in words. */
export function newScaleWords(scale) {
  const [way, value] = scale.split(/:(.*)/s);
  if (way === "ppi") return `${Number(Number(value).toFixed(1))} ppi`;
  return way === "mm" ? `${value} mm/px` : `coin in ${value.split("/").at(-1)}`;
}

/** Where a proposed scale comes from, in words. */
export function guessedScaleWords(scale) {
  if (isNewScale(scale)) return `${newScaleWords(scale)} as its file says`;
  const why =
    workspace.study.scales.length > 1 ? "with the resolution in its file" : "the only one of the study";
  return `scale ${scale}, ${why}`;
}

export const isNewScale = (scale) => /^(ppi|mm|coin):/.test(scale ?? "");

/** Take what a spreadsheet or a name states into a draft; return what cannot be taken. */
export function takeValues(draft, values) {
  const { role, person, finger, scale, ppi, mm_per_px, ...rest } = values;
  let problem = "";
  if (role !== null) Object.assign(draft, { as: role, asked: false });
  if (person !== null) draft.person = asName(person);
  const own = finger === null ? draft.finger : asName(finger);
  draft.finger =
    person !== null && own && !own.startsWith(`${draft.person}_`) ? `${draft.person}_${own}` : own;
  if ((ppi ?? mm_per_px ?? scale) !== null) draft.scaleGuess = undefined;
  if (ppi !== null) draft.scale = `ppi:${ppi}`;
  if (mm_per_px !== null) draft.scale = `mm:${mm_per_px}`;
  if (scale !== null) {
    const name = scaleNames().find((known) => known.toLowerCase() === scale.toLowerCase());
    if (name) draft.scale = name;
    else problem = `no scale of the study is called ${scale}`;
  }
  for (const [key, value] of Object.entries(rest)) if (value !== null) draft[key] = value;
  if (values.face !== null) {
    draft.faceAsked = false;
    if (role === null && draft.as === "observation" && draft.asked)
      Object.assign(draft, { as: "photograph", asked: false });
  }
  return problem;
}

const said = (set) =>
  Object.fromEntries(Object.entries(set).filter(([, value]) => value !== undefined && value !== ""));

const isFree = (stem, taken) => {
  let name = stem;
  for (let number = 2; taken.has(name); number += 1) name = `${stem}_${number}`;
  taken.add(name);
  return name;
};

/**
 * The edits that add files to the study, and why others are not added.
 *
 * @param {string[]} files
 * @param {Map<string, any>} drafts
 * @param {{ synthetic?: boolean }} shared
 * @returns {{ edits: Edit[], added: number, waiting: string[] }}
 */
export function editsOf(files, drafts, { synthetic = false }) {
  const { study } = workspace;
  const taken = new Set([
    ...study.observations.map(({ item }) => item),
    ...study.sequences.map(({ name }) => name),
  ]);
  const fingers = new Set(study.fingers.map(({ name }) => name));
  const named = new Set(scaleNames());
  const scales = new Map();
  /** @type {Edit[]} */
  const edits = [];
  /** @type {string[]} */
  const waiting = [];
  const used = files.map((file) => drafts.get(file)).filter(({ as }) => as);
  const uses = (scale) => used.filter((draft) => draft.scale === scale).length;
  /** The name of a scale, made by an edit where several files share it; else a table. */
  const scaleOf = ({ scale }) => {
    if (!isNewScale(scale)) return scale || undefined;
    const [way, value] = scale.split(/:(.*)/s);
    const table = { ppi: () => ({ ppi: Number(value) }), mm: () => ({ mm_per_px: Number(value) }) }[way]?.();
    if (table && uses(scale) < 2) return table;
    if (!scales.has(scale)) {
      const coin = drafts.get(value);
      if (!table && !(coin?.diameter_mm > 0)) return undefined;
      const name = isFree(table ? newScaleWords(scale).replace(/[^\w.]+/g, "_") : "coin", named);
      scales.set(scale, name);
      edits.push({ kind: "scale", key: name, set: table ?? { coin: value, diameter_mm: coin.diameter_mm } });
    }
    return scales.get(scale);
  };
  const force = files.find((file) => drafts.get(file).as === "force");
  let curves = study.curves.length;
  let added = 0;
  for (const file of files) {
    const draft = drafts.get(file);
    if (["", "ruler", "force", "sheet"].includes(draft.as)) continue;
    if (draft.as === "coin") {
      if (draft.diameter_mm > 0) scaleOf({ scale: `coin:${file}` });
      continue;
    }
    if (!draft.finger) {
      waiting.push(file);
      continue;
    }
    const { finger, face, wedge_angle_deg, load_N, session } = draft;
    const own = { synthetic: synthetic || undefined };
    if (!fingers.has(finger)) {
      edits.push({ kind: "finger", key: finger, set: said({ person: draft.person }) });
      fingers.add(finger);
    }
    added += 1;
    if (draft.as === "observation")
      edits.push({
        kind: "observation",
        key: isFree(draft.name, taken),
        set: said({ finger, file, wedge_angle_deg, load_N, session, scale: scaleOf(draft), ...own }),
      });
    else if (draft.as === "photograph")
      edits.push({
        kind: "photograph",
        key: `${finger}/${file}`,
        set: said({ face, scale: scaleOf(draft), ...own }),
      });
    else if (draft.as === "outline")
      edits.push({
        kind: "photograph",
        key: `${finger}/${file}`,
        set: said({ face, outline: file, ...own }),
      });
    else if (draft.as === "sequence")
      edits.push({
        kind: "sequence",
        key: isFree(draft.name, taken),
        set: said({ finger, file, wedge_angle_deg, scale: scaleOf(draft), force, ...own }),
      });
    else if (draft.as === "curve")
      edits.push({
        kind: "curve",
        key: String(curves++),
        set: said({ finger, wedge_angle_deg, file, ...own }),
      });
  }
  const coins = [...scales.keys()].filter((scale) => scale.startsWith("coin:")).length;
  return { edits, added: added + coins, waiting };
}
