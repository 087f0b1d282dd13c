// SPDX-License-Identifier: GPL-3.0-or-later
// Elements, requests and words. Texts go into the page as texts, never as markup.

export function make(kind, properties = {}, ...inside) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...inside.filter((one) => one !== null && one !== undefined));
  return made;
}

export class Refused extends Error {}

export async function ask(method, address, body, headers = {}) {
  const raw = body instanceof Blob;
  const answer = await fetch(address, {
    method, body: body === undefined ? undefined : raw ? body : JSON.stringify(body),
    headers: {...(body === undefined ? {} : {"Content-Type": raw ? "application/octet-stream" : "application/json"}), ...headers},
  });
  const told = await answer.json().catch(() => ({error: "the service gave no answer that can be read"}));
  if (!answer.ok) throw Object.assign(new Refused(told.error || answer.statusText), {status: answer.status});
  return told;
}

let alertEnds = 0;
export function alertOf(message) {
  const place = document.getElementById("alert");
  place.textContent = message;
  place.hidden = !message;
  clearTimeout(alertEnds);
  if (message) alertEnds = setTimeout(() => { place.hidden = true; }, 20000);
}

/// What an act says when it cannot be done.
export function guarded(act) {
  return async (...given) => {
    try {
      await act(...given);
    } catch (error) {
      alertOf(error instanceof Refused ? error.message : `the service cannot be reached: ${error.message}`);
    }
  };
}

export function say(text) {
  document.getElementById("said").textContent = text;
}

/// Who has the focus inside keeps it, or one that says the same has it then.
export function keepingFocus(place, change) {
  const focused = place.contains(document.activeElement) ? document.activeElement : null;
  const alike = focused && [focused.tagName, focused.textContent].join(" ");
  change();
  if (!focused || document.activeElement === focused) return;
  const same = focused.isConnected ? focused : [...place.querySelectorAll("button, a, select, summary")].find((one) => [one.tagName, one.textContent].join(" ") === alike);
  (same ?? place.querySelector("button, a"))?.focus({preventScroll: true});
}

export function timeText(seconds) {
  if (seconds < 1) return "below a second";
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${Math.floor(seconds / 3600)} h ${Math.round(seconds % 3600 / 60)} min`;
}

export function bytesText(bytes) {
  for (const [unit, size] of [["GB", 2 ** 30], ["MB", 2 ** 20], ["kB", 1024]])
    if (bytes >= size) return `${(bytes / size).toPrecision(3)} ${unit}`;
  return `${bytes} bytes`;
}

export function sizeText(mm) {
  return mm.map((one) => one.toFixed(one < 10 ? 2 : 1)).join(" × ") + " mm";
}

export function key() {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

const plain = /^[A-Za-z0-9_.,:\/=@%+-]+$/;
export function shellWord(word) {
  return plain.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}
