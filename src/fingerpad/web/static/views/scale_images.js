// The images that have a scale, chosen from all of a study.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { button } from "../parts/forms.js";
import { photographs } from "../parts/missing_fields.js";

/** @typedef {{ kind: Edit["kind"], key: string, words: string, scale: any }} Image */

/** Photographs, contact images and sequences of the study. @returns {Image[]} */
const images = () => [
  ...photographs().map(({ item: key, finger, face, scale }) => ({
    kind: /** @type {const} */ ("photograph"),
    key,
    words: `${finger}, ${face ?? "?"} face`,
    scale,
  })),
  ...workspace.study.observations
    .filter(({ file }) => file)
    .map(({ item: key, scale }) => ({ kind: /** @type {const} */ ("observation"), key, words: key, scale })),
  ...workspace.study.sequences.map(({ name: key, scale }) => ({
    kind: /** @type {const} */ ("sequence"),
    key,
    words: `sequence ${key}`,
    scale,
  })),
];

/**
 * Boxes to choose images, and the edits that give all chosen ones a scale by its name.
 *
 * @param {string | undefined} scale its name, once it is saved
 * @returns {{ parts: any[], edits: (name: string) => Edit[] }}
 */
export function scaleImages(scale) {
  const all = images();
  // Photographs and contact images rarely share a camera: select the first kind that lacks a scale.
  const lacking = all.find((one) => !one.scale)?.kind;
  const rows = all.map((one) => {
    const mine = scale && one.scale === scale;
    const checked = mine || (!scale && !one.scale && one.kind === lacking);
    const box = h("input", { type: "checkbox", checked });
    const other = typeof one.scale === "string" ? one.scale : "own scale";
    const now = mine ? "" : one.scale ? other : "none yet";
    const row = h("label.check", { "data-kind": one.kind }, [box, h("span", one.words), h("span.soft", now)]);
    return { ...one, box, row };
  });
  const only = (words, wanted) => {
    const choose = () => {
      for (const { box, kind } of rows) box.checked = kind === wanted;
    };
    return rows.some(({ kind }) => kind === wanted) && button(words, choose, { kind: "small" });
  };
  const boxes = { tabindex: 0, role: "group", "aria-label": "Images with this scale" };
  return {
    parts: [
      h("h3", "Images with this scale"),
      rows.length
        ? h("div.takers", boxes, [rows.map(({ row }) => row)])
        : h("p.soft", "No images yet; choose this scale when you add them."),
      h("div.actions", [only("Only photographs", "photograph"), only("Only contact images", "observation")]),
    ],
    edits: (name) =>
      rows
        .filter((one) => one.box.checked && one.scale !== name)
        .map(({ kind, key }) => ({ kind, key, set: { scale: name } })),
  };
}
