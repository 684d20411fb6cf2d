// A dialog that draws a figure of the report for publication: width, fonts, axes, colours, and its downloads.

import { addressOf, get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { openDialog, showError } from "../core/messages.js";
import { button, choiceField, choose, field, numberField } from "./forms.js";

const WIDTHS = [
  ["", "as in the report"],
  ["89", "89 mm, one column (Nature)"],
  ["183", "183 mm, two columns (Nature)"],
  ["90", "90 mm, one column (Elsevier)"],
  ["140", "140 mm, one and a half (Elsevier)"],
  ["190", "190 mm, two columns (Elsevier)"],
];
const SCALES = [["", "as it is"], "linear", ["log", "logarithmic"]];
const FORMATS = ["svg", "pdf", "png", "csv"];
const PAUSE_MS = 250;

/** Open the dialog for a figure. @param {Answers["FigureEntry"]} figure */
async function openFigureSettings({ name, caption }) {
  const details = await get("/results/figure", { name });
  /** @type {Record<string, any>} */
  const settings = { colours: [...details.colours] };
  const preview = h("img.preview", { alt: caption || name.replaceAll("_", " ") });
  const refusal = h("p.note.bad", { role: "alert", hidden: true });
  const links = h("div.actions");
  let timer;
  let newest = 0;

  const address = (kind, more = {}) => {
    const changed = settings.colours.some((colour, place) => colour !== details.colours[place]);
    const colours = changed ? settings.colours.join(",") : null;
    return addressOf("/results/figure/file", { ...settings, ...more, name, kind, colours });
  };
  const draw = async () => {
    const mine = ++newest;
    preview.setAttribute("aria-busy", "true");
    const answer = await fetch(address("svg"));
    const words = answer.ok ? "" : (await answer.json()).error;
    const drawing = answer.ok ? await answer.blob() : null;
    if (mine !== newest) return;
    preview.removeAttribute("aria-busy");
    refusal.hidden = answer.ok;
    refusal.textContent = words;
    if (drawing) {
      URL.revokeObjectURL(preview.src);
      preview.src = URL.createObjectURL(drawing);
    }
    render(links, [
      answer.ok &&
        FORMATS.map((kind) =>
          h("a.button", { href: address(kind, { attachment: true }), download: "" }, kind.toUpperCase()),
        ),
    ]);
  };
  const set = (key) => (value) => {
    settings[key] = value;
    clearTimeout(timer);
    timer = setTimeout(draw, PAUSE_MS);
  };
  const length = (label, key, value) =>
    numberField(label, {
      placeholder: String(Math.round(value)),
      min: 20,
      max: 500,
      onset: set(key),
      unit: "mm",
    });
  const width = length("Width", "width_mm", details.width_mm);
  const column = choose({
    value: "",
    options: WIDTHS,
    onset: (value) => {
      width.querySelector("input").value = value;
      set("width_mm")(value);
    },
  });
  const axis = ({ axis, name: words }) =>
    h("fieldset", [
      h("legend", words),
      numberField("From", { placeholder: "data", onset: set(`${axis}_low`) }),
      numberField("To", { placeholder: "data", onset: set(`${axis}_high`) }),
      choiceField("Scale", { value: "", options: SCALES, onset: set(`${axis}_scale`) }),
    ]);
  const swatch = (colour, place) =>
    h("input", {
      type: "color",
      value: colour,
      "aria-label": `Colour ${place + 1}`,
      onchange: (event) => {
        settings.colours[place] = event.target.value;
        set("colours")(settings.colours);
      },
    });
  const dialog = h(
    "dialog.figure-settings",
    { "aria-label": `Figure ${name}`, onclose: () => URL.revokeObjectURL(preview.src) },
    [
      h("header", [h("h2", name.replaceAll("_", " ")), button("Close", () => dialog.close())]),
      h("div.figure-panel", [
        h("div.figure-preview", [preview, refusal]),
        h("div.fields", [
          field("Journal", column),
          width,
          length("Height", "height_mm", details.height_mm),
          numberField("Font", { placeholder: "7.5", min: 3, max: 30, onset: set("font_pt"), unit: "pt" }),
          details.axes.filter(({ settable, name: words }) => settable && words).map(axis),
          details.colours.length > 0 &&
            h("fieldset", [h("legend", "Colours"), h("div.swatches", details.colours.map(swatch))]),
          numberField("Resolution of PNG", {
            placeholder: "300",
            min: 50,
            max: 1200,
            onset: set("dpi"),
            unit: "dpi",
          }),
          links,
        ]),
      ]),
    ],
  );
  openDialog(dialog);
  await draw();
}

/**
 * The button that opens the dialog for a figure, if the last run drew it so that it can be set.
 *
 * @param {Answers["FigureEntry"] | undefined} figure
 * @param {string} [kind] of the button
 */
export const figureButton = (figure, kind = "small") =>
  figure?.settable &&
  button("Figure…", () => openFigureSettings(figure).catch(showError), {
    kind,
    label: `Size, axes and colours of ${figure.name}`,
  });
