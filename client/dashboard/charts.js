// Shared by all charts: loading Chart.js on demand, and the light and dark styles.

import { h } from './dom.js';
import { duration, percent } from './format.js';

let loading = null;
function library() {
  loading ||= new Promise((resolve, reject) => {
    const script = h('script', { src: new URL('chart.js', import.meta.url).href });
    script.onload = () => resolve(globalThis.Chart);
    script.onerror = () => reject(new Error('Chart.js did not load'));
    document.head.append(script);
  });
  return loading;
}

export const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Leading digits of labelled values: 1, 2 and 5, all digits for a small range, only 1 for a large range on
// a narrow chart.
function digitsOf({ max, min, axis, chart }) {
  if (axis === 'x' && chart.width < 480 && max / min > 20) return [1];
  return max / min < 8 ? [1, 2, 3, 4, 5, 6, 7, 8, 9] : [1, 2, 5];
}
const isRound = (value, axis) => digitsOf(axis).includes(Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(3)));

// Options for a chart of relative error (logarithmic) against seconds (xType: linear or logarithmic).
export function settings(xType) {
  const tick = { color: color('--quiet'), font: { family: getComputedStyle(document.body).fontFamily, size: 12 }, padding: 8 };
  const grid = { color: color('--rule'), drawTicks: false, borderColor: color('--line') };
  const logarithmic = xType === 'logarithmic';
  const seconds = (value, axis) => (logarithmic && !isRound(value, axis) ? null : duration(value).replace(/^<.*/, '0'));
  return {
    animation: false, responsive: true, maintainAspectRatio: false, parsing: false, normalized: true,
    interaction: { mode: 'nearest', axis: 'x', intersect: false },
    plugins: { legend: { display: false }, tooltip: { displayColors: false, callbacks: {} } },
    scales: {
      x: { type: xType, grid: { ...grid, display: logarithmic }, ticks: { ...tick, includeBounds: false, autoSkip: !logarithmic, maxRotation: 0, maxTicksLimit: logarithmic ? 40 : 8, callback(value) { return seconds(value, this); } } },
      y: { type: 'logarithmic', grid, ticks: { ...tick, autoSkip: false, callback(value) { return isRound(value, this) ? percent(value) : null; } } },
    },
  };
}

// One chart on a canvas, redrawn when its data or the colour scheme change.
export class ChartView {
  #chart = null;
  #shown = null;

  // describe: converts the data to {type, datasets, options, label}.
  constructor(label, describe) {
    this.describe = describe;
    this.canvas = h('canvas', { role: 'img', 'aria-label': label });
    this.node = h('div', { class: 'chart' }, this.canvas);
    this.scheme = matchMedia('(prefers-color-scheme: dark)');
    this.recolor = () => this.#draw();
    this.scheme.addEventListener('change', this.recolor);
  }

  close() {
    this.scheme.removeEventListener('change', this.recolor);
    this.#chart?.destroy();
    this.#chart = null;
    this.closed = true;
  }

  async show(shown) {
    this.#shown = shown;
    await library();
    if (!this.closed) this.#draw();
  }

  #draw() {
    if (!this.#shown || !globalThis.Chart) return;
    const { type, datasets, options, label } = this.describe(this.#shown);
    if (this.#chart) Object.assign(this.#chart, { data: { datasets }, options }).update();
    else this.#chart = new globalThis.Chart(this.canvas, { type, data: { datasets }, options });
    this.canvas.setAttribute('aria-label', label);
  }
}
