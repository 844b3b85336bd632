// The stream of all jobs' events. It is read with fetch(), so that the position and reason of a break are known.
// The connection is closed while the page is hidden: browsers allow six connections per daemon for all tabs.

import { Problem } from './api.js';

const SILENCE_MS = 45000; // the daemon sends something every 15 s
const WAITS_MS = [250, 500, 1000, 2000, 4000];

// Parses one block of lines to {id, event, data}.
function parse(block) {
  const found = { id: null, event: 'message', data: '' };
  for (const line of block.split('\n')) {
    const at = line.indexOf(':');
    if (at > 0) found[line.slice(0, at)] = line.slice(at + 1).replace(/^ /, '');
  }
  return found;
}

export class Stream extends EventTarget {
  #last = null;
  #abort = null;
  #tries = 0;
  #timer = 0;
  state = 'off'; // 'connecting', 'live', 'lost', 'refused', 'old'

  constructor(path) {
    super();
    this.path = path;
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
      if (error instanceof Problem && (error.status === 401 || error.status === 403)) {
        this.#abort = null;
        this.#become('refused');
        return;
      }
      if (error instanceof Problem && error.status === 404) {
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

  async #read(abort) {
    const headers = { Accept: 'text/event-stream' };
    if (this.#last) headers['Last-Event-ID'] = this.#last;
    const answer = await fetch(this.path, { headers, signal: abort.signal, cache: 'no-store' });
    if (!answer.ok) throw new Problem(answer.status, {});
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    let text = '', watch = 0;
    this.#tries = 0;
    this.#become('live');
    for (;;) {
      clearTimeout(watch);
      watch = setTimeout(() => abort.abort(), SILENCE_MS);
      const { value, done } = await reader.read().finally(() => clearTimeout(watch));
      if (done) return;
      text += value;
      const blocks = text.split('\n\n');
      text = blocks.pop();
      for (const block of blocks) this.#take(parse(block));
    }
  }

  #take({ id, event, data }) {
    if (id) this.#last = id;
    if (data) this.dispatchEvent(Object.assign(new Event(event), { detail: JSON.parse(data) }));
  }
}
