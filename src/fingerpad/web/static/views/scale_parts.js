// Parts of the scale step: what a grid tells of a camera, and the images that have a scale.

import { post } from "../core/api.js";
import { h, small } from "../core/dom.js";
import { toast } from "../core/messages.js";
import { counted, percent } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { photographs } from "../parts/missing_fields.js";

const few = (share) => percent(share, share < 0.001 ? 2 : 1);

/** @param {NonNullable<ScaleMeasurement["grid"]>} grid */
export function gridWords(grid) {
  return h("dl.grid-words.number", [
    [
      ["Points off the plane", `${grid.residual_px.toFixed(2)} px`],
      ["Sides of a pixel differ by", few(grid.anisotropy)],
      ["Scale differs over the grid by", few(grid.variation)],
      ["Left once rectified", few(grid.unevenness)],
      ["Once rectified", grid.rectified_mm_per_px.words],
    ].map(([words, value]) => [h("dt", words), h("dd", value)]),
  ]);
}

/**
 * The button that rectifies contact images with a scale, once there are any.
 *
 * @param {string | undefined} scale its name, once it is saved
 * @param {() => Record<string, any>} definition of the grid
 * @param {(name: string) => void} done called with the name of the scale of the new pictures
 * @param {(error: any) => void} failed
 */
export function rectification(scale, definition, done, failed) {
  const images = workspace.study.observations.filter((each) => scale && each.file && each.scale === scale);
  if (!images.length) return h("p.soft", "Once contact images use this scale, they can be rectified here.");
  const rectify = async () => {
    const name = `${scale}_rectified`;
    try {
      const { files, mm_per_px, relative_std } = await post("/scale/rectify", {
        table: /** @type {any} */ (definition()),
        files: [...new Set(images.map(({ file }) => file))],
      });
      await workspace.edit(
        { kind: "scale", key: name, set: { mm_per_px, relative_std } },
        ...images.map(
          ({ item, file }) =>
            /** @type {Edit} */ ({ kind: "observation", key: item, set: { file: files[file], scale: name } }),
        ),
      );
    } catch (error) {
      failed(error);
      return;
    }
    toast(`${images.length} rectified, with the scale ${name}. The original images stay where they are.`, {
      kind: "good",
    });
    done(name);
  };
  return small(`Rectify ${counted(images.length, "contact image")}`, rectify, {
    title: "Write them as if seen straight on, and measure these instead",
  });
}

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
    return rows.some(({ kind }) => kind === wanted) && small(words, choose);
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
