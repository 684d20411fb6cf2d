// A handle on an image, moved by pointer or by arrow keys.

import { s } from "../core/dom.js";
import { ARROWS, drag } from "../core/gestures.js";

/**
 * A point that can be dragged, or moved by arrow keys while it has the focus (with Shift ten times as far,
 * with Alt a fifth), which a drag gives back to the image. `step` replaces the move of an arrow key; `commit`
 * is called at the end of a move.
 *
 * @param {import("./stage.js").Stage} stage
 * @param {{ label: string, kind?: string, move: (point: Point) => void, commit?: () => void,
 *   step?: (arrow: Point, size: number) => void, remove?: () => void }} options
 */
export function handle(stage, { label, kind = "", move, commit, step, remove }) {
  const node = s(
    `g.handle.${kind || "point"}`,
    { tabindex: 0, role: "button", "aria-label": label, "aria-roledescription": "handle" },
    [s("circle.reach", { r: 13 }), shapeOf(kind), s("title", label)],
  );
  /** @type {Point} */
  let at = [0, 0];
  const draw = (scale) => node.setAttribute("transform", `translate(${at[1]} ${at[0]}) scale(${scale})`);
  const forget = stage.keepSize(draw);
  let timer = null;
  const confirm = () => {
    if (timer === null) return;
    clearTimeout(timer);
    timer = null;
    commit?.();
  };
  node.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    event.stopPropagation();
    node.focus({ preventScroll: true });
    node.classList.add("held");
    const begin = stage.pointAt(event);
    const offset = [at[0] - begin[0], at[1] - begin[1]];
    let moved = false;
    drag(node, event, {
      move: (now) => {
        const point = stage.pointAt(now);
        moved = true;
        move([point[0] + offset[0], point[1] + offset[1]]);
      },
      end: () => {
        node.classList.remove("held");
        if (!moved) return;
        commit?.();
        // Arrow keys go to the next image again.
        stage.root.focus({ preventScroll: true });
      },
    });
  });
  node.addEventListener("keydown", (event) => {
    const arrow = ARROWS[event.key];
    if (arrow && !event.ctrlKey) {
      const size = event.shiftKey ? 10 : event.altKey ? 0.2 : 1;
      if (step) step(arrow, size);
      else move([at[0] + arrow[0] * size, at[1] + arrow[1] * size]);
      clearTimeout(timer);
      timer = setTimeout(confirm, 450);
    } else if ((event.key === "Delete" || event.key === "Backspace") && remove) remove();
    else {
      // Another key may trigger an action: commit the move first.
      if (!["Shift", "Alt"].includes(event.key)) confirm();
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  });
  node.addEventListener("blur", confirm);
  return {
    node,
    put(point) {
      at = point;
      draw(1 / stage.zoom);
    },
    remove() {
      forget();
      node.remove();
    },
  };
}

function shapeOf(kind) {
  if (kind === "axis") return s("rect.knob", { x: -5, y: -5, width: 10, height: 10, rx: 1.5 });
  if (kind === "turn")
    return s("g", [
      s("circle.knob", { r: 6.5 }),
      s("path.sign", { d: "M-3 1.2A3.1 3.1 0 1 1 1 3M-3.9-1.6-3 1.3-.2.4" }),
    ]);
  if (kind === "centre")
    return s("g", [s("circle.knob", { r: 5.5 }), s("path.sign", { d: "M-3 0H3M0-3V3" })]);
  return s("circle.knob", { r: 5 });
}
