// The daemon of this page, by the JavaScript client (client/javascript/oriel.js).

import { Client, Problem, Unreachable } from './oriel.js';

export const signals = new EventTarget(); // 'signed-out'

// Nothing is repeated in silence: the page shows at once that the daemon does not answer.
export const client = new Client(location.origin, {
  retries: 0,
  async fetch(address, options) {
    const answer = await fetch(address, { credentials: 'same-origin', ...options, cache: options.cache ?? 'no-cache' });
    if (answer.status === 401) signals.dispatchEvent(new Event('signed-out'));
    return answer;
  },
});

// The address of a result file, for links and pictures.
export const filePath = (id, name) => client.job(id).filePath(name);

export function explain(error) {
  if (error instanceof Problem) return error.message;
  if (error instanceof Unreachable || error instanceof TypeError) return 'The daemon does not answer.';
  const words = String(error.message || error);
  return `${words[0].toUpperCase()}${words.slice(1)}${/[.!?]$/.test(words) ? '' : '.'}`;
}
