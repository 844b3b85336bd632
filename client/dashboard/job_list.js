// Rows of jobs, newest first, from pages of the list and from events.

import { h, setAttr, setText, fill } from './dom.js';
import { NONE, count, duration, fullMoment, isOver, jobName, moment, percent, shortId, stageName, stateName } from './format.js';

export const COLUMNS = [
  ['name', 'Name'], ['scene', 'Scene'], ['state', 'State'], ['progress', 'Progress'], ['eta', 'Time'],
  ['error', 'Error'], ['when', 'Submitted'],
];

function stateWords(job) {
  if (job.state === 'running' && job.stage) return stageName(job.stage);
  if (job.state === 'queued' && job.queue_position) return `Waiting, ${job.queue_position === 1 ? 'next' : `place ${count(job.queue_position)}`}`;
  return stateName(job.state);
}

function timeWords(job) {
  if (!isOver(job.state)) return Number.isFinite(job.eta_s) ? `${duration(job.eta_s)} left` : NONE;
  return job.started && job.finished ? duration((new Date(job.finished) - new Date(job.started)) / 1000) : NONE;
}

// One row of the table. Only changed cells are updated.
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

  get created() {
    return this.node.dataset.created;
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
    const time = timeWords(job);
    setText(this.cells.eta, time);
    setAttr(this.cells.eta, 'data-none', time === NONE ? '' : null);
    setText(this.cells.error, percent(job.error ?? NaN));
    setAttr(this.cells.error, 'data-none', Number.isFinite(job.error) ? null : '');
    setText(this.cells.when, moment(job.created));
    setAttr(this.cells.when, 'title', fullMoment(job.created));
  }
}

export class JobList {
  body = h('tbody', { role: 'rowgroup' });
  next = null;      // address of the next page
  #rows = new Map();
  #settled = false; // a page has arrived

  constructor(store, filters) {
    this.store = store;
    this.filters = filters;
  }

  get size() {
    return this.#rows.size;
  }
  get running() {
    return this.#having('running') + this.#having('cancelling');
  }
  get waiting() {
    return this.#having('queued');
  }
  #having(state) {
    return [...this.#rows.keys()].filter((id) => this.store.jobs.get(id)?.state === state).length;
  }

  // Merges the newest page and the jobs of events since its request. If the page overlaps the known rows,
  // later pages stay. Otherwise jobs between them may be missing: returns true, and later pages are reloaded.
  settle({ jobs, next, came }) {
    const listed = new Set(jobs.map((job) => job.id)), told = new Set(came.map((job) => job.id));
    const joins = this.#settled && jobs.some((job) => this.#rows.has(job.id) && !told.has(job.id));
    const oldest = jobs.at(-1)?.created;
    for (const [id, row] of this.#rows) {
      const goes = !next || row.created > oldest ? !told.has(id) : !joins;
      if (goes && !listed.has(id)) this.remove(id);
    }
    let before = null;
    for (const job of jobs) if (this.filters.takes(job)) before = this.#follow(before, job);
    this.#settled = true;
    if (!joins) this.next = next;
    for (const job of came) if (this.filters.takes(job)) this.#insert(job);
    return !joins;
  }

  // Adds a later page, unless the list was restarted since the request.
  append({ jobs, next }, asked) {
    if (asked !== this.next) return false;
    for (const job of jobs) if (this.filters.takes(job) && !this.#rows.has(job.id)) this.body.append(this.#make(job).node);
    this.next = next;
    return true;
  }

  // Takes a job from an event. Returns true if the summary of the list may have changed.
  take(job, before) {
    const row = this.#rows.get(job.id);
    if (!this.filters.takes(job)) return this.remove(job.id);
    if (row) row.update(job);
    else if (this.#settled && (!before || !isOver(job.state))) this.#insert(job);
    return this.#settled && before?.state !== job.state;
  }

  remove(id) {
    const row = this.#rows.get(id);
    row?.node.remove();
    return this.#rows.delete(id);
  }

  focusLast() {
    this.body.lastElementChild?.querySelector('a').focus();
  }

  #make(job) {
    const row = new Row(job, this.filters);
    this.#rows.set(job.id, row);
    return row;
  }

  // Returns the job's row. A new row is inserted after `before`.
  #follow(before, job) {
    const known = this.#rows.get(job.id);
    if (known) {
      known.update(job);
      return known;
    }
    const row = this.#make(job);
    if (before) before.node.after(row.node);
    else this.#place(row);
    return row;
  }

  // Inserts the row at its place. Jobs older than all rows are on a later page.
  #insert(job) {
    if (this.#rows.has(job.id)) return;
    if (this.next && !(this.body.lastElementChild?.dataset.created <= job.created)) return;
    this.#place(this.#make(job));
  }

  #place(row) {
    const after = [...this.body.rows].find((node) => node.dataset.created <= row.created);
    this.body.insertBefore(row.node, after || null);
  }
}
