// What the page knows of jobs: summaries, as the stream of events and lists bring them.

import { ask, nextOf } from './api.js';

export class Store extends EventTarget {
  jobs = new Map(); // id -> JobSummary

  constructor(stream) {
    super();
    stream.addEventListener('job', (event) => this.take(event.detail));
    stream.addEventListener('removed', (event) => this.#drop(event.detail.id));
    stream.addEventListener('reset', () => this.dispatchEvent(new Event('reset')));
  }

  take(job) {
    const before = this.jobs.get(job.id);
    this.jobs.set(job.id, job);
    this.dispatchEvent(Object.assign(new Event('job'), { job, before }));
  }

  #drop(id) {
    this.jobs.delete(id);
    this.dispatchEvent(Object.assign(new Event('removed'), { id }));
  }

  // A page of them, newest first: {jobs, next}. Those seen are known from then on.
  async page(address) {
    const answer = await ask(address);
    const { jobs } = await answer.json();
    for (const job of jobs) this.jobs.set(job.id, job);
    return { jobs, next: nextOf(answer) };
  }
}
