// State of the daemon from /metrics and /readyz: queue, memory, disk, connections, rates.

import { client, explain } from './api.js';
import { Problem } from './oriel.js';
import { fill, h, setText } from './dom.js';
import { NONE, bytes, count, duration, number } from './format.js';
import { facts, section } from './job_parts.js';

const EVERY_MS = 2000;

// Parses Prometheus text to a map from "name{labels}" to the value.
export function parse(text) {
  const found = new Map();
  for (const line of text.split('\n')) {
    const at = line.lastIndexOf(' ');
    if (at > 0 && !line.startsWith('#')) found.set(line.slice(0, at), Number(line.slice(at + 1)));
  }
  return found;
}

const sumOf = (metrics, start) => [...metrics].reduce((sum, [name, value]) => (name.startsWith(start) ? sum + value : sum), 0);

function meter(label, used, of) {
  const share = of > 0 ? Math.min(1, used / of) : 0;
  const bar = h('span', {});
  bar.style.inlineSize = `${100 * share}%`;
  return h('div', { class: 'meter' }, h('div', { class: 'label' }, h('span', { class: 'name' }, label), h('output', {}, `${bytes(used)} of ${bytes(of)}`)),
    h('span', { class: 'bar wide', role: 'meter', 'aria-label': label, 'aria-valuenow': Math.round(100 * share), 'aria-valuemin': 0, 'aria-valuemax': 100, 'aria-valuetext': `${bytes(used)} of ${bytes(of)}` }, bar));
}

export class OperationsPage {
  title = 'Operations';

  constructor() {
    this.word = h('p', { class: 'quiet' }, 'Loading');
    this.notice = h('div', {});
    for (const name of ['jobs', 'work', 'memory', 'service', 'trouble']) this[name] = h('div', {});
    this.node = h('div', { class: 'page' }, h('div', { class: 'head' }, h('div', {}, h('h1', { tabindex: -1 }, 'Operations'), this.word)), this.notice,
      h('div', { class: 'job-main stacked' }, this.jobs, this.work, this.memory, this.service, this.trouble));
    this.#turn();
  }

  close() {
    clearTimeout(this.timer);
    this.closed = true;
  }

  async #turn() {
    if (!document.hidden) await this.#look();
    if (!this.closed) this.timer = setTimeout(() => this.#turn(), EVERY_MS);
  }

  async #look() {
    try {
      const [text, health, ready] = await Promise.all([client.request('GET', '/metrics', { headers: { Accept: 'text/plain' } }).then((answer) => answer.text()), client.health(),
        client.get('/readyz').catch((error) => (error instanceof Problem ? error.document : Promise.reject(error)))]);
      const now = { at: performance.now() / 1000, metrics: parse(text) };
      this.notice.replaceChildren();
      this.#show(now, health, ready);
      this.before = now;
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
    }
  }

  // Rate per second since the last update.
  #rate(now, name) {
    const { before } = this;
    if (!before) return NaN;
    return (sumOf(now.metrics, name) - sumOf(before.metrics, name)) / (now.at - before.at);
  }

  #show(now, health, ready) {
    const { metrics } = now;
    const value = (name) => metrics.get(name) ?? NaN;
    const rate = (name) => { const found = this.#rate(now, name); return Number.isFinite(found) ? number(found, 3) : NONE; };
    const words = { ready: 'Accepts jobs', busy: 'Busy: all threads for files are in use', 'queue full': 'The queue is full', stopping: 'Stopping' };
    setText(this.word, `${words[ready.status] || ready.status || 'Not ready'} \u00b7 version ${health.version} \u00b7 up ${duration(health.uptime_s)}`);
    const states = ['running', 'queued', 'succeeded', 'failed', 'cancelled'];
    const labels = ['Running', 'Waiting', 'Succeeded', 'Failed', 'Cancelled'];
    const jobs = states.map((state, i) => [labels[i], count(value(`oriel_jobs{state="${state}"}`))]);
    fill(this.jobs, jobs, () => section('ops-jobs', 'Jobs', facts(jobs)));
    const cores = this.#rate(now, 'process_cpu_seconds_total');
    const work = [['Rays of finished jobs', number(value('oriel_rays_total'), 3)], ['Photons of finished jobs', number(value('oriel_photons_total'), 3)], ['Cores busy', Number.isFinite(cores) ? cores.toFixed(2) : NONE],
      ['Maps found in the cache', count(value('oriel_cache_hits_total'))], ['Maps built', count(value('oriel_cache_misses_total'))]];
    fill(this.work, work, () => section('ops-work', 'Work', facts(work)));
    this.#showRoom(value);
    const service = [['Requests a second', rate('oriel_http_request_seconds_count')], ['Connections', count(value('oriel_http_connections'))], ['Event streams', count(value('oriel_event_streams'))],
      ['Longest loop iteration', duration(value('oriel_loop_longest_turn_seconds'))], ['Wait for a thread', duration(value('oriel_pool_wait_seconds'))]];
    fill(this.service, service, () => section('ops-service', 'Service', facts(service)));
    const trouble = [['Jobs failed', sumOf(metrics, 'oriel_job_runs_total{state="failed"}')], ['Evictions', sumOf(metrics, 'oriel_evictions_total')], ['Slow clients disconnected', value('oriel_http_slow_clients_total')],
      ['Damaged files', value('oriel_scrub_damaged_total')], ['Values that were not finite', value('oriel_health_total{what="non_finite"}')]].map(([name, found]) => [name, count(found)]);
    fill(this.trouble, trouble, () => section('ops-trouble', 'Since it started', facts(trouble)));
  }

  #showRoom(value) {
    const kept = ['maps', 'bsdfs', 'results', 'uploads'].map((kind) => value(`oriel_storage_bytes{kind="${kind}"}`));
    const capacity = value('oriel_memory_capacity_bytes'), free = value('oriel_memory_free_bytes');
    const room = [['Memory for jobs and checks', capacity - free, capacity], ['Kept on disk', kept.reduce((a, b) => a + b, 0), value('oriel_storage_budget_bytes')]];
    fill(this.memory, [room, kept], () => section('ops-room', 'Room', h('div', { class: 'meters' }, room.map((one) => meter(...one))),
      facts([['Maps', bytes(kept[0])], ['Loaded BSDFs', bytes(kept[1])], ['Results', bytes(kept[2])], ['Uploads', bytes(kept[3])], ['The daemon itself', bytes(value('process_resident_memory_bytes'))]])));
  }
}
