// HTML and SVG elements; strings become text, never markup.

const SVG = "http://www.w3.org/2000/svg";

const shown = (children) =>
  children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false);

function fill(node, parts) {
  const [properties, ...children] = parts[0]?.constructor === Object ? parts : [{}, ...parts];
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "style") Object.assign(node.style, value);
    else if (key === "value" || key === "checked" || key === "selected" || key === "disabled")
      node[key] = value;
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...shown(children));
  return node;
}

/**
 * Make an HTML element: h("p.soft", { title: "…" }, "text", child), or h("p", "text").
 *
 * @param {string} name
 * @param {...any} parts properties, if there are any, and children
 * @returns {any}
 */
export function h(name, ...parts) {
  const [tag, ...classes] = name.split(".");
  const node = document.createElement(tag || "div");
  if (classes.length) node.className = classes.join(" ");
  return fill(node, parts);
}

/**
 * Make an SVG element.
 *
 * @param {string} name
 * @param {...any} parts properties, if there are any, and children
 * @returns {any}
 */
export function s(name, ...parts) {
  const [tag, ...classes] = name.split(".");
  const node = document.createElementNS(SVG, tag);
  if (classes.length) node.setAttribute("class", classes.join(" "));
  return fill(node, parts);
}

export function render(node, ...children) {
  node.replaceChildren(...shown(children));
  return node;
}

const nameOf = (node) => node.getAttribute("aria-label") ?? node.labels?.[0]?.textContent ?? node.textContent;

/**
 * Save the focus; the function returned restores it, to the element of the same name if all were redrawn.
 */
export function saveFocus() {
  const before = /** @type {HTMLInputElement} */ (document.activeElement);
  const name = nameOf(before);
  const alike = () =>
    /** @type {HTMLInputElement[]} */ ([...document.querySelectorAll(before.tagName)]).filter(
      (node) => nameOf(node) === name,
    );
  const at = alike().indexOf(before);
  return () => {
    if (before.isConnected) {
      // Put in its place again, it has lost the focus.
      if (document.activeElement === document.body) before.focus({ preventScroll: true });
      return;
    }
    const now = alike()[at];
    now?.focus({ preventScroll: true });
    now?.select?.();
  };
}

/** Redraw and keep the focus. */
export function redraw(draw) {
  const restoreFocus = saveFocus();
  draw();
  restoreFocus();
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

let count = 0;
export const newId = (stem = "f") => `${stem}${(count += 1)}`;
