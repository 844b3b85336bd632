// Chart of a job's error against time, with its goal.

import { ChartView, color, settings } from './charts.js';
import { duration, percent } from './format.js';

// points: [{seconds, error}]; goal: a relative error, or null.
function describe({ points, goal }) {
  const data = points.map(({ seconds, error }) => ({ x: seconds, y: error }));
  const end = Math.max(...data.map((point) => point.x)) * 1.04 || 1;
  const accent = color('--accent');
  const datasets = [{ data, borderColor: accent, backgroundColor: accent, borderWidth: 2, pointRadius: data.length > 24 ? 0 : 3, pointHoverRadius: 5, tension: 0 }];
  if (goal) datasets.push({ data: [{ x: 0, y: goal }, { x: end, y: goal }], borderColor: color('--ink'), borderWidth: 1.25, borderDash: [5, 4], pointRadius: 0, pointHoverRadius: 0 });
  const options = settings('linear');
  options.plugins.tooltip.filter = (item) => item.datasetIndex === 0;
  options.plugins.tooltip.callbacks = { title: ([item]) => item && duration(item.parsed.x), label: (item) => `Error ${percent(item.parsed.y)}` };
  const values = data.map((point) => point.y).concat(goal || []);
  Object.assign(options.scales.x, { min: 0, max: end });
  Object.assign(options.scales.y, { min: Math.min(...values) / 1.25, max: Math.max(...values) * 1.25 });
  const last = points.at(-1);
  const label = `Error against time: from ${percent(points[0].error)} to ${percent(last.error)} after ${duration(last.seconds)}${goal ? `; the goal is ${percent(goal)}` : ''}.`;
  return { type: 'line', datasets, options, label };
}

export class ErrorChart extends ChartView {
  constructor() {
    super('Error against time', describe);
  }
}
