// Parts of a job's page: stages, plan, maps, health, files.

import { filePath } from './api.js';
import { h } from './dom.js';
import { NONE, bytes, count, duration, fullMoment, isOver, moment, number, percent, shortId, stageName, stateName } from './format.js';
import { EFFECTS, MAPS, TECHNIQUES, boundWords, healthWords } from './words.js';

const ORDER = ['load', 'bvh', 'plan', 'photons', 'maps', 'render'];
const YEAR_ORDER = ['load', 'skies', 'paths', 'sun', 'hours'];

export function section(id, title, ...children) {
  return h('section', { 'aria-labelledby': id }, h('h2', { id }, title), ...children);
}

export function facts(pairs) {
  return h('dl', { class: 'facts' }, pairs.filter(([, value]) => value !== null && value !== undefined && value !== '')
    .map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))));
}

function runner({ name, parts }) {
  if (name !== 'slurm') return 'In the daemon';
  return `With Slurm: ${parts.done} parts done, ${parts.running} running, ${parts.waiting} waiting${parts.again ? `, ${parts.again} restarted` : ''}${parts.held ? '; the shared disk is full' : ''}`;
}

export function jobFacts(job) {
  const took = job.started && job.finished ? (new Date(job.finished) - new Date(job.started)) / 1000 : null;
  return facts([
    ['Kind', { annual: 'Year of daylight', study: 'Study', bsdf_make: 'BSDF of a panel', bsdf_fit: 'BSDF from measurements' }[job.kind] ?? 'Render'],
    ['Technique', job.technique && TECHNIQUES[job.technique]],
    ['Scene', h('a', { class: 'mono', href: `#/jobs?scene=${job.scene}` }, shortId(job.scene))],
    ['Tags', job.tags.length ? job.tags.map((tag, i) => [i ? ', ' : '', h('a', { href: `#/jobs?${new URLSearchParams({ tag })}` }, tag)]) : null],
    ['Submitted', h('span', { title: fullMoment(job.created) }, moment(job.created))],
    ['Took', took === null ? null : duration(took)],
    ['Threads', job.threads && String(job.threads)],
    ['Client', job.client.replace(/^(token|name|address):/, '')],
    ['Runs', job.runner && h('span', { title: job.runner.why }, runner(job.runner))],
    ['Attempts', job.attempts > 1 ? String(job.attempts) : null],
    ['Id', h('span', { class: 'mono wrap' }, job.id)],
  ]);
}

// A bar for each stage: its share of the time after the end, its progress during the run.
export function stages(job) {
  const times = job.timings_s;
  const order = (job.kind === 'annual' && times && 'skies' in times) ? YEAR_ORDER : ORDER;
  const total = times ? order.reduce((sum, stage) => sum + (times[stage] || 0), 0) : 0;
  const at = order.indexOf(job.stage);
  const rows = order.map((stage, i) => {
    const seconds = times?.[stage];
    const words = times ? duration(seconds) : i < at ? 'done' : i === at ? `${Math.round(job.stage_percent || 0)}\u202f%` : '';
    return h('li', { class: times || i < at ? 'done' : i === at ? 'now' : 'later', 'aria-current': !times && i === at ? 'step' : null },
      h('span', { class: 'stage-bar', 'aria-hidden': 'true' }, bar(times ? seconds / total : i < at ? 1 : i === at ? (job.stage_percent || 0) / 100 : 0)),
      h('span', {}, stageName(stage)), h('span', { class: 'n' }, words));
  });
  return h('ol', { class: 'stages' }, rows);
}

function bar(share) {
  const node = h('span', {});
  node.style.inlineSize = `${100 * Math.min(1, Math.max(0, share || 0))}%`;
  return node;
}

function planRow(decision) {
  const cost = decision.simulated
    ? (decision.cost_s > 0 ? duration(decision.cost_s) : NONE)
    : [decision.saved_s > 0 ? `saves ${duration(decision.saved_s)}` : '', boundWords(decision.bound)].filter(Boolean).join(', ') || NONE;
  return h('tr', { class: decision.simulated ? '' : 'out', role: 'row' },
    h('th', { scope: 'row', role: 'rowheader' }, EFFECTS[decision.effect] || decision.effect),
    h('td', { role: 'cell' }, decision.simulated ? 'Yes' : 'No', decision.wish !== 'auto' && h('span', { class: 'quiet' }, ` (${decision.wish === 'force' ? 'forced' : 'skipped'})`)),
    h('td', { class: 'why', role: 'cell' }, decision.why), h('td', { class: 'n', role: 'cell' }, cost));
}

const techniqueSentence = ({ technique, why }, before = '') => {
  const words = `${before}${TECHNIQUES[technique]}`;
  return `${words[0].toUpperCase()}${words.slice(1)}: ${why}.`;
};

// The classes of light paths in the scene, and the sampling strategies that find them.
const STRATEGIES = {
  rays: 'rays', 'port-rays': 'rays to windows', 'shadow-rays': 'shadow rays', images: 'images in mirrors', beams: 'rays along beams',
  'caustic-photons': 'caustic photons', photons: 'global photons', chance: 'chance only',
};
const lightItem = ({ light, on_surfaces: found }) => h('li', {}, `${light[0].toUpperCase()}${light.slice(1)}: by ${found.map((name) => STRATEGIES[name]).join(', ')}`);

export function plan(plan) {
  const effects = [...plan.effects].sort((a, b) => b.simulated - a.simulated);
  return section('plan', 'Plan',
    h('p', {}, techniqueSentence(plan)),
    plan.sensors && h('p', {}, techniqueSentence(plan.sensors, 'sensors by ')),
    h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-labelledby': 'plan' },
      h('table', { class: 'plan', role: 'table' },
        h('thead', { role: 'rowgroup' }, h('tr', { role: 'row' }, ['Effect of light', 'Simulated', 'Why'].map((word) => h('th', { scope: 'col', role: 'columnheader' }, word)), h('th', { scope: 'col', role: 'columnheader', class: 'n' }, 'Cost, or loss'))),
        h('tbody', { role: 'rowgroup' }, effects.map(planRow)))),
    h('ul', { class: 'quiet', 'aria-label': 'How light is found' }, (plan.paths || []).map(lightItem)));
}

export const techniqueWords = (technique) => TECHNIQUES[technique] || technique;

export function maps(list) {
  return section('maps', 'Maps',
    h('ul', { class: 'lines' }, list.map((map) => h('li', {},
      h('strong', {}, MAPS[map.kind] || map.kind),
      h('span', {}, `${count(map.stored)} stored, ${bytes(map.bytes)}`),
      h('span', { class: 'quiet' }, map.cached ? `found in the cache${map.seconds > 0 ? `, ${duration(map.seconds)} saved` : ''}`
        : map.reused > 0 ? `${count(map.reused)} reused, the rest built in ${duration(map.seconds)}` : `built in ${duration(map.seconds)}`)))));
}

export function warnings(list) {
  return section('warnings', list.length === 1 ? 'Warning' : 'Warnings', h('ul', { class: 'warnings' }, list.map((text) => h('li', {}, text))));
}

export function health(found) {
  const { sound, lines, work } = healthWords(found);
  return section('health', 'Health', sound ? h('p', {}, lines[0], ' ', h('span', { class: 'quiet' }, work)) : [h('ul', { class: 'warnings' }, lines.map((text) => h('li', {}, text))), h('p', { class: 'quiet' }, `Of ${work}.`)]);
}

export function files(job) {
  const listed = job.files || (job.links.files || []).map((link) => ({ name: decodeURIComponent(link.split('/').pop()) }));
  if (!listed.length) return [];
  return section('files', 'Files',
    h('ul', { class: 'files' }, listed.map((file) => h('li', {},
      h('a', { href: filePath(job.id, file.name), target: '_blank', rel: 'noopener' }, file.name), file.bytes !== undefined && h('span', { class: 'quiet n' }, bytes(file.bytes))))));
}

// Summary of many sensors.
export function sensorFigures(sensors) {
  const values = sensors.map((one) => one.illuminance_lx).filter(Number.isFinite).sort((a, b) => a - b);
  if (!values.length) return [];
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const lit = values.filter((value) => value >= 300).length / values.length;
  const unreliable = sensors.filter((one) => one.unreliable).length;
  return facts([
    ['Sensors', count(values.length)], ['Mean', `${number(mean)}\u202flx`], ['Median', `${number(values[values.length >> 1])}\u202flx`],
    ['Minimum', `${number(values[0])}\u202flx`], ['Maximum', `${number(values.at(-1))}\u202flx`], ['At 300\u202flx or more', percent(lit, 3)], ...(unreliable ? [['Unreliable: see the warnings', count(unreliable)]] : []),
  ]);
}

// Result of the cross-check of sensors by plain path tracing. A sum whose 95 % interval is wider
// than 30 % to either side is not compared.
export function crossCheck(check) {
  if (!check?.sensors) return [];
  const { sensors, sensors_off: off, differs_in: kind, ratio, ratio_error: error } = check;
  const apart = !Number.isFinite(ratio) ? '' : 1.96 * error <= 0.3
    ? `, their sum within ${percent(Math.abs(ratio - 1) + 1.96 * error)}` : '; too few paths to compare their sum';
  return h('p', { class: 'after' }, off
    ? `Cross-check by path tracing: ${off} of ${count(sensors)} sensors differ by more than the errors, most likely in the ${kind}. See the warnings.`
    : `Cross-check by path tracing: agrees at ${count(sensors)} sensor${sensors === 1 ? '' : 's'}${apart}.`);
}

export function headline(job) {
  if (job.state === 'queued') return job.queue_position === 1 ? 'Waiting, next in the queue' : `Waiting, place ${job.queue_position} in the queue`;
  if (job.state === 'running') return job.eta_s === null ? 'Running' : `Running, about ${duration(job.eta_s)} left`;
  if (job.state === 'cancelling') return 'Stopping';
  return isOver(job.state) ? `${stateName(job.state)} ${moment(job.finished)}` : stateName(job.state);
}
