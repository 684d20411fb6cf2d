// Messages in the corner, and modal questions.

import { h, render, saveFocus } from "./dom.js";

/**
 * Show a message for some seconds; errors, and messages with `stays`, stay until they are closed.
 *
 * @param {string} words
 * @param {{ kind?: string, action?: { words: string, do: () => any }, stays?: boolean }} [options]
 */
export function toast(words, { kind = "info", action, stays = kind === "error" } = {}) {
  const box = document.getElementById("messages");
  const message = h(
    `div.message.${kind}`,
    null,
    h("p", null, words),
    action &&
      h("button.link", { type: "button", onclick: () => (action.do(), message.remove()) }, action.words),
    h(
      "button.icon",
      { type: "button", "aria-label": "Close this message", onclick: () => message.remove() },
      "×",
    ),
  );
  box.append(message);
  while (box.children.length > 4) box.firstElementChild.remove();
  if (!stays) setTimeout(() => message.remove(), 4500);
  return message;
}

/** Remove all messages: they are about a study that is left. */
export const clearMessages = () => render(document.getElementById("messages"));

export const showError = (error) => error.name === "AbortError" || toast(error.message, { kind: "error" });

/** Ask a question; resolves to the button's value or null. Enter in a field presses the primary button. */
export function ask(title, body, buttons) {
  const restoreFocus = saveFocus();
  return new Promise((resolve) => {
    const dialog = h("dialog.question", {
      "aria-label": title,
      onclose: () => (dialog.remove(), restoreFocus(), resolve(dialog.returnValue || null)),
    });
    render(
      dialog,
      h("h2", null, title),
      h("div.body", null, body),
      h(
        "div.actions",
        null,
        buttons.map(([value, words, kind = ""]) =>
          h(
            "button",
            {
              class: kind,
              type: "button",
              autofocus: kind === "primary",
              onclick: () => {
                const wrong = kind === "primary" && dialog.querySelector("input:invalid");
                if (wrong) wrong.reportValidity();
                else dialog.close(value);
              },
            },
            words,
          ),
        ),
      ),
    );
    const primary = buttons.find(([, , kind]) => kind === "primary");
    dialog.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || !primary || !event.target.matches("input")) return;
      event.preventDefault();
      const wrong = dialog.querySelector("input:invalid");
      if (wrong) wrong.reportValidity();
      else dialog.close(primary[0]);
    });
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelector(".body input, .body select")?.focus();
  });
}
