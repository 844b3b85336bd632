// The stream of all jobs' events, resumed after a break.
// The connection is closed while the page is hidden: browsers allow six connections per daemon for all tabs.

import { client } from './api.js';
import { Forbidden, NotFound, Unauthorized } from './oriel.js';

const WAITS_MS = [250, 500, 1000, 2000, 4000];

export class Stream extends EventTarget {
  #last = null;
  #abort = null;
  #tries = 0;
  #timer = 0;
  state = 'off'; // 'connecting', 'live', 'lost', 'refused', 'old'

  constructor() {
    super();
    document.addEventListener('visibilitychange', () => this.#look());
    addEventListener('online', () => this.#retry(0));
  }

  start() {
    this.stopped = false;
    this.#retry(0);
  }

  stop() {
    this.stopped = true;
    clearTimeout(this.#timer);
    this.#abort?.abort();
    this.#abort = null;
    this.#become('off');
  }

  #look() {
    if (this.stopped !== false) return;
    if (document.hidden) {
      clearTimeout(this.#timer);
      this.#abort?.abort();
      this.#abort = null;
    } else if (!this.#abort) {
      this.#retry(0);
    }
  }

  #become(state) {
    if (this.state === state) return;
    this.state = state;
    this.dispatchEvent(new Event('state'));
  }

  #retry(wait) {
    clearTimeout(this.#timer);
    if (!this.stopped && !document.hidden) this.#timer = setTimeout(() => this.#open(), wait);
  }

  async #open() {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    if (this.state !== 'lost') this.#become('connecting');
    try {
      await this.#read(abort);
    } catch (error) {
      if (this.#abort !== abort) return; // replaced by another connection
      if (error instanceof Unauthorized || error instanceof Forbidden) {
        this.#abort = null;
        this.#become('refused');
        return;
      }
      if (error instanceof NotFound) {
        this.#abort = null;
        this.#become('old');
        return;
      }
    }
    if (this.#abort !== abort) return;
    this.#abort = null;
    this.#become('lost');
    this.#retry(WAITS_MS[Math.min(this.#tries++, WAITS_MS.length - 1)]);
  }

  async #read({ signal }) {
    const opened = () => {
      this.#tries = 0;
      this.#become('live');
    };
    for await (const { id, event, data } of client.events({ lastId: this.#last, signal, opened })) {
      if (id) this.#last = id;
      this.dispatchEvent(Object.assign(new Event(event), { detail: data }));
    }
  }
}
