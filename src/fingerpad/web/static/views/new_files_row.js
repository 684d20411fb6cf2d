// A row of the table of new files: what a file is, whose finger, and what else it needs.

import { picture } from "../core/api.js";
import { h, on } from "../core/dom.js";
import { bytes } from "../core/quantity.js";
import { button, chip, choose, NAME, number, text } from "../parts/forms.js";
import { FACES } from "../parts/missing_fields.js";
import { scaleNames } from "../parts/scale_choice.js";
import { COINS } from "../parts/scale_ways.js";
import { isNewScale, newScaleWords } from "./new_files_edits.js";

export const KINDS = {
  picture: [
    ["observation", "contact image"],
    ["photograph", "photograph"],
    ["coin", "coin, for the scale"],
    ["ruler", "ruler, for the scale"],
    ["", "something else"],
  ],
  sequence: [["sequence", "sequence"]],
  table: [
    ["curve", "loading curve"],
    ["outline", "outline of a face"],
    ["force", "force of a sequence"],
    ["sheet", "spreadsheet of files"],
    ["", "something else"],
  ],
  other: [["", "unknown"]],
};

export const base = (file) => file.split("/").at(-1);

/**
 * A row of the table of new files.
 *
 * @param {import("./new_files.js").NewFiles} files
 * @param {{ file: string, kind: string, bytes: number }} one
 */
export function fileRow(files, { file, kind, bytes: size }) {
  const draft = files.drafts.get(file);
  const put = (key) => (value) => (draft[key] = value ?? undefined);
  const name = base(file);
  const order = draft.guesses ?? [];
  const rank = ([value]) => (order.includes(value) ? order.indexOf(value) : order.length);
  const as = choose({
    value: draft.as,
    options: [...KINDS[kind]].sort((one, other) => rank(one) - rank(other)),
    label: `Type of ${name}`,
    onset: (value) => {
      Object.assign(draft, { as: value, asked: false, touched: true });
      takeFace(draft);
      files.draw();
    },
  });
  const finger = text({
    value: draft.finger,
    placeholder: "e.g. left_index",
    list: "fingers",
    pattern: NAME,
    label: `Finger on ${name}`,
    onset: put("finger"),
  });
  on(finger, "input", ({ currentTarget }) => (draft.finger = currentTarget.value.trim()));
  const face = choose({
    value: draft.face ?? "",
    options: [["", "–"], ...FACES],
    label: `Face on ${name}`,
    onset: (value) => {
      Object.assign(draft, { face: value || undefined, faceAsked: false });
      files.draw();
    },
  });
  const wedge = number({
    value: draft.wedge_angle_deg,
    min: 0,
    max: 90,
    label: `Wedge angle of ${name}, degrees`,
    onset: put("wedge_angle_deg"),
  });
  const load = number({
    value: draft.load_N,
    min: 0,
    label: `Load of ${name}, newtons`,
    onset: put("load_N"),
  });
  load.dataset.unit = "N";
  wedge.dataset.unit = "°";
  return h(
    "tr",
    { key: file },
    h(
      "td",
      kind === "picture"
        ? h("img.small-thumb", {
            src: picture("thumbnail", `file:${file}`),
            alt: "",
            loading: "lazy",
          })
        : h("span.chip", kind),
    ),
    h("td", h("strong", name), h("div.soft", about(files, file, size))),
    h("td", as, draft.asked && guessed()),
    draft.as === "coin"
      ? h("td", { colspan: 5 }, coinChoice(files, file))
      : [
          h("td", { "data-label": "Finger" }, takes(draft, "finger") && finger),
          h("td", { "data-label": "Face" }, takes(draft, "face") && [face, draft.faceAsked && guessed()]),
          h("td", { "data-label": "Wedge, °" }, takes(draft, "wedge_angle_deg") && wedge),
          h("td", { "data-label": "Load, N" }, takes(draft, "load_N") && load),
          h("td", { "data-label": "Scale" }, takes(draft, "scale") && scaleCell(files, file)),
        ],
    h(
      "td",
      button("×", () => files.forget(file), { kind: "icon", label: `Remove ${name}` }),
    ),
  );
}

/** @param {import("./new_files.js").NewFiles} files */
function about(files, file, size) {
  const info = files.info.get(file) ?? {};
  const parts = [bytes(size)];
  if (info.rows_px) parts.push(`${info.columns_px} × ${info.rows_px} px`);
  if (info.columns) parts.push(info.columns.join(", "));
  return parts.join(" · ");
}

/** The diameter of a coin, which makes it a scale. @param {import("./new_files.js").NewFiles} files */
function coinChoice(files, file) {
  const draft = files.drafts.get(file);
  const name = base(file);
  const set = (value) => {
    draft.diameter_mm = value ?? undefined;
    files.keep();
    files.draw();
  };
  const known = String(draft.diameter_mm ?? "");
  return h(
    "div.coin-choice",
    choose({
      value: COINS.some(([diameter]) => diameter === known) ? known : "",
      options: COINS.map(([diameter, words]) => [diameter, diameter ? words : "which coin?"]),
      label: `Coin on ${name}`,
      onset: (value) => value && set(Number(value)),
    }),
    h(
      "label",
      "diameter, mm",
      number({
        value: draft.diameter_mm,
        min: 1,
        max: 200,
        label: `Diameter of the coin on ${name}, mm`,
        onset: set,
      }),
    ),
  );
}

/**
 * The choice of a file's scale, and whether it is a guess.
 *
 * @param {import("./new_files.js").NewFiles} files
 */
function scaleCell(files, file) {
  const draft = files.drafts.get(file);
  const ppi = files.info.get(file)?.resolution_ppi;
  const options = [["", "– later –"], ...scaleNames().map((name) => [name, name])];
  if (ppi) options.push([`ppi:${ppi}`, `${Number(ppi.toFixed(1))} ppi, from the file`]);
  const others = [...files.drafts.values()].map(({ scale }) => scale).filter(isNewScale);
  for (const scale of new Set(others))
    if (!options.some(([value]) => value === scale)) options.push([scale, newScaleWords(scale)]);
  const select = choose({
    value: draft.scale,
    options,
    label: `Scale of ${base(file)}`,
    onset: (value) => {
      Object.assign(draft, { scale: value, scaleGuess: undefined });
      files.draw();
    },
  });
  return [select, ...(scaleAsked(draft) ? [guessed()] : [])];
}

/** Take the guessed face of a photograph whose face nothing states. */
export function takeFace(draft) {
  if (draft.as === "photograph" && !draft.face && draft.faceGuess?.face)
    Object.assign(draft, draft.faceGuess);
}

const guessed = () =>
  chip("guess: check", "warn", "The page is not sure. Choose again, or confirm when you add.");

/** Whether the scale of a draft was proposed, and is still to be confirmed. */
export const scaleAsked = (draft) =>
  takes(draft, "scale") && Boolean(draft.scale) && draft.scale === draft.scaleGuess;

/** Whether a file of its kind takes a value. */
export const takes = ({ as }, key) =>
  ({
    finger: ["observation", "photograph", "sequence", "curve", "outline"],
    face: ["photograph", "outline"],
    wedge_angle_deg: ["observation", "sequence", "curve"],
    load_N: ["observation"],
    scale: ["observation", "photograph", "sequence"],
  })[key].includes(as);
