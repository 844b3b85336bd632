// The error of a job against time, with its goal, by Chart.js.

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

const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// 1, 2 and 5 times powers of ten.
const isRound = (value) => [1, 2, 5].includes(Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(3)));

function settings() {
  const tick = { color: color('--quiet'), font: { family: getComputedStyle(document.body).fontFamily, size: 12 } };
  const grid = { color: color('--rule'), drawTicks: false, borderColor: color('--line') };
  return {
    animation: false, responsive: true, maintainAspectRatio: false, parsing: false, normalized: true,
    interaction: { mode: 'nearest', axis: 'x', intersect: false },
    plugins: {
      legend: { display: false },
      tooltip: {
        displayColors: false, filter: (item) => item.datasetIndex === 0,
        callbacks: { title: ([item]) => item && duration(item.parsed.x), label: (item) => `Error ${percent(item.parsed.y)}` },
      },
    },
    scales: {
      x: { type: 'linear', min: 0, grid: { ...grid, display: false }, ticks: { ...tick, padding: 8, maxTicksLimit: 8, callback: (value) => duration(value).replace('<\u202f10\u202fms', '0') } },
      y: { type: 'logarithmic', grid, ticks: { ...tick, padding: 8, autoSkip: false, callback: (value) => (isRound(value) ? percent(value) : null) } },
    },
  };
}

export class ErrorChart {
  #chart = null;
  #shown = null;

  constructor() {
    this.canvas = h('canvas', { role: 'img', 'aria-label': 'Error against time' });
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

  // points: [{seconds, error}]; goal: a relative error, or null.
  async show(points, goal) {
    this.#shown = { points, goal };
    await library();
    if (!this.closed) this.#draw();
  }

  #draw() {
    if (!this.#shown) return;
    const { points, goal } = this.#shown;
    const data = points.map(({ seconds, error }) => ({ x: seconds, y: error }));
    const end = Math.max(...data.map((point) => point.x)) * 1.04 || 1;
    const accent = color('--accent'), ink = color('--ink');
    const datasets = [{ data, borderColor: accent, backgroundColor: accent, borderWidth: 2, pointRadius: data.length > 24 ? 0 : 3, pointHoverRadius: 5, tension: 0 }];
    if (goal) datasets.push({ data: [{ x: 0, y: goal }, { x: end, y: goal }], borderColor: ink, borderWidth: 1.25, borderDash: [5, 4], pointRadius: 0, pointHoverRadius: 0 });
    const options = settings();
    options.scales.x.max = end;
    const values = data.map((point) => point.y).concat(goal || []);
    options.scales.y.min = Math.min(...values) / 1.25;
    options.scales.y.max = Math.max(...values) * 1.25;
    if (this.#chart) Object.assign(this.#chart, { data: { datasets }, options }).update();
    else this.#chart = new globalThis.Chart(this.canvas, { type: 'line', data: { datasets }, options });
    const last = points.at(-1);
    this.canvas.setAttribute('aria-label', `Error against time: from ${percent(points[0].error)} to ${percent(last.error)} after ${duration(last.seconds)}${goal ? `; the goal is ${percent(goal)}` : ''}.`);
  }
}
