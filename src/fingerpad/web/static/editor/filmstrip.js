// A strip of thumbnails; only visible ones are created, so that thousands of frames scroll smoothly.

import { thumbnailOf } from "../core/api.js";
import { h } from "../core/dom.js";

const CELL = 100;
const BEYOND = 6;
const SETTLE_MS = 70;

export class Filmstrip {
  /** @param {{ label: string, chosen: (index: number) => void, describe: (entry: any) => any }} options */
  constructor({ label, chosen, describe }) {
    this.entries = [];
    this.cells = new Map();
    this.chosen = chosen;
    this.describe = describe;
    this.at = -1;
    this.track = h("div.track", { role: "presentation" });
    this.root = h(
      "div.filmstrip",
      { tabindex: 0, role: "listbox", "aria-label": label, "aria-orientation": "horizontal" },
      this.track,
    );
    this.root.addEventListener("scroll", () => this.#schedule(), { passive: true });
    this.root.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    this.root.addEventListener("click", (event) => {
      const cell = event.target.closest(".cell");
      if (cell) this.chosen(Number(cell.dataset.index));
    });
    this.root.addEventListener("keydown", (event) => this.#key(event));
    this.observer = new ResizeObserver(() => this.#schedule());
    this.observer.observe(this.root);
  }

  #wheel(event) {
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) return;
    event.preventDefault();
    this.root.scrollLeft += event.deltaY;
  }

  #key(event) {
    const page = Math.max(1, Math.floor(this.root.clientWidth / CELL) - 1);
    const step = {
      ArrowLeft: -1,
      ArrowRight: 1,
      PageUp: -page,
      PageDown: page,
      Home: -Infinity,
      End: Infinity,
    }[event.key];
    if (!step || event.ctrlKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.chosen(Math.max(0, Math.min(this.entries.length - 1, this.at + step)));
  }

  set(entries) {
    this.entries = entries;
    this.track.style.width = `${entries.length * CELL}px`;
    for (const cell of this.cells.values()) cell.remove();
    this.cells.clear();
    this.#draw();
  }

  /** Redraw visible thumbnails after an entry has changed. */
  refresh() {
    for (const [index, cell] of this.cells) this.#label(cell, index);
  }

  choose(index) {
    this.at = index;
    const left = index * CELL;
    const { scrollLeft, clientWidth } = this.root;
    if (left < scrollLeft + CELL || left > scrollLeft + clientWidth - 2 * CELL) {
      this.root.scrollTo({ left: left - clientWidth / 2 + CELL / 2, behavior: "instant" });
    }
    this.#draw();
    this.refresh();
  }

  #schedule() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      this.#draw();
    });
  }

  #draw() {
    const { scrollLeft, clientWidth } = this.root;
    const first = Math.max(0, Math.floor(scrollLeft / CELL) - BEYOND);
    const last = Math.min(this.entries.length - 1, Math.ceil((scrollLeft + clientWidth) / CELL) + BEYOND);
    for (const [index, cell] of this.cells) {
      if (index < first || index > last) {
        cell.remove();
        this.cells.delete(index);
      }
    }
    for (let index = first; index <= last; index += 1) {
      if (!this.cells.has(index)) {
        const cell = this.#cell(index);
        this.cells.set(index, cell);
        this.track.append(cell);
      }
    }
    clearTimeout(this.settle);
    this.settle = setTimeout(() => this.#load(), SETTLE_MS);
  }

  #cell(index) {
    const cell = h(
      "div.cell",
      {
        id: `cell-${index}`,
        role: "option",
        "data-index": index,
        "aria-setsize": this.entries.length,
        "aria-posinset": index + 1,
      },
      [h("div.thumb"), h("div.cell-label")],
    );
    cell.style.transform = `translateX(${index * CELL}px)`;
    this.#label(cell, index);
    return cell;
  }

  #label(cell, index) {
    const entry = this.entries[index];
    if (!entry) return;
    const { above, label, name, state, marks } = this.describe(entry);
    cell.setAttribute("aria-selected", String(index === this.at));
    cell.setAttribute("aria-label", name);
    cell.title = name;
    cell.dataset.state = state;
    cell.lastChild.replaceChildren(
      above ? h("span.cell-name.above", above) : "",
      h("span.cell-name", label),
      ...marks.map(([kind, title]) => h("span.dot", { "data-kind": kind, title })),
    );
    if (index === this.at) this.root.setAttribute("aria-activedescendant", cell.id);
  }

  /** Load visible thumbnails once scrolling has stopped. */
  #load() {
    const { scrollLeft, clientWidth } = this.root;
    for (const [index, cell] of this.cells) {
      const left = index * CELL;
      if (left < scrollLeft - 2 * CELL || left > scrollLeft + clientWidth + 2 * CELL) continue;
      const item = this.entries[index]?.item;
      if (!item || cell.dataset.loaded) continue;
      cell.dataset.loaded = "1";
      const image = h("img", { alt: "", loading: "lazy", decoding: "async", src: thumbnailOf(item) });
      image.onload = () => cell.classList.add("there");
      image.onerror = () => cell.classList.add("broken");
      cell.firstChild.append(image);
    }
  }

  close() {
    clearTimeout(this.settle);
    this.observer.disconnect();
  }
}
