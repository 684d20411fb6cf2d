// The sidebar: the steps with their status, and switches for the whole page.

import { button, h, s, update } from "./dom.js";
import { showHelp } from "./keys.js";
import { workspace } from "./workspace.js";

const mark = new URL("../mark.svg", import.meta.url).href;

const sidebar = document.getElementById("sidebar");

/** The status of a step: text and kind. @param {string} step @returns {[words: string, kind: string]} */
function stepStatus(step) {
  const study = workspace.study;
  if (!study) return ["", ""];
  const missing = study.missing.length;
  const contacts = study.observations.filter(({ file }) => file);
  const doubtful = contacts.filter((one) => one.flags.length && !one.accepted && !one.rejected).length;
  const photographs = study.fingers.flatMap((finger) => finger.photographs);
  const { results, sequences } = study;
  const counts = [study.observations.length, sequences.length && `${sequences.length} seq.`]
    .filter(Boolean)
    .join(" + ");
  const { run } = workspace;
  const busy = run && ["running", "cancelling"].includes(run.state);
  const there = results.fresh ? ["up to date", "good"] : ["out of date", "warn"];
  /** @type {Record<string, any>} */
  const states = {
    study: missing ? [`${missing} missing`, "warn"] : ["complete", "good"],
    scale: [`${study.scales.length || "none"}`, ""],
    photographs: [photographs.length ? `${photographs.length}` : "none", ""],
    contacts: doubtful ? [`${doubtful} doubtful`, "warn"] : [counts || "0", ""],
    pad: [`${study.fingers.length || ""}`, ""],
    results: results.there ? there : results.faults.length ? ["run again", "bad"] : ["none yet", ""],
    run: busy
      ? [`${run.done} of ${run.total}`, "busy"]
      : study.counts.failed
        ? [`${study.counts.failed} failed`, "bad"]
        : ["", ""],
  };
  return states[step];
}

export function drawSidebar(open, steps) {
  const study = workspace.study;
  update(sidebar, [
    h("a.brand", { href: "#/study", "aria-label": "fingerpad, to the study" }, [
      h("img", { src: mark, alt: "", width: 26, height: 26 }),
      h("span", "fingerpad"),
    ]),
    study &&
      h("div.study-name", [
        h("span.eyebrow", "Study"),
        h("strong", { title: study.title }, study.title || study.name),
        button("Other studies", () => workspace.close(), { kind: "link" }),
      ]),
    study &&
      h("ol.steps", [
        steps.map(([key, words], index) => {
          const [wanting, kind] = stepStatus(key);
          return h("li", [
            h(
              "a",
              {
                href: `#/${key}`,
                "aria-current": key === open ? "step" : undefined,
                "aria-keyshortcuts": index + 1,
              },
              [
                h("span.step-number", { "aria-hidden": "true" }, index + 1),
                h("span.step-name", words),
                wanting && h("span.step-state", { class: `step-state ${kind}` }, wanting),
              ],
            ),
          ]);
        }),
      ]),
    h("div.grow"),
    h("div.switches", [themeSwitch(), button(["Keys", h("kbd", "?")], showHelp, { label: "Keys" })]),
    h("p.version", `fingerpad ${workspace.session?.version ?? ""} · local only`),
  ]);
  // On a small screen the steps are one row, which scrolls.
  sidebar.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" });
}

function themeSwitch() {
  const root = document.documentElement;
  const now = root.dataset.theme ?? "auto";
  const [words, next] = { auto: ["Auto", "light"], light: ["Light", "dark"], dark: ["Dark", "auto"] }[now];
  const change = () => {
    if (next === "auto") {
      delete root.dataset.theme;
      localStorage.removeItem("fingerpad.theme");
    } else {
      root.dataset.theme = next;
      localStorage.setItem("fingerpad.theme", next);
    }
    workspace.emit("theme");
  };
  const icon = s("svg", { viewBox: "0 0 16 16", width: 14, height: 14, "aria-hidden": "true" }, [
    s("circle", { cx: 8, cy: 8, r: 6.2, fill: "none", stroke: "currentColor", "stroke-width": 1.4 }),
    s("path", { d: "M8 1.8a6.2 6.2 0 0 1 0 12.4z", fill: "currentColor" }),
  ]);
  return button([icon, words], change, { label: `Theme: ${words}. Switch to ${next}` });
}
