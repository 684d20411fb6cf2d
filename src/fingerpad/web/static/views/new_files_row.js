// A row of the table of new files: what a file is, whose finger, and what else it needs.

import { get } from "../core/api.js";
import { button, h, on } from "../core/dom.js";
import { bytes } from "../core/quantity.js";
import { rules } from "../core/workspace.js";
import { chip, choose, namePattern, number, text, thumbnail } from "../parts/forms.js";
import { coinOptions, scaleNames } from "../parts/scale_ways.js";

export const base = (file) => file.split("/").at(-1);

/**
 * A row of the table of new files.
 *
 * @param {import("./new_files.js").NewFiles} files
 * @param {{ file: string, kind: string, bytes: number }} one
 */
export function fileRow(files, { file, kind, bytes: size }) {
  const draft = files.drafts.get(file);
  const put = (key) => (value) => (draft[key] = value);
  const name = base(file);
  const order = draft.guess?.uses ?? [];
  const rank = ([value, _words]) => (order.includes(value) ? order.indexOf(value) : order.length);
  const use = choose({
    value: draft.use,
    options: Object.entries(rules().uses[kind]).sort((one, other) => rank(one) - rank(other)),
    label: `Type of ${name}`,
    onset: (value) => {
      state(draft, "use", value);
      draft.touched = true;
      takeGuess(draft);
      files.draw();
      if (value === "sheet") files.tools.join({ file });
    },
  });
  const finger = fingerField({ value: draft.finger, label: `Finger on ${name}`, onset: put("finger") });
  on(finger, "input", ({ currentTarget }) => (draft.finger = currentTarget.value.trim()));
  const face = choose({
    value: draft.face ?? "",
    options: [["", "–"], ...rules().faces],
    label: `Face on ${name}`,
    onset: (value) => {
      state(draft, "face", value || null);
      files.draw();
    },
  });
  const quantity = (key, label, unit, max) => {
    const field = number({ value: draft[key], min: 0, max, label, onset: put(key) });
    field.dataset.unit = unit;
    return field;
  };
  const cell = (key, words, content) => h("td", { "data-label": words }, takes(draft, key) && content);
  const wedge = quantity("wedge_angle_deg", `Wedge angle of ${name}, degrees`, "°", 90);
  const load = quantity("load_N", `Load of ${name}, newtons`, "N");
  return h("tr", { key: file }, [
    h("td", [kind === "picture" ? thumbnail(`file:${file}`) : h("span.chip", kind)]),
    h("td", [h("strong", name), h("div.soft", about(files, file, size))]),
    h("td", [use, guessed(draft, "use")]),
    draft.use === "coin"
      ? h("td", { colspan: 5 }, coinChoice(files, file))
      : [
          cell("finger", "Finger", finger),
          cell("face", "Face", [face, guessed(draft, "face")]),
          cell("wedge_angle_deg", "Wedge, °", wedge),
          cell("load_N", "Load, N", load),
          cell("scale", "Scale", scaleCell(files, file)),
        ],
    h("td", [button("×", () => files.forget(file), { kind: "icon", label: `Remove ${name}` })]),
  ]);
}

/** @param {Parameters<typeof text>[0]} of */
const fingerField = (of) =>
  text({ placeholder: "e.g. left_index", list: "fingers", pattern: namePattern(), ...of });

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
  const { diameter_mm: value } = draft;
  const onset = (diameter) => {
    draft.diameter_mm = diameter;
    files.draw();
  };
  const coins = { ...coinOptions(value, "which coin?"), label: `Coin on ${name}` };
  const label = `Diameter of the coin on ${name}, mm`;
  return h("div.coin-choice", [
    choose({ ...coins, onset: (size) => size && onset(Number(size)) }),
    h("label", ["diameter, mm", number({ value, min: 1, max: 200, label, onset })]),
  ]);
}

export const COIN = "coin in ";

/** Whether a scale is none of the study yet: a number with its unit, or a coin. */
const isNewScale = (scale) => Boolean(scale) && !scaleNames().includes(scale);

/** The choice of a file's scale. @param {import("./new_files.js").NewFiles} files */
function scaleCell(files, file) {
  const draft = files.drafts.get(file);
  const stated = draft.guess?.stated ?? "";
  const others = [...files.drafts.values()].map(({ scale }) => scale);
  const unnamed = new Set([stated, ...others].filter(isNewScale));
  return [
    choose({
      value: draft.scale,
      options: [
        ["", "– later –"],
        ...scaleNames(),
        ...[...unnamed].map((scale) => [
          scale,
          (scale.startsWith(COIN) ? COIN + base(scale) : scale) + (scale === stated ? ", from the file" : ""),
        ]),
      ],
      label: `Scale of ${base(file)}`,
      onset: (value) => {
        state(draft, "scale", value);
        files.draw();
      },
    }),
    guessed(draft, "scale"),
  ];
}

/** Enter a value that may have been a guess. */
export function state(draft, key, value) {
  draft[key] = value;
  draft.guessed = draft.guessed.filter((one) => one !== key);
}

/** Take what is guessed for the use that a file has now; what is stated stays. */
export function takeGuess(draft) {
  const { guess } = draft;
  if (!guess) return;
  const take = (key, value, sure) => {
    if (draft[key] && !draft.guessed.includes(key)) return;
    state(draft, key, value);
    if (value && !sure) draft.guessed.push(key);
  };
  if (!draft.touched) {
    state(draft, "use", guess.uses[0]);
    if (!guess.sure) draft.guessed.push("use");
  }
  if (draft.use === "photograph") take("face", guess.face, guess.face_sure);
  take("scale", guess.scales[draft.use]?.scale ?? "", false);
}

/** What of a draft is a guess, among what its use takes. */
export const guessesOf = (draft) => draft.guessed.filter((key) => key === "use" || takes(draft, key));

const guessed = (draft, key) =>
  guessesOf(draft).includes(key) &&
  chip("guess: check", "warn", "The page is not sure. Choose again, or confirm when you add.");

/** Whether a file of its use takes a value. */
export const takes = ({ use }, key) => (rules().takes[use] ?? []).includes(key);

/** The fields that enter a value for all files at once. @param {import("./new_files.js").NewFiles} files */
export function allRow(files) {
  const { shared, drafts } = files;
  if (drafts.size < 2) return null;
  const every = (key, value) => {
    shared[key] = value;
    for (const draft of drafts.values()) draft[key] = value;
    files.draw();
  };
  const scaleOf = async (use, words, field) => {
    const read = words ? await get("/files/scale", { words }).catch((error) => error) : { scale: "" };
    field.setCustomValidity(read instanceof Error ? read.message : "");
    if (!field.reportValidity()) return;
    shared[`scale_${use}`] = read.scale;
    for (const draft of drafts.values()) if (draft.use === use) state(draft, "scale", read.scale);
    files.draw();
  };
  const scaleFor = (use, words, placeholder) =>
    files.files.some((file) => drafts.get(file).use === use) &&
    h("label", { key: use }, [
      `scale of ${words}`,
      text({
        value: shared[`scale_${use}`],
        placeholder,
        list: "new-scales",
        label: `Scale of all new ${words}`,
        onset: (value, field) => (files.reading = scaleOf(use, value, field)),
      }),
    ]);
  return h("div.common", [
    h("span.soft", "All files:"),
    h("label", [
      "finger",
      fingerField({
        value: shared.finger,
        label: "Finger of all new files",
        onset: (value, input) => value && input.checkValidity() && every("finger", value),
      }),
    ]),
    h("label", [
      "wedge °",
      number({
        value: shared.wedge_angle_deg,
        min: 0,
        max: 90,
        label: "Wedge angle of all new files, degrees",
        onset: (value) => every("wedge_angle_deg", value),
      }),
    ]),
    scaleFor("observation", "contact images", "e.g. 500 ppi"),
    scaleFor("photograph", "photographs", "e.g. 0.05 mm/px"),
  ]);
}
