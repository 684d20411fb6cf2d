// Messages in the corner, and modal questions.

import { button, h, render } from "./dom.js";

/**
 * Show a message for some seconds; errors, and messages with `stays`, stay until they are closed.
 *
 * @param {string} words
 * @param {{ kind?: string, action?: { words: string, do: () => any }, stays?: boolean }} [options]
 */
export function toast(words, { kind = "info", action, stays = kind === "error" } = {}) {
  const box = document.getElementById("messages");
  const message = h(`div.message.${kind}`, [
    h("p", words),
    action && button(action.words, () => (message.remove(), action.do()), { kind: "link" }),
    button("×", () => message.remove(), { kind: "icon", label: "Close this message" }),
  ]);
  for (const each of box.children) if (each.firstChild.textContent === words) each.remove();
  box.append(message);
  while (box.children.length > 4) box.firstElementChild.remove();
  if (!stays) setTimeout(() => message.remove(), 4500);
  return message;
}

/** Remove all messages: they are about a study that is left. */
export const clearMessages = () => render(document.getElementById("messages"));

/** The action of a message that goes to a step. */
export const goTo = (words, step) => ({ words, do: () => (location.hash = `#/${step}`) });

export const showError = (error) => error.name === "AbortError" || toast(error.message, { kind: "error" });

/**
 * Open a modal dialog. Closed, it is removed; the browser gives the focus back.
 *
 * @param {HTMLDialogElement} dialog
 */
export function openDialog(dialog) {
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/**
 * Ask whether to do something. Enter in a field presses the primary button.
 *
 * @param {string} title
 * @param {any} body
 * @param {string} yes words of the button that agrees
 * @param {{ no?: string, kind?: string }} [options]
 * @returns {Promise<boolean>}
 */
export function ask(title, body, yes, { no = "Cancel", kind = "primary" } = {}) {
  return new Promise((resolve) => {
    const agree = () => {
      const wrong = dialog.querySelector("input:invalid");
      if (wrong) wrong.reportValidity();
      else dialog.close("yes");
    };
    const dialog = h(
      "dialog.question",
      { "aria-label": title, onclose: () => resolve(dialog.returnValue === "yes") },
      [
        h("h2", title),
        h("div.body", body),
        h("div.actions", [
          button(no, () => dialog.close()),
          button(yes, agree, { kind, autofocus: kind === "primary" }),
        ]),
      ],
    );
    dialog.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || kind !== "primary" || !event.target.matches("input")) return;
      event.preventDefault();
      agree();
    });
    openDialog(dialog);
    dialog.querySelector(".body input, .body select")?.focus();
  });
}
