// The page of one job: progress, error, results, simulated effects and reasons.

import { client, explain } from './api.js';
import { fill, h, say, setAttr, setText } from './dom.js';
import { ErrorChart } from './error_chart.js';
import { duration, fullMoment, isOver, jobName, percent, stateName } from './format.js';
import { copyDocument, withHalfError, withViewpoint } from './derive_job.js';
import { resultOfKind } from './job_kinds.js';
import * as parts from './job_parts.js';
import { JobFailed, NotFound } from './oriel.js';
import { Pictures } from './pictures.js';
import { GOALS } from './words.js';

const REST_MS = 700;            // between two requests for a running job,
const SPREAD_MS = 300;          // random addition, because many pages get the event at the same moment
const LARGE_RESULT = 24 << 20;  // bytes: larger results are not read

export class JobPage {
  title = 'Job';
  job = null;
  result = null;

  constructor(app, id) {
    this.app = app;
    this.id = id;
    const place = (name) => (this[name] = h('div', { class: `part part-${name}` }));
    this.heading = h('h1', { tabindex: -1 }, 'Job');
    this.state = h('p', { class: 'state' }, 'Loading');
    this.actions = h('div', { class: 'controls' });
    this.bar = h('div', { class: 'bar wide', role: 'progressbar', 'aria-label': 'Progress', 'aria-valuemin': 0, 'aria-valuemax': 100 }, h('span'));
    this.pictures = new Pictures(id);
    this.node = h('div', { class: 'page' },
      h('p', { class: 'crumb' }, h('a', { href: '#/jobs' }, 'Jobs')),
      h('div', { class: 'head' }, h('div', {}, this.heading, this.state), this.actions),
      this.bar, place('notice'),
      h('div', { class: 'job' },
        h('div', { class: 'job-main' }, place('accuracy'), place('sensors'), place('kind'), this.pictures.node, place('warnings'), place('plan'), place('health')),
        h('div', { class: 'job-side' }, place('facts'), place('stages'), place('maps'), place('files'))));
    this.bar.hidden = true;
    this.heard = new AbortController();
    const { signal } = this.heard;
    app.store.addEventListener('job', (event) => event.job.id.startsWith(id) && this.#later(), { signal });
    app.store.addEventListener('reset', () => this.#later(), { signal });
    app.store.addEventListener('removed', (event) => event.id === this.job?.id && this.#gone(), { signal });
    this.#look();
  }

  close() {
    this.heard.abort();
    clearTimeout(this.timer);
    this.chart?.close();
    this.study?.close();
    this.closed = true;
  }

  #later() {
    this.timer ||= setTimeout(() => {
      this.timer = 0;
      this.#look();
    }, REST_MS + Math.random() * SPREAD_MS);
  }

  async #look() {
    try {
      const job = await client.job(this.id).status();
      if (this.closed) return;
      const before = this.job;
      this.job = job;
      await this.#lookAtResult();
      if (this.closed) return;
      this.#show();
      if (before && before.state !== job.state && isOver(job.state)) say(`${jobName(job)}: ${stateName(job.state)}`);
    } catch (error) {
      if (error instanceof NotFound) this.#gone();
      else if (!this.job) {
        setText(this.state, '');
        fill(this.notice, String(error), () => h('p', { class: 'notice' }, explain(error)));
      }
    }
  }

  #gone() {
    if (!this.job) setText(this.state, '');
    if (this.job) fill(this.notice, 'gone', () => h('p', { class: 'notice' }, 'This job has been removed.'));
    else fill(this.notice, 'none', () => h('div', { class: 'empty' }, h('h2', {}, 'There is no such job'), h('p', {}, 'It may have been removed, or deleted as one of the oldest. ', h('a', { href: '#/jobs' }, 'All jobs'))));
    this.actions.replaceChildren();
  }

  // A key that changes whenever there may be a newer result.
  get version() {
    const { job } = this;
    return isOver(job.state) ? '' : `${job.accuracy?.rounds ?? 0}-${job.skies?.done ?? 0}-${job.links.files?.length ?? 0}`;
  }

  async #lookAtResult() {
    const { job } = this;
    const size = job.files?.find((file) => file.name === 'result.json')?.bytes ?? 0;
    const key = job.links.result ? `${job.state} ${this.version}` : '';
    if (key === (this.resultKey ?? '')) return;
    this.resultKey = key;
    if (!key || size > LARGE_RESULT) return;
    try {
      this.result = await client.job(job.id).result();
    } catch { /* a later result follows, or the job was removed */ }
  }

  #show() {
    const { job, result } = this;
    const name = jobName(job);
    this.title = job.state === 'running' && job.percent !== null ? `${Math.floor(job.percent)}\u202f% ${name}` : name;
    this.app.setTitle(this.title);
    setText(this.heading, name);
    setAttr(this.node, 'data-state', job.state);
    fill(this.state, parts.headline(job), () => [h('span', { class: 'dot', 'aria-hidden': 'true' }), parts.headline(job)]);
    this.#showProgress();
    this.#showActions();
    this.#showNotice();
    this.#showAccuracy();
    const names = job.files?.map((file) => file.name) || (job.links.files || []).map((link) => decodeURIComponent(link.split('/').pop()));
    this.pictures.drawn = job.kind !== 'render';
    this.pictures.show(job.evicted ? [] : names, this.version);
    const sensors = result?.sensors?.length ? result.sensors : null;
    const underSkies = result?.skies?.some((sky) => sky.illuminance_lx.length > 0);
    fill(this.sensors, (sensors || underSkies) && this.resultKey, () => (sensors || underSkies) && parts.section('sensors', 'Sensors',
      sensors && parts.sensorFigures(sensors), sensors && parts.crossCheck(result.cross_check), h('p', { class: 'after' }, h('a', { href: `#/sensors/${job.id}` }, 'Heat map, threshold and table'))));
    if (job.kind === 'study') this.#showStudy().catch(() => {});
    else fill(this.kind, result && this.resultKey, () => resultOfKind(job, result));
    const warnings = result?.warnings?.length ? result.warnings : job.warnings || [];
    fill(this.warnings, warnings, () => (warnings.length ? parts.warnings(warnings) : []));
    fill(this.plan, result?.plan, () => (result?.plan ? parts.plan(result.plan) : []));
    fill(this.health, result?.health, () => (result?.health ? parts.health(result.health) : []));
    fill(this.facts, [job.state, job.technique, job.finished, job.attempts, job.runner], () => parts.jobFacts(job));
    const staged = job.kind !== 'study' && (job.state === 'running' || job.state === 'cancelling' || job.timings_s);
    fill(this.stages, staged && [job.state, job.stage, job.stage_percent, job.timings_s], () => (staged ? parts.section('stages', job.timings_s ? 'Time' : 'Stages', parts.stages(job)) : []));
    fill(this.maps, job.maps, () => (job.maps?.length ? parts.maps(job.maps) : []));
    fill(this.files, [job.files, job.links.files, job.evicted], () => (job.evicted ? [] : parts.files(job)));
  }

  #showProgress() {
    const { job } = this;
    const known = Number.isFinite(job.percent) && !isOver(job.state);
    this.bar.hidden = isOver(job.state);
    setAttr(this.bar, 'aria-valuenow', known ? Math.round(job.percent) : null);
    this.bar.firstChild.style.inlineSize = known ? `${job.percent}%` : '0';
  }

  #showNotice() {
    const { job } = this;
    const problem = job.error && new JobFailed(job.error);
    const text = problem ? problem.message
      : job.evicted ? `The results were removed on ${fullMoment(job.evicted)} to make room for others. Run the job again to get them back.`
        : job.state === 'cancelled' ? 'It was cancelled before its end.' : '';
    fill(this.notice, text, () => text && h('p', { class: problem ? 'notice' : 'notice calm' }, text));
  }

  #showActions() {
    const { job, app } = this;
    const over = isOver(job.state), may = app.session.may('submit');
    const next = this.result?.cost?.next;
    fill(this.actions, [job.state, may, job.kind, next?.halve_s, !!job.accuracy, this.result?.views?.length > 0], () => {
      if (!may) return [];
      const button = (words, act, more) => h('button', { type: 'button', ...more, onclick: (event) => this.#act(event.currentTarget, act) }, words);
      if (!over) return job.state === 'cancelling' ? [] : button('Cancel', () => this.#cancel());
      const canHalve = job.kind === 'render' && job.state === 'succeeded' && Number.isFinite(next?.error) && next.error > 0 && Number.isFinite(next?.halve_s);
      return [button('Remove', () => this.#remove(), { class: 'plain' }),
        this.result?.views?.length > 0 && button('Another view', () => this.#turn()),
        button('Run again', () => this.#again((document) => copyDocument(document))),
        canHalve && button(`Halve the error, about ${duration(next.halve_s)}`, () => this.#again((document) => withHalfError(document, this.result)), { class: 'main' })];
    });
  }

  async #act(button, act) {
    button.disabled = true;
    try {
      await act();
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice', role: 'alert' }, explain(error)));
    }
    button.disabled = false;
  }

  async #cancel() {
    await client.job(this.job.id).cancel();
    await this.#look();
  }

  async #remove() {
    if (!confirm(`Remove ${jobName(this.job)} and its results?`)) return;
    await client.job(this.job.id).remove();
    location.hash = '#/jobs';
  }

  async #turn() {
    const document = await client.job(this.job.id).document();
    const { askForView } = await import('./view_dialog.js');
    const found = await askForView(document.views[0]);
    if (!found) return;
    const job = await client.submit(withViewpoint(document, found.name, found.view));
    location.hash = `#/jobs/${job.id}`;
  }

  async #showStudy() {
    const { StudyPart, jobOf } = await import('./study/study_part.js');
    if (this.closed) return;
    if (!this.study) {
      const start = (point) => this.#again((document) => jobOf(document, point)).catch((error) => this.notice.replaceChildren(h('p', { class: 'notice', role: 'alert' }, explain(error))));
      this.study = new StudyPart(this.app.session.may('submit') ? start : null);
      this.kind.append(this.study.node);
    }
    this.study.show(this.job, this.result);
  }

  async #again(change) {
    const document = await client.job(this.job.id).document();
    const job = await client.submit(change(document));
    location.hash = `#/jobs/${job.id}`;
  }

  #showAccuracy() {
    const { accuracy } = this.job;
    const course = accuracy?.course || [];
    const next = this.result?.cost?.next;
    const goal = accuracy?.asked.relative_error ?? null;
    fill(this.accuracy, accuracy && [accuracy, next, isOver(this.job.state)], () => {
      if (!accuracy) return [];
      const { deadline_s: deadline } = accuracy.asked, rounds = `after ${accuracy.rounds} round${accuracy.rounds === 1 ? '' : 's'}`;
      const now = accuracy.asked.dgp_error ? accuracy.achieved?.toPrecision(2) : percent(accuracy.achieved ?? NaN);
      if (!this.chart && course.length > 1) this.chart = new ErrorChart();
      return parts.section('accuracy', 'Error',
        h('p', { class: 'figure' }, h('strong', {}, now), h('span', {}, deadline ? ` ${rounds}; ${duration(deadline)} are allowed` : ` of ${GOALS(accuracy.asked)} asked for, ${rounds}`)),
        course.length > 1 && this.chart.node,
        isOver(this.job.state) && h('p', { class: 'quiet' }, sentence(accuracy.why), next?.one_percent_s > 0 && ` For 1\u202f% such a job takes about ${duration(next.one_percent_s)}.`));
    });
    if (course.length > 1) this.chart?.show({ points: course, goal }).catch(() => {});
  }
}

const sentence = (text) => (text ? `${text[0].toUpperCase()}${text.slice(1)}.` : '');
