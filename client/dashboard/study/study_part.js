// A study's points as they arrive: error against seconds; each can be started as a job.

import { ChartView, color, settings } from '../charts.js';
import { fill, h, setText } from '../dom.js';
import { NONE, count, duration, percent } from '../format.js';
import { section } from '../job_parts.js';

const SHAPES = { backward: 'circle', gather: 'triangle', direct: 'rect', precomputed: 'rectRot' };
const COLORS = { backward: '--series-1', gather: '--series-2', direct: '--series-3', precomputed: '--series-4' };

// Points of a finished study (full) or a running study (short), in one form.
const pointsOf = (job, result) => (result?.points || job.study?.points || []).map(({ technique, photons, samples, seconds, total_s, rms, rms_error, on_front }) =>
  ({ technique, photons, samples, seconds: seconds?.total ?? total_s, rms, error: rms_error, front: !!on_front }));

export const settingWords = ({ technique, photons, samples }) =>
  [technique, photons && `${count(photons)} photons`, samples && `${count(samples)} samples`].filter(Boolean).join(', ');

// The job document that corresponds to a point of the study.
export function jobOf(document, { technique, photons, samples }) {
  const { kind, techniques, photons: all, gather_samples: gather, pixel_samples: pixel, repeats, reference, points, title, note, name, ...rest } = document;
  return {
    ...rest, kind: 'render', technique, name: `${name || title || 'Study'}: ${settingWords({ technique, photons, samples })}`.slice(0, 100),
    ...(photons ? { photons: { global: photons, caustic: photons, exact: true } } : {}),
    ...(samples ? { [document.views?.length ? 'pixel_samples' : 'gather_samples']: samples } : {}),
  };
}

function dataset(technique, points) {
  const tint = color(COLORS[technique]);
  return {
    label: technique, showLine: true, borderColor: tint, backgroundColor: tint, borderWidth: 1, pointStyle: SHAPES[technique], pointHoverRadius: 8,
    pointRadius: points.map((point) => (point.front ? 6 : 4)), data: points.map((point) => ({ x: point.seconds, y: point.rms, point })),
  };
}

function describe({ points, given, start }) {
  const known = points.filter((point) => point.rms > 0 && point.seconds > 0).sort((a, b) => a.seconds - b.seconds);
  const datasets = Object.keys(SHAPES).filter((name) => known.some((point) => point.technique === name)).map((name) => dataset(name, known.filter((point) => point.technique === name)));
  if (given.length) datasets.push({ label: 'Elsewhere', data: given.map((one) => ({ x: one.here_s ?? one.seconds, y: one.rms, given: one.name })), pointStyle: 'crossRot', pointRadius: 6, borderColor: color('--ink'), borderWidth: 2, showLine: false });
  const options = settings('logarithmic');
  options.interaction = { mode: 'nearest', axis: 'xy', intersect: true };
  options.plugins.legend = { display: true, align: 'start', labels: { usePointStyle: true, boxHeight: 7, padding: 16, color: color('--ink'), font: options.scales.x.ticks.font } };
  options.plugins.tooltip.callbacks = {
    title: ([item]) => item && (item.raw.point ? settingWords(item.raw.point) : item.raw.given),
    label: (item) => `${percent(item.parsed.y)} in ${duration(item.parsed.x)}`,
    afterLabel: (item) => (item.raw.point && start ? 'Click to start this job' : ''),
  };
  if (start) {
    options.onHover = (event, found) => { event.native.target.style.cursor = found.some((one) => datasets[one.datasetIndex].data[one.index].point) ? 'pointer' : ''; };
    options.onClick = (event, [one]) => { if (one && event.native.pointerType !== 'touch' && datasets[one.datasetIndex].data[one.index].point) start(datasets[one.datasetIndex].data[one.index].point); };
  }
  const best = known.length ? known.reduce((a, b) => (a.rms < b.rms ? a : b)) : null;
  const label = best ? `Error against seconds of ${known.length} settings, all in the table below; the least is ${percent(best.rms)} in ${duration(best.seconds)}, by ${settingWords(best)}.` : 'Error against seconds: nothing yet.';
  return { type: 'scatter', datasets, options, label };
}

export class StudyPart {
  // start: starts a point as a job; null if this is not allowed.
  constructor(start) {
    this.start = start;
    this.words = h('p', { class: 'quiet' });
    this.chart = new ChartView('Error against seconds', describe);
    this.rows = h('tbody', {});
    this.chart.node.classList.add('tall');
    this.table = h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-labelledby': 'study' }, h('table', { class: 'kept' },
      h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Technique'), ['Photons', 'Samples', 'Time', 'Error, rms'].map((word) => h('th', { scope: 'col', class: 'n' }, word)), h('th', { scope: 'col' }, h('span', { class: 'unseen' }, 'Remarks and start')))), this.rows));
    this.node = section('study', 'What accuracy costs', this.words, this.chart.node, this.table);
  }

  close() {
    this.chart.close();
  }

  show(job, result) {
    const points = pointsOf(job, result);
    const { study } = job;
    setText(this.words, result?.points ? 'Larger marks: no other setting is both faster and more accurate.'
      : study ? `${points.length} of ${study.settings} settings measured; at ${study.running === 'parts' ? 'all runs, in parts' : study.running === 'reference' ? 'the reference' : settingWords(study)}, run ${study.run} of ${study.runs}.` : 'Nothing is measured yet.');
    fill(this.rows, points, () => [...points].sort((a, b) => a.seconds - b.seconds).map((point) => h('tr', {}, h('td', {}, point.technique),
      [count(point.photons ?? NaN), count(point.samples ?? NaN), duration(point.seconds), point.rms === null ? NONE : `${percent(point.rms)}${point.error ? ` \u00b1\u202f${percent(point.error)}` : ''}`].map((cell) => h('td', { class: 'n' }, cell)),
      h('td', { class: 'n' }, point.front && h('span', { class: 'quiet' }, 'best at its time '), this.start && h('button', { type: 'button', class: 'plain', 'aria-label': `Start ${settingWords(point)}`, onclick: () => this.start(point) }, 'Start')))));
    const key = JSON.stringify(points);
    this.table.hidden = points.length === 0;
    this.chart.node.hidden = !points.some((point) => point.rms > 0);
    if (key === this.key || this.chart.node.hidden) return;
    this.key = key;
    this.chart.show({ points, given: result?.given || [], start: this.start }).catch(() => {});
  }
}
