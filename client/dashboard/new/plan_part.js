// The plan of a job, and the curve of error against seconds.

import { ChartView, color, settings } from '../charts.js';
import { h } from '../dom.js';
import { duration, percent } from '../format.js';
import * as parts from '../job_parts.js';

// Interpolates the curve linearly on logarithmic scales; null outside its range.
export function between(points, from, to, value) {
  const at = points.findIndex((point, i) => i > 0 && (points[i - 1][from] - value) * (point[from] - value) <= 0);
  if (at < 0) return null;
  const [a, b] = [points[at - 1], points[at]];
  const share = a[from] === b[from] ? 0 : Math.log(value / a[from]) / Math.log(b[from] / a[from]);
  return a[to] * (b[to] / a[to]) ** share;
}

// Returns {figure, words} for the goal: {relative_error} or {deadline_s}.
export function answer(points, asked, threads) {
  const on = threads === 1 ? 'on one thread' : `on ${threads} threads`;
  const [first, last] = [points[0], points.at(-1)];
  if (asked.deadline_s) {
    const error = between(points, 'seconds', 'error', asked.deadline_s);
    if (error !== null) return { figure: percent(error), words: ` in ${duration(asked.deadline_s)}, ${on}` };
    return asked.deadline_s < first.seconds ? { figure: `over ${percent(first.error)}`, words: ` in ${duration(asked.deadline_s)}, ${on}` } : { figure: percent(last.error), words: ` is the smallest error that a job can reach, in ${duration(last.seconds)} ${on}` };
  }
  const seconds = between(points, 'error', 'seconds', asked.relative_error);
  if (seconds !== null) return { figure: duration(seconds), words: ` to ${percent(asked.relative_error)}, ${on}` };
  return asked.relative_error > first.error ? { figure: `under ${duration(first.seconds)}`, words: ` to ${percent(asked.relative_error)}, ${on}` } : { figure: percent(last.error), words: ` is the smallest error that a job can reach, in ${duration(last.seconds)} ${on}` };
}

function describe({ points, asked }) {
  const accent = color('--accent'), ink = color('--ink');
  const data = points.map(({ seconds, error }) => ({ x: seconds, y: error }));
  const options = settings('logarithmic');
  options.plugins.tooltip.filter = (item) => item.datasetIndex === 0;
  options.plugins.tooltip.callbacks = { title: ([item]) => item && duration(item.parsed.x), label: (item) => `Error ${percent(item.parsed.y)}` };
  const range = (values) => ({ min: Math.min(...values) / 1.3, max: Math.max(...values) * 1.3 });
  const [across, up] = ['seconds', 'error'].map((name) => range(points.map((point) => point[name]).concat(asked[name] || [])));
  Object.assign(options.scales.x, across);
  Object.assign(options.scales.y, up);
  const line = asked.error ? [{ x: across.min, y: asked.error }, { x: across.max, y: asked.error }] : [{ x: asked.seconds, y: up.min }, { x: asked.seconds, y: up.max }];
  const datasets = [{ data, borderColor: accent, backgroundColor: accent, borderWidth: 2, pointRadius: 3, pointHoverRadius: 5 },
    { data: line, borderColor: ink, borderWidth: 1.25, borderDash: [5, 4], pointRadius: 0, pointHoverRadius: 0 }];
  return { type: 'line', datasets, options, label: `Error against seconds: from ${percent(points[0].error)} in ${duration(points[0].seconds)} to ${percent(points.at(-1).error)} in ${duration(points.at(-1).seconds)}.` };
}

export class PlanPart {
  constructor({ plan, warnings, curve }, asked) {
    const points = curve?.points?.length > 1 ? curve.points : null;
    this.node = h('div', { class: 'job-main' }, points ? this.#curve(curve, asked) : this.#foreseen(plan, curve), warnings.length ? parts.warnings(warnings) : [], parts.plan(plan));
  }

  close() {
    this.chart?.close();
  }

  #curve({ points, threads, model, technique }, asked) {
    const { figure, words } = answer(points, asked, threads);
    this.chart = new ChartView('Error against seconds', describe);
    this.chart.show({ points, asked: { error: asked.relative_error, seconds: asked.deadline_s } }).catch(() => {});
    return parts.section('cost', 'What it will take', h('p', { class: 'figure' }, h('strong', {}, figure), h('span', {}, words)), this.chart.node,
      h('p', { class: 'quiet' }, `By ${parts.techniqueWords(technique)}, estimated from two small rounds of the job (${model}).`));
  }

  #foreseen(plan, curve) {
    const dearest = plan.effects.reduce((most, one) => Math.max(most, one.cost_s || 0), 0), whole = plan.foresight?.job_s ?? null;
    return h('div', {}, h('p', { class: 'figure' }, h('strong', {}, duration(whole ?? dearest)), h('span', {}, whole === null ? ' for its most expensive effect, on one thread; rounds for the accuracy add to this' : ' predicted for the whole job')),
      curve?.model && h('p', { class: 'quiet' }, `${curve.model[0].toUpperCase()}${curve.model.slice(1)}.`));
  }
}
