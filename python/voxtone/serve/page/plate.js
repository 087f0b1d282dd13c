// SPDX-License-Identifier: GPL-3.0-or-later
// A tray from above: boxes of the parts, dragged, turned, copied, locked. What overlaps is red.
import {make} from "./tools.js";

const gap = 2;
const svgOf = (kind, attributes = {}) => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
};

const turn = "z90";
const ownOptions = ["size", "scale", "unit", "width", "thickness", "rotate"];

function said(part) {
  const words = part.rotate ? part.rotate.split(",") : [];
  const turned = words.at(-1) === turn;
  return {turned, rotate: (turned ? words.slice(0, -1) : words).join(",")};
}

/// Up to a tenth of a millimetre, but for what rounding adds.
function tenths(mm) {
  return Math.ceil(10 * mm - 0.001) / 10;
}

/// What the parts of a tray have of their own, which the form says of all.
export function ownOf(part) {
  const {rotate} = said(part);
  const own = Object.fromEntries(Object.entries(part).filter(([name]) => ownOptions.includes(name) && name !== "rotate"));
  return rotate ? {...own, rotate} : own;
}

export class Plate {
  /// `parts`: of a tray that is changed, which lie as they lay.
  constructor(group, printers, parts = null) {
    this.group = group;
    this.printers = printers;
    this.svg = svgOf("svg", {class: "plate", role: "group", "aria-label": "the tray from above"});
    this.told = make("p", {className: "soft", role: "status"});
    this.rows = make("ul", {className: "models"});
    this.element = make("div", {}, make("p", {}, "Drag parts; arrow keys move the chosen one by 1 mm, with Shift by 10, R turns it, L locks it, Delete takes it away."),
      make("div", {className: "acts"}, make("button", {type: "button", onclick: () => { this.byHand = false; this.arrange(); this.draw(); }}, "arrange"),
        ...group.models.map((model) => make("button", {type: "button", onclick: () => { this.add(model); this.arrange(); this.draw(); }}, `one more ${model.name}`))),
      this.svg, this.told);
    this.byHand = Boolean(parts);  // then it is not arranged anew where an estimate comes
    this.places = parts ? parts.flatMap((part) => this.placesOf(part)) : group.models.map((model) => this.place(model));
    if (!parts) this.arrange();
    this.draw();
  }

  place(model) {
    return {model, x: 0, y: 0, turned: false, locked: false};
  }

  placesOf(part) {
    const model = this.group.models.find((one) => one.name === part.model);
    const at = Array.isArray(part.at?.[0]) ? part.at : part.at ? [part.at] : Array(part.copies ?? 1).fill([0, 0]);
    return model ? at.map(([x, y]) => ({model, x, y, turned: said(part).turned, locked: false})) : [];
  }

  add(model) {
    this.places.push(this.place(model));
  }

  size(place) {
    const [x, y] = place.model.figures?.size_mm ?? [10, 10];
    return place.turned ? [y, x] : [x, y];
  }

  bed() {
    const id = this.group.form.values.printer;
    const printer = this.printers.find((one) => one.id === id) ?? this.printers.find((one) => one.id === "stratasys-j750-hm");
    return printer?.tray_mm ?? [490, 390];
  }

  changed() {
    if (!this.byHand) this.arrange();
    this.draw();
  }

  /// In shelves, the deepest first; what is locked stays.
  arrange() {
    const [width] = this.bed();
    const free = this.places.filter((place) => !place.locked).sort((a, b) => this.size(b)[1] - this.size(a)[1]);
    const locked = this.places.filter((place) => place.locked);
    let x = 0, y = 0, deep = 0;
    for (const place of free) {
      const [w, d] = this.size(place);
      for (;;) {
        if (x > 0 && x + w > width) { x = 0; y = tenths(y + deep + gap); deep = 0; }
        Object.assign(place, {x, y});
        const hit = locked.find((other) => this.overlap(place, other, gap));
        if (!hit) break;
        const right = hit.x + this.size(hit)[0] + gap;
        if (right + w > width) { x = 0; y = Math.max(y + deep, hit.y + this.size(hit)[1]) + gap; deep = 0; } else x = right;
      }
      x = tenths(x + w + gap);
      deep = Math.max(deep, d);
    }
  }

  overlap(a, b, apart = 0) {
    const [aw, ad] = this.size(a), [bw, bd] = this.size(b);
    return a.x < b.x + bw + apart && b.x < a.x + aw + apart && a.y < b.y + bd + apart && b.y < a.y + ad + apart;
  }

  isWrong(place) {
    const [w, d] = this.size(place), [width, depth] = this.bed();
    return place.x < 0 || place.y < 0 || place.x + w > width || place.y + d > depth ||
      this.places.some((other) => other !== place && this.overlap(place, other));
  }

  draw() {
    const [width, depth] = this.bed();
    const chosen = this.places.indexOf(this.chosen);
    const [w, d] = this.held ?? this.seen(width, depth);
    this.svg.setAttribute("viewBox", `-2 ${depth - d - 2} ${w + 4} ${d + 4}`);
    this.svg.replaceChildren(svgOf("rect", {class: "bed", x: 0, y: 0, width, height: depth, "stroke-width": 0.4}), ...this.places.map((place) => this.part(place, depth)));
    const wrong = this.places.filter((place) => this.isWrong(place)).length;
    this.told.textContent = `${this.places.length} parts on ${width} × ${depth} mm` + (wrong ? `; ${wrong} overlap or hang over the edge` : "");
    this.told.className = wrong ? "failed" : "soft";
    if (this.group.plate === this) this.group.tellConsole();
    if (chosen >= 0 && this.focused) this.svg.querySelectorAll("g")[chosen]?.focus();
  }

  /// As much of the bed, from its corner on, as the parts take, and some room.
  seen(width, depth) {
    const right = Math.max(...this.places.map((place) => place.x + this.size(place)[0]));
    const back = Math.max(...this.places.map((place) => place.y + this.size(place)[1]));
    const most = Math.max(40, 1.5 * right, 2 * back);
    return [Math.min(width, most), Math.min(depth, most / 2)];
  }

  part(place, depth) {
    const [w, d] = this.size(place);
    const font = Math.min(w, d) / 4;
    const group = svgOf("g", {tabindex: 0, role: "button", "aria-label":
      `${place.model.name} at ${place.x.toFixed(0)}, ${place.y.toFixed(0)} mm${place.turned ? ", turned" : ""}${place.locked ? ", locked" : ""}${this.isWrong(place) ? ", overlaps" : ""}`});
    group.append(svgOf("rect", {class: `part${this.isWrong(place) ? " overlap" : ""}`, x: place.x, y: depth - place.y - d, width: w, height: d,
      "stroke-dasharray": place.locked ? "2 1" : "none"}));
    const text = svgOf("text", {x: place.x + 1, y: depth - place.y - d / 2, "font-size": font});
    text.textContent = `${place.model.name.slice(0, Math.max(3, Math.floor(1.5 * (w - 1) / font)))}${place.locked ? " 🔒" : ""}`;
    group.append(text);
    group.addEventListener("focus", () => { this.chosen = place; this.focused = true; });
    group.addEventListener("blur", () => { this.focused = false; });
    group.addEventListener("pointerdown", (event) => this.drag(event, place));
    group.addEventListener("keydown", (event) => this.press(event, place));
    return group;
  }

  drag(event, place) {
    event.preventDefault();
    this.chosen = place;
    if (place.locked) return;
    this.byHand = true;
    const scale = this.svg.getScreenCTM().a;
    this.held = this.seen(...this.bed());  // what is under the hand stays there
    const begin = {x: event.clientX, y: event.clientY, px: place.x, py: place.y};
    const move = (next) => {
      place.x = Math.round(10 * (begin.px + (next.clientX - begin.x) / scale)) / 10;
      place.y = Math.round(10 * (begin.py - (next.clientY - begin.y) / scale)) / 10;
      this.draw();
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", () => {
      window.removeEventListener("pointermove", move);
      this.held = null;
      this.draw();
    }, {once: true});
  }

  press(event, place) {
    const step = event.shiftKey ? 10 : 1;
    const moves = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
    if (moves[event.key] && !place.locked) {
      place.x += moves[event.key][0];
      place.y += moves[event.key][1];
    } else if (event.key === "r" || event.key === "R") place.turned = !place.turned;
    else if (event.key === "l" || event.key === "L") place.locked = !place.locked;
    else if (event.key === "Delete" && this.places.length > 1) this.places = this.places.filter((one) => one !== place);
    else return;
    this.byHand = true;
    event.preventDefault();
    this.draw();
  }

  /// As a tray's plan has them; a turned one is another body.
  parts() {
    const kinds = new Map();
    for (const place of this.places) {
      const kind = `${place.turned} ${place.model.name}`;
      kinds.set(kind, [...(kinds.get(kind) ?? []), place]);
    }
    const own = this.ownOptions();
    return [...kinds.values()].map((places) => {
      const rotate = [own.rotate, places[0].turned ? turn : ""].filter(Boolean).join(",");
      const at = places.map((place) => [Math.max(0, place.x), Math.max(0, place.y)]);
      return {model: places[0].model.name, ...own, ...(rotate ? {rotate} : {}), copies: places.length, at: at.length > 1 ? at : at[0]};
    });
  }

  /// Of parts; the rest are the tray's.
  ownOptions() {
    return Object.fromEntries(Object.entries(this.group.form.values).filter(([name]) => ownOptions.includes(name)));
  }

  options() {
    const own = this.ownOptions();
    return Object.fromEntries(Object.entries(this.group.form.values).filter(([name]) => !(name in own)));
  }
}
