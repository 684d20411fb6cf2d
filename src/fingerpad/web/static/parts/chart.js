// Charts by Plotly in the colours of the theme. Its script takes longer to start than all charts to draw.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";

let loading = null;

function load() {
  loading ??= new Promise((resolve, reject) => {
    const script = h("script", { src: workspace.session.plotly });
    script.onload = () => resolve(window.Plotly);
    script.onerror = () =>
      reject(new Error("The script for charts could not be loaded; see the figures of the report."));
    document.head.append(script);
  });
  return loading;
}

/** Load the script before a chart is drawn, which says so if it cannot be. */
export const prepareCharts = () => load().catch(() => {});

/** A colour of the current theme. */
export function colour(name) {
  const probe = h("span", { style: { color: `var(--${name})`, display: "none" } });
  document.body.append(probe);
  const value = getComputedStyle(probe).color;
  probe.remove();
  return value;
}

/**
 * @param {any} root
 * @param {object[]} traces
 * @param {{ x: string, y: string, shapes?: object[], annotations?: object[],
 *   chosen?: (point: { pointIndex: number }) => void, fromZero?: boolean }} options
 */
export async function chart(root, traces, { x, y, shapes = [], annotations = [], chosen, fromZero }) {
  const plotly = await load();
  // Text grows with that of the page, which is larger on the widest screens.
  const size = (12.5 / 14) * Number.parseFloat(getComputedStyle(document.documentElement).fontSize);
  const [ink, soft, line, panel] = ["ink", "soft", "line", "panel"].map(colour);
  const axis = (title, zero) => ({
    title: { text: title, standoff: 8, font: { size } },
    color: ink,
    gridcolor: line,
    linecolor: soft,
    zeroline: false,
    ticks: "outside",
    tickcolor: soft,
    automargin: true,
    rangemode: zero ? "tozero" : "normal",
  });
  const layout = {
    font: { family: getComputedStyle(document.body).fontFamily, size, color: ink },
    paper_bgcolor: panel,
    plot_bgcolor: panel,
    margin: { l: 56, r: 6 * size, t: 8, b: 44 },
    showlegend: false,
    hovermode: "closest",
    dragmode: "zoom",
    hoverlabel: { bgcolor: colour("raised"), bordercolor: soft, font: { color: ink } },
    xaxis: axis(x, true),
    yaxis: axis(y, fromZero),
    shapes,
    annotations: annotations.map((each) => ({ font: { color: ink, size }, showarrow: false, ...each })),
  };
  await plotly.react(root, traces, layout, {
    displaylogo: false,
    responsive: true,
    displayModeBar: false,
    showSendToCloud: false,
    plotlyServerURL: "",
  });
  if (chosen && !root.dataset.listener) {
    root.dataset.listener = "1";
    root.on("plotly_click", ({ points }) => chosen(points[0]));
  }
}

export const forget = (root) => window.Plotly?.purge(root);
