// A dialog that draws a figure of the report for publication: width, fonts, axes, colours, and its downloads.

import { addressOf, get, LatestRequest } from "../core/api.js";
import { button, h, render } from "../core/dom.js";
import { openDialog, showError } from "../core/messages.js";
import { choiceField, choose, field, numberField } from "./forms.js";

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

/** Open the dialog for a figure. @param {Answers["FigureEntry"]} figure */
async function openFigureSettings({ name, caption }) {
  const details = await get("/results/figure", { name });
  /** @type {Record<string, any>} */
  const settings = { colours: [...details.colours] };
  const preview = h("img.preview", { alt: caption });
  const refusal = h("p.note.bad", { role: "alert", hidden: true });
  const links = h("div.actions");

  const address = (kind, more = {}) => {
    const changed = settings.colours.some((colour, place) => colour !== details.colours[place]);
    const colours = changed ? settings.colours.join(",") : null;
    return addressOf("/results/figure/file", { ...settings, ...more, name, kind, colours });
  };
  const show = ({ drawing, error }) => {
    refusal.hidden = Boolean(drawing);
    refusal.textContent = error ?? "";
    if (drawing) {
      URL.revokeObjectURL(preview.src);
      preview.src = URL.createObjectURL(drawing);
    }
    const link = (kind) =>
      h("a.button", { href: address(kind, { attachment: true }), download: "" }, kind.toUpperCase());
    render(links, drawing && FORMATS.map(link));
  };
  const draw = async (svg) => {
    const answer = await fetch(svg);
    return answer.ok ? { drawing: await answer.blob() } : answer.json();
  };
  const drawings = new LatestRequest(draw, show, showError, preview);
  const set = (key) => (value) => {
    settings[key] = value;
    drawings.request(address("svg"));
  };
  const size = (label, key, unit, now, [min, max]) =>
    numberField(label, { placeholder: String(now), min, max, onset: set(key), unit });
  const [wide, high] = [details.width_mm, details.height_mm].map(Math.round);
  const width = size("Width", "width_mm", "mm", wide, [20, 500]);
  const column = choose({
    value: "",
    options: WIDTHS,
    onset: (value) => {
      width.querySelector("input").value = value;
      set("width_mm")(value);
    },
  });
  const axis = ([axis, words]) =>
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
          size("Height", "height_mm", "mm", high, [20, 500]),
          size("Font", "font_pt", "pt", 7.5, [3, 30]),
          Object.entries(details.axes).map(axis),
          details.colours.length > 0 &&
            h("fieldset", [h("legend", "Colours"), h("div.swatches", details.colours.map(swatch))]),
          size("Resolution of PNG", "dpi", "dpi", 300, [50, 1200]),
          links,
        ]),
      ]),
    ],
  );
  openDialog(dialog);
  drawings.request(address("svg"));
}

/** The button that opens the dialog for a figure, if any. @param {Answers["FigureEntry"]} [figure] */
export const figureButton = (figure, kind = "small") =>
  figure &&
  button("Figure…", () => openFigureSettings(figure).catch(showError), {
    kind,
    label: `Size, axes and colours of ${figure.name}`,
  });
