// Colours of differences and of places in words.

const decoded = (code) => (code <= 0.04045 ? code / 12.92 : Math.pow((code + 0.055) / 1.055, 2.4));

const encoded = (linear) =>
  Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * Math.pow(linear, 1 / 2.4) - 0.055));

/// White 0, yellow 2, orange 5, red 10, black 20: as in the report's pictures (slicer/surface/target_cells.cpp).
const DIFFERENCE_COLOURS = [
  [0, [1, 1, 1]], [2, [1, 0.9, 0.3]], [5, [1, 0.55, 0]], [10, [0.8, 0, 0]], [20, [0, 0, 0]],
];

const differenceColour = (difference) => {
  for (let i = 0; i + 1 < DIFFERENCE_COLOURS.length; ++i) {
    const [from, low] = DIFFERENCE_COLOURS[i];
    const [to, high] = DIFFERENCE_COLOURS[i + 1];
    if (difference > to) continue;
    const t = (difference - from) / (to - from);
    return low.map((code, c) => encoded((1 - t) * decoded(code) + t * decoded(high[c])));
  }
  return [0, 0, 0];
};

/// Of differences in tenths.
const differenceLook = (tenths) => {
  const table = Array.from({ length: 256 }, (_, i) => differenceColour(i / 10));
  const rgb = new Uint8Array(3 * tenths.length);
  for (let i = 0; i < tenths.length; ++i) rgb.set(table[tenths[i]], 3 * i);
  return rgb;
};

const hexOf = (rgb) => "#" + [...rgb].map((code) => code.toString(16).padStart(2, "0")).join("");
const cssOf = (rgb) => `rgb(${rgb[0]}, ${rgb[1]}, ${rgb[2]})`;
const differenceText = (tenths) => (tenths === 255 ? "25.5 or more" : (tenths / 10).toFixed(1));
