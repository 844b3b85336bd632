// Requests to the daemon. A refusal is thrown as a Problem (RFC 9457).

export class Problem extends Error {
  constructor(status, document) {
    super(document.detail || document.title || `HTTP ${status}`);
    this.status = status;
    this.document = document;
    this.kind = String(document.type || '').replace('urn:oriel:error:', '');
  }
  // The whole problem in sentences: the reason, the place and the hint.
  get sentence() {
    const { title, detail, file, line, primitive, hint } = this.document;
    const place = file ? ` (${file}${line ? `, line ${line}` : ''})` : primitive ? ` (${primitive})` : '';
    const more = hint ? ` ${hint[0].toUpperCase()}${hint.slice(1)}.` : '';
    return `${title || 'Refused'}: ${detail || ''}${place}.${more}`.replace(/([.?!])\.+/g, '$1');
  }
}

export const signals = new EventTarget(); // 'signed-out'

// Sends a request and returns the response. Throws a Problem, or a TypeError if the daemon does not answer.
export async function ask(path, options = {}) {
  const { json, headers, ...rest } = options;
  const request = { credentials: 'same-origin', cache: 'no-cache', ...rest, headers: { Accept: 'application/json', ...headers } };
  if (json !== undefined) {
    request.method ||= 'POST';
    request.body = JSON.stringify(json);
    request.headers['Content-Type'] = 'application/json';
  }
  const answer = await fetch(path, request);
  if (answer.ok) return answer;
  if (answer.status === 401) signals.dispatchEvent(new Event('signed-out'));
  const document = await answer.json().catch(() => ({ title: `HTTP ${answer.status}` }));
  throw new Problem(answer.status, document);
}

export async function get(path, options) {
  return (await ask(path, options)).json();
}

export async function post(path, json, options) {
  return (await ask(path, { method: 'POST', json, ...options })).json();
}

// The address in rel="next" of a Link header (RFC 8288), or null.
export function nextOf(answer) {
  const found = /<([^>]+)>\s*;\s*rel="next"/.exec(answer.headers.get('Link') || '');
  return found ? found[1] : null;
}

export const jobPath = (id) => `/v1/jobs/${encodeURIComponent(id)}`;
export const filePath = (id, name) => `${jobPath(id)}/files/${encodeURIComponent(name)}`;

export function explain(error) {
  if (error instanceof Problem) return error.sentence;
  if (error instanceof TypeError) return 'The daemon does not answer.';
  const words = String(error.message || error);
  return `${words[0].toUpperCase()}${words.slice(1)}${/[.!?]$/.test(words) ? '' : '.'}`;
}
