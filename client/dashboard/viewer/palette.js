// The palette of even lightness steps (core/render/picture/palette.c), and its scales.

const POINTS = [[28, 18, 107], [10, 44, 115], [12, 65, 114], [14, 84, 115], [17, 103, 119], [20, 122, 121], [23, 141, 117],
  [28, 161, 106], [69, 179, 96], [119, 194, 94], [162, 208, 95], [204, 220, 101], [245, 232, 112]];

export function colorOf(share) {
  const at = (POINTS.length - 1) * Math.min(1, Math.max(0, share));
  const low = Math.min(POINTS.length - 2, Math.floor(at));
  return POINTS[low].map((value, c) => Math.round(value + (at - low) * (POINTS[low + 1][c] - value)));
}

export function texels(count = 256) {
  const bytes = new Uint8Array(4 * count);
  for (let i = 0; i < count; i++) bytes.set([...colorOf(i / (count - 1)), 255], 4 * i);
  return bytes;
}

// Rounds up to 1, 2 or 5 times a power of ten.
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const digits = value / power;
  return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

// Labelled values of a legend, from 0 or the lowest value to the top.
export function levels(top, decades) {
  const found = [];
  if (decades > 0) {
    for (let power = Math.ceil(Math.log10(top) - decades - 1e-9); power <= Math.log10(top) + 1e-9; power++) found.push(10 ** power);
    if (found.at(-1) < top * 0.999) found.push(top);
  } else {
    const step = roundUp((top / 8) * (1 - 1e-9));
    for (let i = 0; i * step <= top * (1 + 1e-9); i++) found.push(i * step);
  }
  return found;
}

export const shareOf = (value, top, decades) =>
  (decades > 0 ? (value > top / 10 ** decades ? 1 + Math.log10(value / top) / decades : 0) : value / top);
