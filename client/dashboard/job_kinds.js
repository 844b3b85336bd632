// Additional tables of jobs with several skies, and of years.

import { h } from './dom.js';
import { NONE, count, duration, number, percent } from './format.js';
import { section } from './job_parts.js';

// heads: [label, is a number]
function table(id, heads, rows) {
  return h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-labelledby': id }, h('table', {},
    h('thead', {}, h('tr', {}, heads.map(([label, numeric]) => h('th', { scope: 'col', class: numeric ? 'n' : '' }, label)))),
    h('tbody', {}, rows.map((cells) => h('tr', {}, cells.map((cell, i) => h('td', { class: heads[i][1] ? 'n' : '' }, cell)))))));
}

function skies(result) {
  const mean = (values) => (values.length ? `${number(values.reduce((sum, value) => sum + value, 0) / values.length)}\u202flx` : NONE);
  return section('skies', 'Skies', table('skies', [['Sky'], ['Technique'], ['Mean of sensors', true], ['Error', true], ['Time', true]],
    result.skies.map((sky) => [sky.name, sky.technique, sky.dark ? 'dark' : mean(sky.illuminance_lx), percent(sky.accuracy?.achieved ?? NaN), duration(sky.seconds)])));
}

const VERDICTS = { pass: 'Pass', fail: 'Fail', undecided: 'Not decided', unknown: 'Unknown' };

const verdict = ({ verdict: word, note }) => (note ? `${VERDICTS[word]}: ${note}` : VERDICTS[word]);

function year(result) {
  const shown = ({ value, unit, interval_95: interval }) =>
    (value === null ? NONE : `${number(value)}\u202f${unit}${interval[0] === null ? '' : ` (${number(interval[0])} to ${number(interval[1])})`}`);
  return [
    result.rules.length > 0 && section('rules', 'Rules', table('rules', [['Rule'], ['Grid'], ['Verdict']], result.rules.map((one) => [one.rule, one.grid ?? 'all', verdict(one)]))),
    result.verdicts.length > 0 && section('targets', 'Targets', table('targets', [['Target'], ['Grid'], ['Found', true], ['Verdict']],
      result.verdicts.map((one) => [one.target, one.grid ?? 'all', shown(one), verdict(one)]))),
    section('grids', 'Grids', table('grids', [['Grid'], ['Figure'], ['Found', true]],
      result.grids.flatMap((grid) => grid.figures.map((figure, i) => [i === 0 ? `${grid.name}, ${count(grid.sensors)} sensors` : '', figure.name, shown(figure)])))),
  ].filter(Boolean);
}

export function resultOfKind(job, result) {
  if (job.kind === 'annual') return result?.verdicts ? year(result) : [];
  return result?.skies ? skies(result) : [];
}
