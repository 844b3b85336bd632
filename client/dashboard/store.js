// Summaries of all known jobs, from events and lists.

import { client } from './api.js';
import { nextPage } from './oriel.js';

export class Store extends EventTarget {
  jobs = new Map();   // id -> JobSummary
  #asked = new Set(); // for each list request under way, jobs of events since: id -> JobSummary, or null

  constructor(stream) {
    super();
    stream.addEventListener('job', (event) => this.#take(event.detail));
    stream.addEventListener('removed', (event) => this.#drop(event.detail.id));
    stream.addEventListener('reset', () => this.dispatchEvent(new Event('reset')));
  }

  #take(job) {
    const before = this.jobs.get(job.id);
    this.jobs.set(job.id, job);
    for (const since of this.#asked) since.set(job.id, job);
    this.dispatchEvent(Object.assign(new Event('job'), { job, before }));
  }

  #drop(id) {
    this.jobs.delete(id);
    for (const since of this.#asked) since.set(id, null);
    this.dispatchEvent(Object.assign(new Event('removed'), { id }));
  }

  // Fetches a page of jobs, newest first, and calls use({jobs, next, came}). Events since the request are
  // newer than the list: they replace its summaries, and came has the jobs of all of them.
  async page(address, use) {
    const since = new Map();
    this.#asked.add(since);
    try {
      const answer = await client.request('GET', address);
      const listed = (await answer.json()).jobs;
      const jobs = listed.map((job) => (since.has(job.id) ? since.get(job.id) : job)).filter(Boolean);
      for (const job of jobs) this.jobs.set(job.id, job);
      use({ jobs, next: nextPage(answer), came: [...since.values()].filter(Boolean) });
    } finally {
      this.#asked.delete(since);
    }
  }
}
