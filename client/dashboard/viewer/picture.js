// A decoded picture, with queries for pixels and regions.

import { filePath } from '../api.js';
import { EFFICACY, luma } from './hdr.js';

let worker = null, last = 0;
const waiting = new Map();

function ask(message) {
  if (!worker) {
    worker = new Worker(new URL('hdr_worker.js', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }) => {
      const { resolve, reject } = waiting.get(data.id);
      waiting.delete(data.id);
      if (data.fault) reject(new Error(data.fault));
      else resolve(data.picture);
    };
  }
  return new Promise((resolve, reject) => {
    const id = ++last;
    waiting.set(id, { resolve, reject });
    worker.postMessage({ id, ...message });
  });
}

// file: NAME.hdr of a job; errors are loaded, too, if the job has them.
export async function load(job, file, hasErrors) {
  const errors = hasErrors ? filePath(job, file.replace(/\.hdr$/, '.error.hdr')) : null;
  return new Picture(await ask({ picture: filePath(job, file), errors }));
}

export class Picture {
  constructor(found) {
    Object.assign(this, found);
  }

  // Returns {value, error} in cd/m2, or lx for a view of irradiance; error is NaN if not known.
  at([x, y]) {
    const i = 4 * (y * this.width + x);
    return { value: EFFICACY * luma(this.pixels, i), error: this.knowsErrors ? EFFICACY * this.pixels[i + 3] : NaN };
  }

  // Returns the outline of pixels brighter than the threshold (cd/m2) as an SVG path in pixels.
  edgeOf(threshold) {
    const { width, height, pixels } = this, parts = [];
    const lit = (x, y) => x >= 0 && y >= 0 && x < width && y < height && EFFICACY * luma(pixels, 4 * (y * width + x)) >= threshold;
    // Joins edges along each row, then along each column.
    const walk = (lines, length, differs, piece) => {
      for (let line = 0; line <= lines; line++)
        for (let at = 0, from = -1; at <= length; at++) {
          const edge = at < length && differs(line, at);
          if (edge && from < 0) from = at;
          if (!edge && from >= 0) { parts.push(piece(line, from, at)); from = -1; }
        }
    };
    walk(height, width, (y, x) => lit(x, y - 1) !== lit(x, y), (y, from, to) => `M${from} ${y}H${to}`);
    walk(width, height, (x, y) => lit(x - 1, y) !== lit(x, y), (x, from, to) => `M${x} ${from}V${to}`);
    return parts.join('');
  }

  region(from, to) {
    const [left, right] = [from[0], to[0]].sort((a, b) => a - b), [low, high] = [from[1], to[1]].sort((a, b) => a - b);
    let sum = 0, least = Infinity, most = 0, count = 0;
    for (let y = low; y <= high; y++)
      for (let x = left; x <= right; x++, count++) {
        const { value } = this.at([x, y]);
        sum += value;
        least = Math.min(least, value);
        most = Math.max(most, value);
      }
    return { mean: sum / count, least, most, count };
  }
}
