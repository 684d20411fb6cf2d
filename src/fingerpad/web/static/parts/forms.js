// Form controls with labels and units, and other elements that views share.

import { thumbnailOf } from "../core/api.js";
import { enter, h, newId, on, render, s } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { rules } from "../core/workspace.js";

/**
 * A labelled field around a control, with its unit and a hint.
 *
 * @param {any} label
 * @param {any} control
 * @param {{ unit?: string, hint?: any, wide?: boolean }} [options]
 */
export function field(label, control, { unit, hint, wide } = {}) {
  const id = control.id || newId();
  control.id = id;
  const hintId = hint && newId("hint");
  if (hint) control.setAttribute("aria-describedby", hintId);
  return h(wide ? "div.field.wide" : "div.field", [
    h("label", { for: id }, label),
    h("div.control", [control, unit && h("span.unit", unit)]),
    hint && h("p.hint", { id: hintId }, hint),
  ]);
}

/** A number in the unit of a field, where the cell says its own. */
function withoutUnit(cell, unit) {
  const [, words, said] = /^(.*?)\s*(mN|N|°|deg)$/i.exec(cell) ?? [];
  if (!unit || !words || /n$/i.test(said) !== (unit === "N")) return cell;
  const { value } = readNumber(words);
  return value !== null && /^mn$/i.test(said) ? String(Number((value / 1000).toPrecision(12))) : words;
}

/**
 * Fill pasted cells into a field and those below it in its table. A browser would join several lines into one
 * number.
 *
 * @param {ClipboardEvent} event
 */
function fillDown(event) {
  const input = /** @type {HTMLInputElement} */ (event.currentTarget);
  const cells = event.clipboardData
    .getData("text")
    .trim()
    .split(/\r?\n/)
    .map((cell) => cell.trim());
  const numeric = input.inputMode === "decimal";
  const values = numeric ? cells.map((cell) => withoutUnit(cell, input.dataset.unit)) : cells;
  if (numeric && values.length > 1 && !/^[-+−\d.,]/.test(values[0])) values.shift(); // a header
  if (values.length < 2 && values[0] === cells[0]) return;
  event.preventDefault();
  const column = input.closest("td")?.cellIndex;
  const rows = [...(input.closest("tbody")?.rows ?? [])];
  const below = rows
    .slice(rows.indexOf(input.closest("tr")) + 1)
    .map((row) => row.cells[column]?.querySelector("input"));
  const targets = [input, ...below.filter(Boolean)];
  const wrong = numeric && values.map((value) => readNumber(value || "–").problem).find(Boolean);
  if (wrong) {
    showError(new Error(`${wrong} Nothing was pasted.`));
    return;
  }
  if (values.length > targets.length) {
    const fields = targets.length === 1 ? "one field" : `${targets.length} fields from here down`;
    showError(new Error(`${values.length} values for ${fields}: nothing was pasted.`));
    return;
  }
  for (const [place, value] of values.entries()) {
    targets[place].value = value;
    targets[place].dispatchEvent(new Event("input", { bubbles: true }));
    targets[place].dispatchEvent(new Event("change", { bubbles: true }));
  }
}

/**
 * The number that a text states with a decimal point or comma, null of an empty one; NaN, and what is wrong,
 * if it is none or could be two.
 *
 * @param {string} words
 * @returns {{ value: number | null, problem: string }}
 */
function readNumber(words) {
  const plain = words.trim().replace("−", "-");
  if (plain === "") return { value: null, problem: "" };
  const refused = (problem) => ({ value: Number.NaN, problem: `"${words.trim()}" ${problem}` });
  const fits = (pattern) => new RegExp(`^(?:${pattern})$`).test(plain);
  if (fits(rules().ambiguous))
    return refused(`could be ${plain.replace(",", ".")} or ${plain.replace(",", "")}: write which.`);
  if (!fits(rules().number))
    return refused(
      /^[-+]?\d[\d.,'’ \u00a0\u202f]*$/.test(plain)
        ? "is not a number here: write no thousands separator, and one decimal point."
        : "is not a number.",
    );
  const value = Number(plain.replace(",", "."));
  return Number.isFinite(value) ? { value, problem: "" } : refused("is too large.");
}

/** The number in a field, null if it is empty. @param {HTMLInputElement} input */
export const numberIn = (input) => readNumber(input.value).value;

/**
 * A field for a number, with a decimal point or comma. `onset` is called once it is confirmed by Enter or by
 * leaving the field, with null if it was emptied.
 *
 * @param {{ value?: number | null, onset?: (value: number | null) => any, min?: number, above?: number,
 *   max?: number, placeholder?: string, label?: string }} options
 */
export function number({ value, onset, min, above, max, placeholder, label }) {
  const input = h("input.number", {
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    placeholder,
    value: value ?? "",
    "aria-label": label,
  });
  let last = input.value;
  const check = ({ currentTarget: input }) => {
    const { value: typed, problem } = readNumber(input.value);
    const wrong =
      typed !== null &&
      ((typed < min && `Enter ${min} or more.`) ||
        (typed <= above && `Enter more than ${above}.`) ||
        (typed > max && `Enter ${max} or less.`));
    input.setCustomValidity(problem || wrong || "");
  };
  const set = (event) => {
    const input = event.currentTarget;
    check(event);
    if (input.validity.customError && !input.reportValidity()) return;
    // It shows the number as it was understood.
    input.value = input.value.trim().replace(",", ".").replace("−", "-");
    if (input.value === last) return;
    last = input.value;
    onset?.(numberIn(input));
  };
  on(input, "input", check);
  on(input, "change", set);
  on(input, "paste", fillDown);
  on(input, "keydown", (event) => event.key === "Enter" && set(event));
  return input;
}

/** Names of a study, as the library takes them: they become names of files. */
export const namePattern = () => rules().name;

/**
 * A field for text; `pattern` is what it may be.
 *
 * @param {{ value?: string | null, onset?: (value: string, input: HTMLInputElement) => any,
 *   placeholder?: string, list?: string, required?: boolean, label?: string, pattern?: string }} options
 */
export function text({ value, onset, placeholder, list, required, label, pattern }) {
  const input = h("input", {
    type: "text",
    placeholder,
    list,
    required,
    value: value ?? "",
    spellcheck: "false",
    autocomplete: "off",
    "aria-label": label,
    pattern,
    maxlength: pattern && 60,
  });
  if (pattern) {
    const say = ({ currentTarget: input }) => {
      const wrong = input.validity.patternMismatch;
      input.title = wrong ? "Letters, digits and . _ + - only, as in left_index" : "";
    };
    on(input, "input", say);
    const take = (event) => {
      event.currentTarget.value = event.currentTarget.value.trim().replace(/\s+/g, "_");
      say(event);
      event.currentTarget.reportValidity();
    };
    on(input, "change", take);
    on(input, "keydown", (event) => event.key === "Enter" && take(event));
  }
  if (onset) on(input, "change", ({ currentTarget: input }) => onset(input.value.trim(), input));
  on(input, "paste", fillDown);
  return input;
}

/**
 * A drop-down list; `options` are values, or pairs of value and text.
 *
 * @param {{ value?: string | null, options: (string | any[])[], onset?: (value: any) => any,
 *   label?: string }} options
 */
export function choose({ value, options, onset, label }) {
  const select = h(
    "select",
    { "aria-label": label, onchange: ({ currentTarget }) => onset?.(currentTarget.value) },
    [
      options.map((option) => {
        const [key, words] = Array.isArray(option) ? option : [option, option];
        return h(
          "option",
          { key: key ?? "", value: key ?? "", selected: (key ?? "") === (value ?? "") },
          words,
        );
      }),
    ],
  );
  enter(select, "value", value ?? "");
  return select;
}

// Labelled controls, with the options of both.

/** @typedef {NonNullable<Parameters<typeof field>[2]>} Beside */

/** @type {<O>(make: (of: O) => any) => (label: any, of: O & Beside) => any} */
const labelled =
  (make) =>
  (label, { unit, hint, wide, ...of }) =>
    field(label, make(/** @type {any} */ (of)), { unit, hint, wide });

export const choiceField = labelled(choose);
export const numberField = labelled(number);
export const textField = labelled(text);

/**
 * A slider with its value; `show` sets another value.
 *
 * @param {string} label
 * @param {{ value: number, min: number, max: number, unit: string, hint?: string,
 *   onset: (value: number) => any }} options
 */
export function slider(label, { value, min, max, unit, hint, onset }) {
  const input = h("input", { type: "range", min, max, value, oninput: () => onset(Number(input.value)) });
  const root = field(label, input, { unit: `${value} ${unit}`, hint });
  root.show = (now) => {
    input.value = now;
    root.querySelector(".unit").textContent = `${now} ${unit}`;
  };
  return root;
}

/** @param {string} label @param {{ checked?: boolean, onset?: (checked: boolean) => any }} [options] */
export function check(label, { checked, onset } = {}) {
  const box = h("input", {
    type: "checkbox",
    checked,
    onchange: ({ currentTarget }) => onset?.(currentTarget.checked),
  });
  return h("label.check", [box, h("span", label)]);
}

/** Icons of tools, 20 × 20 px. */
const icons = new URL("../icons.svg", import.meta.url).href;

/** Ignore calls of an async function while it runs: by a button, and by a key too. */
export function withoutOverlap(work) {
  let busy = false;
  return async () => {
    if (busy) return;
    busy = true;
    await work().finally(() => (busy = false));
  };
}

/**
 * A group of buttons of which one is selected. Arrow keys move along it.
 *
 * @param {string} label
 * @param {[key: string, words: string, options?: { icon?: string, shortcut?: string }][]} options
 * @param {string} value
 * @param {(value: string) => any} onset
 * @param {{ vertical?: boolean }} [layout]
 */
export function segments(label, options, value, onset, { vertical = false } = {}) {
  const row = h(vertical ? "div.tools" : "div.segments", {
    role: "radiogroup",
    "aria-label": label,
    "aria-orientation": vertical ? "vertical" : "horizontal",
  });
  const buttons = options.map(([key, words, { icon, shortcut } = {}]) =>
    h(
      "button",
      {
        type: "button",
        role: "radio",
        "data-key": key,
        title: shortcut ? `${words} (${shortcut})` : words,
        "aria-label": icon ? words : undefined,
        "aria-keyshortcuts": shortcut,
        onclick: () => (show(key), onset(key)),
      },
      icon ? s("svg", { "aria-hidden": "true" }, s("use", { href: `${icons}#${icon}` })) : words,
    ),
  );
  function show(now) {
    for (const each of buttons) {
      const on = each.dataset.key === now;
      each.setAttribute("aria-checked", String(on));
      each.tabIndex = on ? 0 : -1;
    }
    if (!buttons.some((each) => each.tabIndex === 0)) buttons[0].tabIndex = 0;
  }
  row.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const at = buttons.indexOf(document.activeElement);
    const next = buttons[(at + step + buttons.length) % buttons.length];
    next.focus();
    next.click();
  });
  row.append(...buttons);
  show(value);
  row.show = show;
  return row;
}

/** What went wrong, or must not be overlooked. */
export const alarm = (words) => h("p.note.bad", { role: "alert" }, words);

/** The head of a view: its title, words below it, and what stands beside. */
export const head = (title, words, ...actions) =>
  h("header.head", [
    h("div", [h("h1", title), words && h("p", words)]),
    actions.length > 0 && h("div.actions", actions),
  ]);

/** A notice with actions, shown where there is nothing else. */
export function empty(title, words, ...actions) {
  return h("div.empty", [h("h2", title), h("p", words), actions.length > 0 && h("div.actions", actions)]);
}

/** A small picture of an item, or words of its file where there is none. @param {string} item */
export function thumbnail(item) {
  const words = `${item.split(/[/:]/).at(-1)} is missing or cannot be shown.`;
  const onerror = ({ currentTarget }) => currentTarget.replaceWith(h("span.soft", words));
  return h("img.small-thumb", { src: thumbnailOf(item), alt: "", loading: "lazy", onerror });
}

export const chip = (words, kind = "", title) => h("span", { class: `chip ${kind}`, title }, words);
export const synthetic = (yes) => yes && h("span.synthetic", "synthetic");

/** A list of items. */
export const list = (items, name = "ul") => h(name, [items.map((item) => h("li", item))]);

/** A fault by the name of its owner, if the words end with it, and without its number in the manifest. */
function faultWords({ place, words }) {
  const [, said, owner] = /^(.*) \(in ([^()]+)\)$/.exec(words) ?? [];
  if (!owner) return [h("code", place), ` ${words}`];
  return [h("strong", owner), ": ", h("code", place.replace(/^\w+\[\d+\]\.?/, "")), ` ${said}`];
}

/** List the errors of a refused edit. */
export function faultList(error) {
  return h(
    "div.faults",
    { role: "alert" },
    error.faults?.length > 0 ? list(error.faults.map(faultWords)) : h("p", error.message),
  );
}

/**
 * Do what the server may refuse, and list its errors in `place`. Return whether it was done.
 *
 * @param {Element} place
 * @param {() => Promise<any>} work
 */
export async function attempt(place, work) {
  render(place);
  try {
    await work();
    return true;
  } catch (error) {
    render(place, faultList(error));
    return false;
  }
}
