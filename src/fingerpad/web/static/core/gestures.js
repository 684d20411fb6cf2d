// Pointers, keys and points, as several controls have them.

/** Rows and columns by which an arrow key moves. */
export const ARROWS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };

/** The distance of two points. @param {Point} one @param {Point} other */
export const apart = (one, other) => Math.hypot(one[0] - other[0], one[1] - other[1]);

/** A point to a hundredth of a pixel. @type {(point: Point) => Point} */
export const rounded = ([row, column]) => [Math.round(row * 100) / 100, Math.round(column * 100) / 100];

/**
 * Follow a pointer from its press on a node until it is released.
 *
 * @param {Element} node
 * @param {PointerEvent} press
 * @param {{ move: (event: PointerEvent) => void, end?: () => void }} then
 */
export function drag(node, press, { move, end }) {
  press.preventDefault();
  node.setPointerCapture(press.pointerId);
  const stop = () => {
    node.removeEventListener("pointermove", move);
    for (const kind of ["pointerup", "pointercancel"]) node.removeEventListener(kind, stop);
    end?.();
  };
  node.addEventListener("pointermove", move);
  for (const kind of ["pointerup", "pointercancel"]) node.addEventListener(kind, stop);
}
