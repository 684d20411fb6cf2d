// An image with an overlay: zoom, pan, and tools used by pointer or keyboard. Points are [row, column] in
// pixels of the full image; pixel centres are whole numbers.

import { attributes, button, h, s } from "../core/dom.js";
import { ARROWS } from "../core/gestures.js";

const BAR_MM = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
const MARGIN = 28;

export class Stage {
  /** @param {string} label */
  constructor(label) {
    this.zoom = 1;
    this.x = this.y = 0;
    /** @type {[rows: number, columns: number] | null} */
    this.size = null;
    /** @type {string | undefined} file of the picture, where the view tells */
    this.file = undefined;
    /** @type {any} */
    this.tool = null;
    /** @type {Point | null} */
    this.cursor = null;
    this.cursorDown = false;
    this.fixed = new Set();
    this.picture = h("img.picture", { alt: "", draggable: "false" });
    this.world = s("g.world");
    this.crosshair = s("g.crosshair", { visibility: "hidden" }, [
      s("path.casing", { d: "M-14 0H14M0-14V14" }),
      s("path", { d: "M-14 0H14M0-14V14" }),
    ]);
    this.overlay = s(
      "svg.overlay",
      { "aria-hidden": "false", role: "group", "aria-label": "Overlay of the image" },
      [this.world, this.crosshair],
    );
    this.bar = h("div.scale-bar", { hidden: true }, [h("i"), h("span.number")]);
    this.where = h("span.number.where");
    this.note = h("div.stage-note", { role: "status" });
    this.root = h(
      "div.stage",
      { tabindex: 0, role: "application", "aria-roledescription": "picture", "aria-label": label },
      [this.picture, this.overlay, this.bar, h("div.hud", [this.where, this.#zoomButtons()]), this.note],
    );
    this.#pointer();
    this.root.addEventListener("keydown", (event) => this.#key(event));
    this.root.addEventListener("blur", () => this.#hideCursor());
    this.observer = new ResizeObserver(() => (this.fitted ? this.fit() : this.#draw()));
    this.observer.observe(this.root);
  }

  #zoomButtons() {
    const make = (words, label, act, kind = "") =>
      button(words, act, { kind, label, title: label, tabindex: -1 });
    this.percent = make("100 %", "Fit the image (0)", () => this.fit(), "number");
    return h("div.zoom", [
      make("−", "Zoom out (−)", () => this.zoomBy(1 / 1.4)),
      this.percent,
      make("+", "Zoom in (+)", () => this.zoomBy(1.4)),
    ]);
  }

  /** Show an image of `rows` × `columns`; the zoom is kept if the size is the same. */
  show(address, rows, columns, alt = "") {
    const same = this.size && this.size[0] === rows && this.size[1] === columns;
    this.size = [rows, columns];
    this.picture.style.width = `${columns}px`;
    this.picture.style.height = `${rows}px`;
    this.picture.alt = alt;
    this.setMessage("");
    this.root.classList.add("waiting");
    this.picture.onload = () => this.root.classList.remove("waiting");
    this.picture.onerror = () => {
      this.root.classList.remove("waiting");
      this.setMessage("This image cannot be shown.", "bad");
    };
    this.picture.src = address;
    if (!same || this.fitted !== false) this.fit();
  }

  setMessage(words, kind = "") {
    this.note.className = `stage-note ${kind}`;
    this.note.textContent = words;
  }

  /** Show the picture brighter or with more contrast; it is measured as it is. */
  setLook(brightness, contrast) {
    const plain = brightness === 100 && contrast === 100;
    this.picture.style.filter = plain ? "" : `brightness(${brightness}%) contrast(${contrast}%)`;
  }

  /** Draw a scale bar. */
  setScale(mmPerPx) {
    this.mmPerPx = mmPerPx;
    this.#draw();
  }

  fit() {
    if (!this.size) return;
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!width || !height) return;
    const [rows, columns] = this.size;
    this.zoom = Math.min((width - 2 * MARGIN) / columns, (height - 2 * MARGIN) / rows);
    this.x = (width - (columns - 1) * this.zoom) / 2;
    this.y = (height - (rows - 1) * this.zoom) / 2;
    this.fitted = true;
    this.#draw();
  }

  /** @param {number} factor @param {[number, number]} at */
  zoomBy(factor, at = [this.root.clientWidth / 2, this.root.clientHeight / 2]) {
    const zoom = Math.min(60, Math.max(0.02, this.zoom * factor));
    const nearer = 1 - zoom / this.zoom;
    this.zoom = zoom;
    this.pan((at[0] - this.x) * nearer, (at[1] - this.y) * nearer);
  }

  pan(dx, dy) {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
    this.#draw();
  }

  #draw() {
    const { zoom, x, y } = this;
    this.picture.style.transform = `matrix(${zoom},0,0,${zoom},${x - zoom / 2},${y - zoom / 2})`;
    this.picture.style.imageRendering = zoom > 3 ? "pixelated" : "auto";
    this.world.setAttribute("transform", `matrix(${zoom} 0 0 ${zoom} ${x} ${y})`);
    for (const draw of this.fixed) draw(1 / zoom);
    this.percent.textContent = `${Math.round(zoom * 100)} %`;
    this.#drawBar();
    if (this.cursor) this.#showCursor();
  }

  #drawBar() {
    const show = this.mmPerPx > 0 && this.size;
    this.bar.hidden = !show;
    if (!show) return;
    const length = BAR_MM.findLast((mm) => (mm / this.mmPerPx) * this.zoom <= 150) ?? BAR_MM[0];
    this.bar.firstChild.style.width = `${(length / this.mmPerPx) * this.zoom}px`;
    this.bar.lastChild.textContent = `${length} mm`;
  }

  /** The point under a pointer event. @param {{ clientX: number, clientY: number }} event @returns {Point} */
  pointAt(event) {
    const box = this.root.getBoundingClientRect();
    return [(event.clientY - box.top - this.y) / this.zoom, (event.clientX - box.left - this.x) / this.zoom];
  }

  /** Keep the size of a drawing on the screen: `draw` is called with 1/zoom whenever the zoom changes. */
  keepSize(draw) {
    this.fixed.add(draw);
    draw(1 / this.zoom);
    return () => this.fixed.delete(draw);
  }

  /** Set the tool: {cursor, down(point, event), move(point, down), up(point), leave()}, or null to pan. */
  use(tool) {
    this.tool?.leave?.();
    this.tool = tool;
    this.cursorDown = false;
    this.cursor = null;
    this.#hideCursor();
    this.root.dataset.cursor = tool?.cursor ?? "grab";
  }

  #pointer() {
    let mode = null;
    let last = null;
    this.root.addEventListener("pointerdown", (event) => {
      if (event.target.closest(".hud, .handle, button") || !this.size) return;
      const panning = event.button === 1 || event.ctrlKey || !this.tool?.down;
      if (event.button > 1) return;
      event.preventDefault();
      this.root.focus({ preventScroll: true });
      this.root.setPointerCapture(event.pointerId);
      mode = panning ? "pan" : "tool";
      last = [event.clientX, event.clientY];
      this.root.classList.toggle("panning", panning);
      if (!panning) this.tool.down(this.pointAt(event), event);
    });
    this.root.addEventListener("pointermove", (event) => {
      if (!this.size) return;
      const at = this.pointAt(event);
      this.#showPosition(at);
      if (mode === "pan") {
        this.pan(event.clientX - last[0], event.clientY - last[1]);
        last = [event.clientX, event.clientY];
      } else if (mode === "tool") {
        for (const each of event.getCoalescedEvents?.() ?? [event])
          this.tool?.move?.(this.pointAt(each), true);
        if (!event.getCoalescedEvents?.().length) this.tool?.move?.(at, true);
      } else this.tool?.move?.(at, false);
    });
    const end = (event) => {
      if (mode === "tool") this.tool?.up?.(this.pointAt(event));
      mode = null;
      this.root.classList.remove("panning");
    };
    this.root.addEventListener("pointerup", end);
    this.root.addEventListener("pointercancel", end);
    this.root.addEventListener("pointerleave", () => {
      this.where.textContent = "";
      if (mode === null) this.tool?.out?.();
    });
    this.root.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const box = this.root.getBoundingClientRect();
        this.zoomBy(Math.exp(-event.deltaY * 0.0016), [event.clientX - box.left, event.clientY - box.top]);
      },
      { passive: false },
    );
  }

  #showPosition([row, column]) {
    const [rows, columns] = this.size;
    const inside = row > -0.5 && column > -0.5 && row < rows - 0.5 && column < columns - 0.5;
    this.where.textContent = inside ? `row ${row.toFixed(1)} · column ${column.toFixed(1)} px` : "";
  }

  #key(event) {
    if (event.target !== this.root && !event.target.closest(".handle")) return;
    const arrow = ARROWS[event.key];
    let done = true;
    if (event.target === this.root && this.tool?.key?.(event)) done = true;
    else if (event.key === "+" || event.key === "=") this.zoomBy(1.25);
    else if (event.key === "-") this.zoomBy(0.8);
    else if (event.key === "0") this.fit();
    else if (event.target !== this.root) done = false;
    else if (arrow && this.tool?.down) this.#moveCursor(arrow, event.shiftKey);
    else if (arrow && event.shiftKey) this.pan(-60 * arrow[1], -60 * arrow[0]);
    else if (event.key === " " && this.tool?.down) this.#press();
    else done = false;
    if (done) {
      event.preventDefault();
      event.stopPropagation();
    }
  }

  #moveCursor([row, column], far) {
    const step = (far ? 24 : 4) / this.zoom;
    const inside = (at, count) => Math.min(count - 0.5, Math.max(-0.5, at));
    const [rows, columns] = this.size;
    const [at, beside] = this.cursor ?? [rows / 2, columns / 2];
    this.cursor = [inside(at + row * step, rows), inside(beside + column * step, columns)];
    this.tool.move?.(this.cursor, this.cursorDown);
    this.#showPosition(this.cursor);
    this.#showCursor();
  }

  #press() {
    this.cursor ??= [this.size[0] / 2, this.size[1] / 2];
    this.#showCursor();
    if (this.cursorDown) this.tool.up?.(this.cursor);
    else this.tool.down(this.cursor, null);
    this.cursorDown = !this.cursorDown && !this.tool.once;
    if (this.tool?.once) this.tool.up?.(this.cursor);
    this.crosshair.classList.toggle("down", this.cursorDown);
  }

  #showCursor() {
    const [row, column] = this.cursor;
    attributes(this.crosshair, {
      visibility: "visible",
      transform: `translate(${this.x + column * this.zoom} ${this.y + row * this.zoom})`,
    });
  }

  #hideCursor() {
    this.crosshair.setAttribute("visibility", "hidden");
    if (this.cursorDown && this.cursor) this.tool?.up?.(this.cursor);
    this.cursorDown = false;
    this.crosshair.classList.remove("down");
  }

  /** Show no picture. */
  hide() {
    this.picture.onload = this.picture.onerror = null;
    this.picture.removeAttribute("src");
    this.picture.alt = "";
    this.root.classList.remove("waiting");
    this.setScale(null);
  }

  close() {
    this.observer.disconnect();
    this.tool?.leave?.();
  }
}
