// What both views of the page have in common: a scale bar, rows of buttons, pointers.

const showScale = (stage, pxPerMm) => {
  const [bar, text] = stage.querySelector(".viewer-scale").children;
  const most = Math.min(160, stage.clientWidth / 3) / pxPerMm;
  const power = Math.pow(10, Math.floor(Math.log10(most)));
  const length = power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
  bar.style.width = `${length * pxPerMm}px`;
  text.textContent = length >= 1 ? `${length} mm` : `${Number((1000 * length).toPrecision(3))} µm`;
};

/// A button of a row of which one is pressed.
const addChoice = (row, text, title, act) => {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = text;
  button.title = title;
  button.addEventListener("click", act);
  row.append(button);
  return button;
};

const press = (button, pressed) => button.setAttribute("aria-pressed", String(Boolean(pressed)));

/// Drags, pinches and taps of one or two pointers on an element. `drag(dx, dy, event)` in px; `pinch(factor, x, y, dx, dy)`.
const followPointers = (element, { drag, pinch, hover }) => {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    return { x: (all[0].x + all[1].x) / 2, y: (all[0].y + all[1].y) / 2, apart: Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) };
  };
  element.addEventListener("pointerdown", (event) => {
    element.focus({ preventScroll: true });
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    if (event.button === 1) event.preventDefault();
  });
  element.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return hover(event.offsetX, event.offsetY);
    const now = { x: event.offsetX, y: event.offsetY };
    if (pointers.size === 1) {
      pointers.set(event.pointerId, now);
      drag(now.x - before.x, now.y - before.y, event);
    } else if (pointers.size === 2) {
      const was = middle();
      pointers.set(event.pointerId, now);
      const is = middle();
      pinch(is.apart / Math.max(1, was.apart), is.x, is.y, is.x - was.x, is.y - was.y);
    }
  });
  for (const end of ["pointerup", "pointercancel"])
    element.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      if (event.pointerType !== "mouse") hover(event.offsetX, event.offsetY);
    });
  element.addEventListener("contextmenu", (event) => event.preventDefault());
};
