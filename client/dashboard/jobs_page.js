// The table of jobs: later pages on request, rows updated by events.

import { explain } from './api.js';
import { h, say, setText } from './dom.js';
import { count, isOver, jobName, shortId, stateName } from './format.js';
import { COLUMNS, JobList } from './job_list.js';

const PAGE = 100;
const AGAIN_MS = 2000; // delay before a failed list is requested again
const STATES = ['running', 'queued', 'succeeded', 'failed', 'cancelled'];

// Filters in the address: "#/jobs?state=failed&tag=x".
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
    return h('div', { class: 'empty' }, h('p', {}, 'No job matches these filters.'), h('p', {}, h('a', { href: '#/jobs' }, 'All jobs')));
  return h('div', { class: 'empty' },
    h('h2', {}, 'No jobs yet'),
    h('p', {}, 'Jobs appear here when they are submitted from this page, the command line or a program:'),
    h('pre', {}, 'oriel submit job.json --wait'));
}

export class JobsPage {
  title = 'Jobs';

  constructor(app, params) {
    this.app = app;
    this.filters = new Filters(params);
    this.list = new JobList(app.store, this.filters);
    this.more = h('div', { class: 'more' });
    this.summary = h('p', { class: 'quiet', id: 'jobs-summary' }, 'Loading');
    this.holder = h('div', {});
    this.table = h('table', { class: 'jobs', role: 'table', 'aria-describedby': 'jobs-summary' },
      h('caption', { class: 'unseen' }, 'Jobs, newest first'),
      h('thead', { role: 'rowgroup' }, h('tr', { role: 'row' }, COLUMNS.map(([key, label]) => h('th', { class: `c-${key}`, scope: 'col', role: 'columnheader' }, label)))),
      this.list.body);
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
    clearTimeout(this.again);
  }

  #controls() {
    const { params } = this.filters;
    const choose = h('select', { id: 'state', onchange: (event) => { location.hash = this.filters.address({ state: event.target.value }); } },
      h('option', { value: '' }, 'All states'),
      STATES.map((state) => h('option', { value: state, selected: params.get('state') === state }, stateName(state))));
    const chips = [...params].filter(([name]) => name !== 'state').map(([name, value]) => {
      const words = name === 'scene' ? `scene ${shortId(value)}` : value;
      return h('a', { class: 'chip', href: this.filters.address({ [name]: '' }), 'aria-label': `Remove the filter ${words}` }, words, h('span', { 'aria-hidden': 'true' }, ' \u00d7'));
    });
    return h('div', { class: 'controls' }, chips, h('label', { class: 'unseen', for: 'state' }, 'State'), choose);
  }

  async #load() {
    const loading = (this.loading = {});
    clearTimeout(this.again);
    try {
      await this.app.store.page(this.filters.query, (page) => {
        if (loading !== this.loading) return;
        if (this.list.settle(page)) this.#next(page.next);
        this.#count();
      });
    } catch (error) {
      if (loading !== this.loading) return;
      if (this.list.size === 0) this.#fail(error);
      else this.again = setTimeout(() => this.#load(), AGAIN_MS);
    }
  }

  #fail(error) {
    setText(this.summary, '');
    this.holder.replaceChildren(h('p', { class: 'notice' }, explain(error)),
      h('button', { type: 'button', onclick: () => this.#load() }, 'Try again'));
  }

  // The button is kept while there are more jobs, so that it keeps the focus.
  #next(next) {
    this.older ||= h('button', { type: 'button', onclick: () => this.#loadMore() }, 'Older jobs');
    if (next && !this.older.isConnected) this.more.append(this.older);
    const left = !next && document.activeElement === this.older;
    if (!next) this.older.remove();
    if (left) this.list.focusLast();
    this.watcher.disconnect();
    if (next) this.watcher.observe(this.more);
  }

  async #loadMore() {
    const { next } = this.list;
    if (!next || this.busy) return;
    this.busy = true;
    try {
      await this.app.store.page(next, (page) => {
        if (!this.list.append(page, next)) return;
        this.#next(page.next);
        this.#count();
      });
    } catch { /* the button stays */ }
    this.busy = false;
  }

  #count() {
    const { list } = this;
    const states = [list.running && `${count(list.running)} running`, list.waiting && `${count(list.waiting)} waiting`].filter(Boolean);
    const all = `${list.next ? 'the newest ' : ''}${count(list.size)}${list.next ? '' : ` job${list.size === 1 ? '' : 's'}`}`;
    setText(this.summary, list.size ? `${all[0].toUpperCase()}${all.slice(1)}${states.length ? `: ${states.join(', ')}` : ''}` : '');
    if (!list.size) this.holder.replaceChildren(empty(this.filters));
    else if (this.holder.firstChild !== this.table) this.holder.replaceChildren(this.table);
  }

  #take(job, before) {
    const changed = this.list.take(job, before);
    if (before && before.state !== job.state && isOver(job.state)) say(`${jobName(job)}: ${stateName(job.state)}`);
    if (changed) this.#count();
  }

  #remove(id) {
    if (this.list.remove(id)) this.#count();
  }
}
