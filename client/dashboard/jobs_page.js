// The table of jobs: pages as one scrolls, rows that change as the stream of events has it.

import { explain } from './api.js';
import { h, say, setAttr, setText, fill } from './dom.js';
import { NONE, count, duration, fullMoment, isOver, jobName, moment, percent, shortId, stageName, stateName } from './format.js';

const PAGE = 100;
const COLUMNS = [
  ['name', 'Name'], ['scene', 'Scene'], ['state', 'State'], ['progress', 'Progress'], ['eta', 'Time'],
  ['error', 'Error'], ['when', 'Submitted'],
];
const STATES = ['running', 'queued', 'succeeded', 'failed', 'cancelled'];

function stateWords(job) {
  if (job.state === 'running' && job.stage) return stageName(job.stage);
  if (job.state === 'queued' && job.queue_position) return `Waiting, ${job.queue_position === 1 ? 'next' : `place ${count(job.queue_position)}`}`;
  return stateName(job.state);
}

function timeWords(job) {
  if (!isOver(job.state)) return Number.isFinite(job.eta_s) ? `${duration(job.eta_s)} left` : NONE;
  return job.started && job.finished ? duration((new Date(job.finished) - new Date(job.started)) / 1000) : NONE;
}

// One line of the table, changed where the job has.
class Row {
  constructor(job, filters) {
    this.cells = Object.fromEntries(COLUMNS.map(([key, label]) => [key, h('td', { class: `c-${key}`, role: 'cell', 'data-label': label })]));
    this.link = h('a', { href: `#/jobs/${job.id}` });
    this.under = h('span', { class: 'under' });
    this.bar = h('span', { class: 'bar', role: 'progressbar', 'aria-valuemin': 0, 'aria-valuemax': 100 }, h('span'));
    this.share = h('span', { class: 'share' });
    this.dot = h('span', { class: 'dot', 'aria-hidden': 'true' });
    this.word = h('span');
    this.cells.name.append(this.link, this.under);
    this.cells.scene.append(h('a', { href: filters.address({ scene: job.scene }), class: 'mono', 'aria-label': `Jobs of scene ${shortId(job.scene)}` }, shortId(job.scene)));
    this.cells.state.append(this.dot, this.word);
    this.cells.progress.append(this.bar, this.share);
    this.node = h('tr', { role: 'row' }, Object.values(this.cells));
    this.filters = filters;
    this.update(job);
  }

  update(job) {
    const known = Number.isFinite(job.percent);
    setText(this.link, jobName(job));
    fill(this.under, [job.tags, job.name], () => [
      job.name ? h('span', { class: 'mono' }, shortId(job.id)) : job.kind,
      job.tags.map((tag) => h('a', { class: 'tag', href: this.filters.address({ tag }) }, tag)),
    ]);
    setAttr(this.node, 'data-state', job.state);
    setAttr(this.node, 'data-created', job.created);
    setText(this.word, stateWords(job));
    setAttr(this.bar, 'aria-label', `Progress of ${jobName(job)}`);
    setAttr(this.bar, 'aria-valuenow', known ? Math.round(job.percent) : null);
    this.bar.firstChild.style.inlineSize = known ? `${job.percent}%` : '0';
    this.bar.hidden = isOver(job.state);
    setText(this.share, known && !isOver(job.state) ? `${Math.floor(job.percent)}\u202f%` : '');
    setText(this.cells.eta, timeWords(job));
    setText(this.cells.error, percent(job.error ?? NaN));
    setAttr(this.cells.error, 'data-none', Number.isFinite(job.error) ? null : '');
    setText(this.cells.when, moment(job.created));
    setAttr(this.cells.when, 'title', fullMoment(job.created));
  }
}

// What of the address narrows the list: "#/jobs?state=failed&tag=x".
class Filters {
  constructor(params) {
    this.params = params;
  }
  address(change) {
    const params = new URLSearchParams(this.params);
    for (const [name, value] of Object.entries(change)) value ? params.set(name, value) : params.delete(name);
    return `#/jobs${params.size ? `?${params}` : ''}`;
  }
  get query() {
    return `/v1/jobs?fields=summary&limit=${PAGE}${this.params.size ? `&${this.params}` : ''}`;
  }
  takes(job) {
    const { params } = this;
    const state = params.get('state');
    return (!state || job.state === state) && (!params.get('scene') || job.scene === params.get('scene')) &&
      params.getAll('tag').every((tag) => job.tags.includes(tag));
  }
}

function empty(filters) {
  if (filters.params.size)
    return h('div', { class: 'empty' }, h('p', {}, 'No job is like that.'), h('p', {}, h('a', { href: '#/jobs' }, 'All jobs')));
  return h('div', { class: 'empty' },
    h('h2', {}, 'No jobs yet'),
    h('p', {}, 'Those that are submitted appear here by themselves, from this page, the command or a program:'),
    h('pre', {}, 'oriel submit job.json --wait'));
}

export class JobsPage {
  title = 'Jobs';

  constructor(app, params) {
    this.app = app;
    this.filters = new Filters(params);
    this.rows = new Map();
    this.body = h('tbody', { role: 'rowgroup' });
    this.more = h('div', { class: 'more' });
    this.summary = h('p', { class: 'quiet', id: 'jobs-summary' }, 'Loading');
    this.holder = h('div', {});
    this.table = h('table', { class: 'jobs', role: 'table', 'aria-describedby': 'jobs-summary' },
      h('caption', { class: 'unseen' }, 'Jobs, newest first'),
      h('thead', { role: 'rowgroup' }, h('tr', { role: 'row' }, COLUMNS.map(([key, label]) => h('th', { class: `c-${key}`, scope: 'col', role: 'columnheader' }, label)))),
      this.body);
    this.node = h('div', { class: 'page' },
      h('div', { class: 'head' }, h('div', {}, h('h1', { tabindex: -1 }, 'Jobs'), this.summary), this.#controls()),
      this.holder, this.more);
    this.watcher = new IntersectionObserver((seen) => seen.some((one) => one.isIntersecting) && this.#loadMore(), { rootMargin: '600px' });
    this.heard = new AbortController();
    const { signal } = this.heard;
    app.store.addEventListener('job', (event) => this.#take(event.job, event.before), { signal });
    app.store.addEventListener('removed', (event) => this.#remove(event.id), { signal });
    app.store.addEventListener('reset', () => this.#load(), { signal });
    this.#load();
  }

  close() {
    this.heard.abort();
    this.watcher.disconnect();
  }

  #controls() {
    const { params } = this.filters;
    const choose = h('select', { id: 'state', onchange: (event) => { location.hash = this.filters.address({ state: event.target.value }); } },
      h('option', { value: '' }, 'All states'),
      STATES.map((state) => h('option', { value: state, selected: params.get('state') === state }, stateName(state))));
    const chips = [...params].filter(([name]) => name !== 'state').map(([name, value]) => {
      const words = name === 'scene' ? `scene ${shortId(value)}` : value;
      return h('a', { class: 'chip', href: this.filters.address({ [name]: '' }), 'aria-label': `No longer only ${words}` }, words, h('span', { 'aria-hidden': 'true' }, ' \u00d7'));
    });
    return h('div', { class: 'controls' }, chips, h('label', { class: 'unseen', for: 'state' }, 'State'), choose);
  }

  async #load() {
    const loading = (this.loading = {});
    try {
      const { jobs, next } = await this.app.store.page(this.filters.query);
      if (loading !== this.loading) return;
      this.#settle(jobs, next);
    } catch (error) {
      if (loading === this.loading && this.rows.size === 0) this.#fail(error);
    }
  }

  // The newest are these; those beyond, once loaded, stay as they are.
  #settle(jobs, next) {
    const listed = new Set(jobs.map((job) => job.id));
    const oldest = jobs.at(-1)?.created;
    for (const [id, row] of this.rows)
      if (!listed.has(id) && (!next || row.node.dataset.created >= oldest)) this.#remove(id);
    const first = this.rows.size === 0;
    for (const job of jobs) {
      if (this.rows.has(job.id)) this.rows.get(job.id).update(job);
      else if (!first) this.#insert(job);
    }
    if (first) {
      this.#append(jobs);
      this.#next(next);
    }
    this.#count();
  }

  #fail(error) {
    setText(this.summary, '');
    this.holder.replaceChildren(h('p', { class: 'notice' }, explain(error)),
      h('button', { type: 'button', onclick: () => this.#load() }, 'Try again'));
  }

  #append(jobs) {
    for (const job of jobs) {
      if (this.rows.has(job.id)) continue;
      const row = new Row(job, this.filters);
      this.rows.set(job.id, row);
      this.body.append(row.node);
    }
  }

  #next(next) {
    this.next = next;
    this.more.replaceChildren(...(next ? [h('button', { type: 'button', onclick: () => this.#loadMore() }, 'Older jobs')] : []));
    this.watcher.disconnect();
    if (next) this.watcher.observe(this.more);
  }

  async #loadMore() {
    if (!this.next || this.busy) return;
    this.busy = true;
    const loading = this.loading;
    try {
      const { jobs, next } = await this.app.store.page(this.next);
      if (loading === this.loading) {
        this.#append(jobs);
        this.#next(next);
        this.#count();
      }
    } catch { /* the button stays */ }
    this.busy = false;
  }

  #count() {
    const states = [...this.rows.keys()].map((id) => this.app.store.jobs.get(id)?.state);
    const running = states.filter((state) => state === 'running' || state === 'cancelling').length;
    const waiting = states.filter((state) => state === 'queued').length;
    const words = [running && `${count(running)} running`, waiting && `${count(waiting)} waiting`,
      `${count(this.rows.size)}${this.next ? ' of more' : ''} shown`].filter(Boolean);
    if (this.rows.size) setText(this.summary, words.join(' \u00b7 '));
    else setText(this.summary, '');
    const wanted = this.rows.size ? this.table : empty(this.filters);
    if (this.rows.size ? this.holder.firstChild !== this.table : true) this.holder.replaceChildren(wanted);
  }

  #take(job, before) {
    const row = this.rows.get(job.id);
    if (!this.filters.takes(job)) this.#remove(job.id);
    else if (row) row.update(job);
    else if (!before || !isOver(job.state)) this.#insert(job);
    if (before && before.state !== job.state && isOver(job.state)) say(`${jobName(job)}: ${stateName(job.state)}`);
    if (!before || before.state !== job.state) this.#count();
  }

  // In its place: the newest first. What is older than all that are shown is on a later page.
  #insert(job) {
    const after = [...this.body.rows].find((node) => node.dataset.created <= job.created);
    if (!after && this.next) return;
    const row = new Row(job, this.filters);
    this.rows.set(job.id, row);
    this.body.insertBefore(row.node, after || null);
  }

  #remove(id) {
    const row = this.rows.get(id);
    if (!row) return;
    row.node.remove();
    this.rows.delete(id);
    this.#count();
  }
}
