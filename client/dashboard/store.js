// What the page knows of jobs: summaries, as the stream of events and lists bring them.

import { ask, nextOf } from './api.js';

export class Store extends EventTarget {
  jobs = new Map();   // id -> JobSummary
  #asked = new Set(); // of each list that is on its way, what events told meanwhile: id -> JobSummary, or null

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

  // A page of them, newest first, for use({jobs, next, came}). Events may be faster than a list, and know
  // better: jobs are as they tell them, and came has all that they told of since the list was asked for.
  async page(address, use) {
    const since = new Map();
    this.#asked.add(since);
    try {
      const answer = await ask(address);
      const listed = (await answer.json()).jobs;
      const jobs = listed.map((job) => (since.has(job.id) ? since.get(job.id) : job)).filter(Boolean);
      for (const job of jobs) this.jobs.set(job.id, job);
      use({ jobs, next: nextOf(answer), came: [...since.values()].filter(Boolean) });
    } finally {
      this.#asked.delete(since);
    }
  }
}
