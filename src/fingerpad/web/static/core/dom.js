// HTML and SVG elements; strings become text, never markup.

const SVG = "http://www.w3.org/2000/svg";

/** What is shown of a child, or of lists of them. */
const shown = (children) =>
  [children].flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false);

/** Properties that the user changes too: what was set last is remembered. */
const ENTERED = ["value", "checked"];

// The field whose text was typed and is not confirmed yet.
let typed = null;
document.addEventListener("input", ({ target }) => (typed = target), true);
document.addEventListener("change", () => (typed = null), true);
document.addEventListener("keydown", ({ key }) => key === "Enter" && (typed = null), true);

function hear(event) {
  for (const act of this.heard[event.type] ?? []) act.call(this, event);
}

/** Call `act` on an event, with its element as `currentTarget`: `update` hands it to the one that is kept. */
export function on(node, kind, act) {
  node.heard ??= {};
  if (!node.heard[kind]) node.addEventListener(kind, hear);
  node.heard[kind] = [...(node.heard[kind] ?? []), act];
}

/** Set a property that the user may change. */
export function enter(node, key, value) {
  node.entered = { ...node.entered, [key]: value };
  node[key] = value;
}

function fill(node, ...given) {
  const [properties, children] = given[0]?.constructor === Object ? given : [{}, given[0]];
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (key === "checked") enter(node, key, value);
    else if (value === false) continue;
    else if (key.startsWith("on")) on(node, key.slice(2), value);
    else if (key === "style") Object.assign(node.style, value);
    else if (key === "key") node.key = value;
    else if (key === "value") enter(node, key, value);
    else if (key === "selected" || key === "disabled") node[key] = value;
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...shown(children));
  return node;
}

/**
 * Make an HTML element: h("p.soft", { title: "…" }, "text"), h("p", "text"), or h("ul", [first, second]).
 *
 * @param {string} name
 * @param {any} [properties] if there are any
 * @param {any} [children] one, or a list
 * @returns {any}
 */
export function h(name, properties, children) {
  const [tag, ...classes] = name.split(".");
  const node = document.createElement(tag || "div");
  if (classes.length) node.className = classes.join(" ");
  return fill(node, properties, children);
}

/** Make an SVG element. @type {typeof h} */
export function s(name, properties, children) {
  const [tag, ...classes] = name.split(".");
  const node = document.createElementNS(SVG, tag);
  if (classes.length) node.setAttribute("class", classes.join(" "));
  return fill(node, properties, children);
}

/** Put children, or nothing, in place of the content of an element. */
export function render(node, children = []) {
  node.replaceChildren(...shown(children));
  return node;
}

/**
 * Make the content of an element equal to `children`, and keep the nodes that are there: those with the same
 * `key`, else the next of the same kind. So the focus, what is being typed, and what is folded open stay;
 * nothing stays of content that was about something else, as by the key of what it is `about`.
 */
export function update(node, children, about = undefined) {
  if (node.about !== about) node.replaceChildren();
  node.about = about;
  /** @type {any[]} */
  const wanted = shown(children).map((child) =>
    child instanceof Node ? child : document.createTextNode(String(child)),
  );
  const left = new Set([...node.childNodes].filter((old) => !wanted.includes(old)));
  const kept = wanted.map((child) => {
    const old =
      child.parentNode !== node &&
      [...left].find((/** @type {any} */ one) => one.nodeName === child.nodeName && one.key === child.key);
    if (!old) return child;
    left.delete(old);
    patch(old, child);
    return old;
  });
  for (const old of left) old.remove();
  let next = node.firstChild;
  for (const child of kept) {
    if (child === next) next = next.nextSibling;
    else node.insertBefore(child, next);
  }
  return node;
}

/** Make a node equal to another of its kind. @param {any} old @param {any} now */
function patch(old, now) {
  if (old.nodeType !== Node.ELEMENT_NODE) {
    if (old.data !== now.data) old.data = now.data;
    return;
  }
  for (const { name } of [...old.attributes])
    if (!now.hasAttribute(name) && name !== "open") old.removeAttribute(name);
  for (const { name, value } of now.attributes)
    if (old.getAttribute(name) !== value && name !== "open") old.setAttribute(name, value);
  for (const kind of Object.keys(now.heard ?? {})) if (!old.heard?.[kind]) old.addEventListener(kind, hear);
  old.heard = { ...now.heard };
  update(old, [...now.childNodes]);
  if ("disabled" in now) old.disabled = now.disabled;
  for (const key of ENTERED) {
    const [before, after] = [old.entered?.[key], now.entered?.[key]];
    const isTyped = key === "value" && typed === old && old === document.activeElement;
    // A choice is another one where its answer was not waited for; text stays while it is corrected.
    const isChoice = key === "checked" || old.nodeName === "SELECT";
    const isOther = isChoice && after !== undefined && old[key] !== after;
    if ((before !== after || isOther) && !isTyped) {
      old[key] = after ?? (key === "value" ? "" : false);
      old.setCustomValidity?.("");
    }
  }
  old.entered = now.entered;
}

/** Show in all fields what was set last, in place of what was refused. */
export function reset(root) {
  for (const node of root.querySelectorAll("input, select")) Object.assign(node, node.entered);
}

/** Set attributes of an SVG element. */
export function attributes(node, values) {
  for (const [key, value] of Object.entries(values)) node.setAttribute(key, value);
}

/** Points [row, column] as an SVG path. */
export function pathOf(points, closed = true) {
  if (!points?.length) return "";
  let text = "M";
  for (const [row, column] of points) text += `${column} ${row} `;
  return closed ? `${text}Z` : text;
}

/** Points [row, column] as one path of dots: a stroke without length that has round ends is one. */
export const dotsOf = (points) => (points ?? []).map(([row, column]) => `M${column} ${row}h.01`).join("");

/** Buttons that are busy, and whether a click of the present double click has started what takes a while. */
const busy = new WeakSet();
let started = false;

/**
 * A button. A double click begins what takes a while once, whatever stands there by its second click; and the
 * button begins nothing again before that has ended.
 *
 * @param {any} words
 * @param {(event: any) => any} onclick returns a promise if it takes a while
 * @param {{ kind?: string, key?: string, title?: string, label?: string } & Record<string, any>} [options]
 *   and attributes
 */
export function button(words, onclick, { kind = "", key, label, ...attributes } = {}) {
  const press = (event) => {
    const node = event.currentTarget;
    if (event.detail !== 2) started = false; // who clicks on and on means each click
    if (started || busy.has(node)) return;
    const work = onclick(event);
    if (!(work instanceof Promise)) return;
    started = true;
    busy.add(node);
    work.finally(() => busy.delete(node));
  };
  return h(
    "button",
    {
      type: "button",
      class: kind,
      onclick: press,
      "aria-label": label,
      "aria-keyshortcuts": key,
      ...attributes,
    },
    [words, key && h("kbd", { "aria-hidden": "true" }, key)],
  );
}

/** A small button. @type {typeof button} */
export const small = (words, onclick, options) => button(words, onclick, { kind: "small", ...options });

let count = 0;
export const newId = (stem = "f") => `${stem}${(count += 1)}`;
