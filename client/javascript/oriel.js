// @ts-check
/**
 * Oriel from JavaScript: daylight renderings by a daemon, for design tools.
 *
 * One ES module for browsers and for Node 18 or later, without dependencies and without a build step.
 * It stays one file, so that it is easy to copy. README.md beside it has an example.
 *
 * All errors are OrielErrors: Problem if the daemon refuses a request (with title, detail, hint, file
 * and line), Unreachable if it does not answer, JobFailed and JobCancelled if a job ends that way.
 * Requests that change nothing, or that the daemon recognises when they are repeated, are tried again
 * after a broken connection.
 *
 * A file is a path (in Node), a File or Blob of a browser, or {name, text} or {name, bytes}.
 *
 * @typedef {Blob & {name?: string, webkitRelativePath?: string}} NamedBlob
 * @typedef {string | NamedBlob | Source | {name: string, text?: string, bytes?: Uint8Array, file?: Blob}} FileLike
 * @typedef {{signal?: AbortSignal}} Cancellable
 * @typedef {Record<string, any>} Json
 * @typedef {{json?: any, body?: any, headers?: Record<string, string>, signal?: AbortSignal,
 *            repeat?: boolean, cache?: RequestCache}} RequestOptions
 * @typedef {{main?: string[], states?: Record<string, string>, sky?: string, signal?: AbortSignal}} UploadOptions
 */

const DEFAULT_URL = 'http://127.0.0.1:8423';
const SILENCE_MS = 45000; // the daemon sends something every 15 s
const STREAM_TRIES = 3;   // streams that break before a wait polls instead
const ENDED = ['succeeded', 'failed', 'cancelled'];
const node = /** @type {any} */ (globalThis).process?.versions?.node ? /** @type {any} */ (globalThis).process : null;

// ---- Errors -----------------------------------------------------------------------------------

/** Base class of all errors of this module. */
export class OrielError extends Error {
  /** @param {string} message @param {{cause?: unknown}} [options] */
  constructor(message, options) {
    super(message, options);
    this.name = new.target.name;
  }
}

/** No daemon answers at the URL, or the connection broke. */
export class Unreachable extends OrielError {}

/** The platform or a proxy does not pass streams on: poll instead. */
class NoStream extends Unreachable {}

/** A wait took longer than its timeout. The job continues. */
export class TimedOut extends OrielError {}

/** The job was cancelled. */
export class JobCancelled extends OrielError {}

/** The daemon refused a request, or a job failed: a problem document (RFC 9457). */
export class Problem extends OrielError {
  /** @param {Json} document @param {number} [status] */
  constructor(document, status) {
    super(sentenceOf(document));
    this.document = document;
    /** @type {number | undefined} */ this.status = status ?? document.status;
    /** @type {string | undefined} */ this.type = document.type;
    /** @type {string | undefined} */ this.title = document.title;
    /** @type {string | undefined} */ this.detail = document.detail;
    /** @type {string | undefined} */ this.hint = document.hint;
    /** @type {string | undefined} */ this.file = document.file;
    /** @type {number | undefined} */ this.line = document.line;
    /** @type {string | undefined} */ this.primitive = document.primitive;
    /** Seconds after which to try again, if the daemon is busy. @type {number | null} */
    this.retryAfter = null;
  }

  /** The last part of the type, such as "no-such-resource". */
  get kind() {
    return String(this.type ?? '').replace('urn:oriel:error:', '');
  }
}

/** 401: the daemon requires an access token, or does not know the given one. */
export class Unauthorized extends Problem {}
/** 403: the token's scope does not allow this. */
export class Forbidden extends Problem {}
/** 404: the scene, job or file does not exist. */
export class NotFound extends Problem {}
/** 409: not possible in this state. */
export class InUse extends Problem {}
/** 410: the results were removed to make room. Submit the document again to get them back. */
export class Gone extends Problem {}
/** 507: the daemon has no space left, and nothing that it may remove. */
export class Full extends Problem {}
/** 429 or 503: the daemon is busy; try again after retryAfter seconds. */
export class Busy extends Problem {}
/** The job failed; the problem has the reason. */
export class JobFailed extends Problem {}

/** @type {Record<number, typeof Problem>} */
const PROBLEMS = { 401: Unauthorized, 403: Forbidden, 404: NotFound, 409: InUse, 410: Gone, 429: Busy, 503: Busy, 507: Full };

/** The whole problem in sentences: the reason, the place and the hint. @param {Json} document */
function sentenceOf({ title, detail, file, line, primitive, hint }) {
  const place = file ? ` (${file}${line ? `, line ${line}` : ''})` : primitive && !detail?.startsWith(`${primitive}:`) ? ` (${primitive})` : '';
  const more = hint ? ` ${hint[0].toUpperCase()}${hint.slice(1)}.` : '';
  const what = detail ? `${title ? `${title}: ` : ''}${detail}` : title || 'The daemon refused the request';
  return `${what}${place}.${more}`.replace(/([.?!])\.+/g, '$1');
}

/** @param {Response} answer */
async function problemOf(answer) {
  const document = await answer.json().catch(() => null);
  const known = document && typeof document === 'object' ? document : { title: `The daemon answered with status ${answer.status}` };
  const problem = new (PROBLEMS[answer.status] ?? Problem)(known, answer.status);
  const after = answer.headers.get('Retry-After') ?? '';
  if (problem instanceof Busy && /^\d+$/.test(after)) problem.retryAfter = Number(after);
  return problem;
}

/** Waits, or rejects with the signal's reason. @param {number} ms @param {AbortSignal} [signal] */
function rest(ms, signal) {
  return new Promise((resolve, reject) => {
    signal?.throwIfAborted();
    const stop = () => { clearTimeout(timer); reject(signal?.reason); };
    const timer = setTimeout(() => { signal?.removeEventListener('abort', stop); resolve(undefined); }, ms);
    signal?.addEventListener('abort', stop, { once: true });
  });
}

// ---- Files ------------------------------------------------------------------------------------

/** @param {string} name */
const baseName = (name) => /** @type {string} */ (name.split(/[\\/]/).pop());
/** @param {string} name */
const isXml = (name) => /\.xml$/i.test(name);

// Names are not written in import(), so that browsers and bundlers do not look for them.
/** @returns {Promise<{fs: any, path: any}>} */
async function nodeFiles() {
  if (!node) throw new OrielError('a path names a file only in Node: give a File, or {name, text}');
  const [files, paths] = ['node:fs/promises', 'node:path'];
  return { fs: await import(files), path: await import(paths) };
}

/** @param {ArrayBuffer} bytes @returns {Promise<string | null>} its SHA-256, or null where there is none */
async function digestOf(bytes) {
  const module = 'node:crypto'; // Node 18 has no global crypto
  const subtle = globalThis.crypto?.subtle ?? (node ? (await import(module)).webcrypto.subtle : null);
  if (!subtle) return null; // a page that is not from a secure origin
  return [...new Uint8Array(await subtle.digest('SHA-256', bytes))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** A file to send: its name in the scene, and its bytes. */
class Source {
  /** @param {string} name @param {Blob} blob */
  constructor(name, blob) {
    this.name = name;
    this.blob = blob;
    /** @type {Promise<string | null> | undefined} */ this.sha = undefined;
  }

  digest() {
    return (this.sha ??= this.blob.arrayBuffer().then(digestOf));
  }
}

/** @param {FileLike} file @param {string} [folder] @returns {Promise<Source>} */
async function sourceOf(file, folder = '') {
  if (file instanceof Source) return file;
  if (typeof file === 'string') {
    const { fs, path } = await nodeFiles();
    const place = path.join(folder, file);
    const bytes = await fs.readFile(place).catch((/** @type {Error} */ error) => { throw new OrielError(`cannot read ${place}: ${error.message}`, { cause: error }); });
    return new Source(path.isAbsolute(file) ? baseName(file) : file.replaceAll('\\', '/'), new Blob([bytes]));
  }
  if (file instanceof Blob) return new Source(file.webkitRelativePath || file.name || 'file', file);
  const content = file.file ?? file.bytes ?? file.text;
  if (!file.name || content === undefined) throw new OrielError('a file to send has a name, and text, bytes or file');
  return new Source(file.name, content instanceof Blob ? content : new Blob([/** @type {any} */ (content)]));
}

/** The words of a scene file that may be names of files. @param {string} text */
function wordsOf(text) {
  const words = text.split('\n').flatMap((line) => line.split('#')[0].split(/\s+/));
  return new Set(words.map((word) => word.replace(/^['"]+|['"]+$/g, '')).filter((word) => word.includes('.') && !/^([\\/]|[A-Za-z]:)/.test(word) && !word.split('/').includes('..')));
}

/** Files below folder that the sources mention, and files that these mention. Only in Node.
 * @param {Source[]} mains @param {string} folder */
async function mentioned(mains, folder) {
  /** @type {Source[]} */ const found = [];
  if (!node) return found;
  const { fs, path } = await nodeFiles();
  const known = new Set(mains.map(({ name }) => name));
  for (const left = mains.filter(({ name }) => !isXml(name)); left.length;) {
    const words = wordsOf(await /** @type {Source} */ (left.pop()).blob.text());
    for (const word of [...words].filter((one) => !known.has(one)).sort()) {
      const stat = await fs.stat(path.join(folder, word)).catch(() => null);
      if (!stat?.isFile()) continue;
      const source = await sourceOf(word, folder);
      known.add(word);
      found.push(source);
      if (!isXml(word)) left.push(source);
    }
  }
  return found;
}

/** All files below a folder. @param {string} folder @param {string} [below] @returns {Promise<string[]>} */
async function filesBelow(folder, below = '') {
  const { fs, path } = await nodeFiles();
  const entries = await fs.readdir(path.join(folder, below), { withFileTypes: true });
  const lists = entries.map((/** @type {any} */ entry) => (entry.isDirectory() ? filesBelow(folder, `${below}${entry.name}/`) : entry.isFile() ? [below + entry.name] : []));
  return (await Promise.all(lists)).flat().sort();
}

/** Compares names by their bytes in UTF-8, as the daemon does. @param {string} a @param {string} b */
function compareBytes(a, b) {
  const [one, other] = [a, b].map((text) => new TextEncoder().encode(text));
  const at = one.findIndex((byte, i) => byte !== other[i]);
  return at < 0 ? one.length - other.length : one[at] - (other[at] ?? -1);
}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

/** @param {Uint8Array} bytes */
function crc32(bytes) {
  let sum = 0xffffffff;
  for (const byte of bytes) sum = CRC_TABLE[(sum ^ byte) & 255] ^ (sum >>> 8);
  return (sum ^ 0xffffffff) >>> 0;
}

/** Little-endian numbers of 2 and 4 bytes. @param {...[number, number]} numbers pairs of size and value */
function record(...numbers) {
  const view = new DataView(new ArrayBuffer(numbers.reduce((sum, [bytes]) => sum + bytes, 0)));
  let at = 0;
  for (const [bytes, value] of numbers) {
    if (bytes === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += bytes;
  }
  return new Uint8Array(view.buffer);
}

/** An uncompressed zip, the format in which folders are sent; names in UTF-8 (flag 0x800).
 * @param {{name: string, bytes: Uint8Array}[]} files */
function zipOf(files) {
  /** @type {any[]} */ const parts = [], entries = [];
  let at = 0;
  for (const { name, bytes } of files) {
    const text = new TextEncoder().encode(name);
    /** @type {[number, number][]} */
    const common = [[2, 20], [2, 0x800], [2, 0], [2, 0], [2, 0x21], [4, crc32(bytes)], [4, bytes.length], [4, bytes.length], [2, text.length], [2, 0]];
    entries.push(record([4, 0x02014b50], [2, 20], ...common, [2, 0], [2, 0], [2, 0], [4, 0], [4, at]), text);
    parts.push(record([4, 0x04034b50], ...common), text, bytes);
    at += 30 + text.length + bytes.length;
  }
  const size = entries.reduce((sum, part) => sum + part.byteLength, 0);
  return new Blob([...parts, ...entries, record([4, 0x06054b50], [2, 0], [2, 0], [2, files.length], [2, files.length], [4, size], [4, at], [2, 0])]);
}

/** A Honeybee model with other files beside it, such as weather. @param {Source} model @param {Source[]} others */
async function modelWithFiles(model, others) {
  const files = [];
  for (const { name, blob } of others) {
    const bytes = new Uint8Array(await blob.arrayBuffer());
    let text = '';
    for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
    files.push({ name: baseName(name), base64: btoa(text) });
  }
  return new Blob(['{"model": ', model.blob, `, "files": ${JSON.stringify(files)}}`]);
}

/** What an upload sends. names: of the files in the scene, without a common folder. */
export class Bundle {
  /** @param {Blob} body @param {string} type @param {string[]} names */
  constructor(body, type, names) {
    this.body = body;
    this.type = type;
    this.names = names;
  }

  /** Puts files together: a zip or a Honeybee model is sent as it is, a model with other files as JSON,
   * and anything else as a zip.
   * @param {FileLike | FileLike[]} files  in Node, the path of a folder stands for all of its files */
  static async of(files) {
    let list = Array.isArray(files) ? files : [files], folder = '';
    if (list.length === 1 && typeof list[0] === 'string') {
      const { fs } = await nodeFiles();
      const stat = await fs.stat(list[0]).catch(() => null);
      if (stat?.isDirectory()) [folder, list] = [list[0], await filesBelow(list[0])];
    }
    const sources = await Promise.all(list.map((file) => sourceOf(file, folder)));
    if (!sources.length) throw new OrielError('there is no file to send');
    const models = sources.filter(({ name }) => /\.hbjson$/i.test(name)), others = sources.filter((one) => !models.includes(one));
    if (sources.length === 1 && /\.zip$/i.test(sources[0].name)) return new Bundle(sources[0].blob, 'application/zip', []);
    if (sources.length === 1 && /\.(hbjson|json)$/i.test(sources[0].name)) return new Bundle(sources[0].blob, 'application/json', []);
    if (models.length === 1 && !others.some(({ name }) => /\.rad$/i.test(name)))
      return new Bundle(await modelWithFiles(models[0], others), 'application/json', others.map(({ name }) => baseName(name)));
    const top = sources[0].name.split('/')[0];
    const inOne = sources.every(({ name }) => name.startsWith(`${top}/`));
    const parts = await Promise.all(sources.map(async ({ name, blob }) => ({ name, bytes: new Uint8Array(await blob.arrayBuffer()) })));
    return new Bundle(zipOf(parts), 'application/zip', sources.map(({ name }) => (inOne ? name.slice(top.length + 1) : name)));
  }
}

// ---- Events -----------------------------------------------------------------------------------

/** Reads server-sent events. Ends when the connection ends, and rejects if it is silent for too long.
 * @param {Response} answer @param {AbortController} abort
 * @returns {AsyncGenerator<{id: string, event: string, data: any}>} */
async function* eventsOf(answer, abort) {
  if (!answer.body?.getReader) throw new NoStream('this platform does not stream answers');
  const reader = answer.body.getReader(), decoder = new TextDecoder();
  let text = '';
  for (;;) {
    const watch = setTimeout(() => abort.abort(new NoStream('the stream of events is silent')), SILENCE_MS);
    const { value, done } = await reader.read().finally(() => clearTimeout(watch));
    if (done) return;
    text += decoder.decode(value, { stream: true });
    const blocks = text.split('\n\n');
    text = /** @type {string} */ (blocks.pop());
    for (const block of blocks) {
      /** @type {Record<string, string>} */ const found = {};
      for (const line of block.split('\n')) {
        const at = line.indexOf(':');
        if (at > 0) found[line.slice(0, at)] = line.slice(at + 1).replace(/^ /, '');
      }
      if (found.data) yield { id: found.id ?? '', event: found.event ?? 'message', data: JSON.parse(found.data) };
    }
  }
}

// ---- The daemon -------------------------------------------------------------------------------

/** @param {string} host */
const isLoopback = (host) => host === 'localhost' || host === '[::1]' || /^127(\.\d+){3}$/.test(host);
/** @param {Record<string, any>} query  lists become repeated arguments; undefined values are left out */
function queryOf(query) {
  const pairs = Object.entries(query).flatMap(([name, value]) => (Array.isArray(value) ? value : [value]).map((one) => [name, one]));
  const text = new URLSearchParams(pairs.filter(([, value]) => value !== undefined && value !== null && value !== '').map(([name, value]) => [name, String(value)])).toString();
  return text ? `?${text}` : '';
}
const newKey = () => Array.from({ length: 4 }, () => Math.random().toString(36).slice(2, 10)).join('');

/** A daemon at a URL. */
export class Client {
  #headers = /** @type {Record<string, string>} */ ({});
  #sent = /** @type {Map<string, string>} */ (new Map()); // digests of uploads -> ids of scenes

  /**
   * @param {string | null} [url]  by default the page's own origin; in Node $ORIEL_URL, or http://127.0.0.1:8423
   * @param {{token?: string, name?: string, retries?: number, fetch?: typeof fetch}} [options]
   *   token: in Node by default $ORIEL_TOKEN; sent over plain HTTP only to this machine.
   *   name: identifies the client in the daemon's queue if it requires no token.
   *   retries: how often a request is repeated after a broken connection or while the daemon is busy.
   *   fetch: replaces the platform's.
   */
  constructor(url, { token, name, retries = 3, fetch: send } = {}) {
    const usual = node ? node.env.ORIEL_URL || DEFAULT_URL : globalThis.location?.origin ?? DEFAULT_URL;
    this.url = (url || usual).replace(/\/+$/, '');
    const parts = new URL(this.url);
    if (!/^https?:$/.test(parts.protocol)) throw new OrielError(`'${this.url}' is not an http:// or https:// URL`);
    const secret = token ?? node?.env.ORIEL_TOKEN;
    if (secret && parts.protocol === 'http:' && !isLoopback(parts.hostname))
      throw new OrielError('a token sent over plain HTTP could be intercepted: use https://');
    if (secret) this.#headers.Authorization = `Bearer ${secret}`;
    if (name ?? node?.env.ORIEL_CLIENT) this.#headers['X-Oriel-Client'] = name ?? node.env.ORIEL_CLIENT;
    this.retries = retries;
    this.fetch = send ?? ((/** @type {any} */ address, /** @type {any} */ options) => fetch(address, options));
  }

  // -- Requests ---------------------------------------------------------------------------------

  /** @param {string} method @param {string} path @param {RequestOptions} options @returns {Promise<Response>} */
  async #try(method, path, { json, body, headers, signal, cache }) {
    /** @type {Record<string, string>} */ const type = json === undefined ? {} : { 'Content-Type': 'application/json' };
    const request = { method, signal, cache, body: json === undefined ? body : JSON.stringify(json), headers: { Accept: 'application/json', ...this.#headers, ...type, ...headers } };
    try {
      return await this.fetch(this.url + path, request);
    } catch (error) {
      signal?.throwIfAborted();
      throw new Unreachable(`no answer from ${this.url}: ${/** @type {any} */ (error).cause?.message ?? /** @type {any} */ (error).message}`, { cause: error });
    }
  }

  /** Sends a request and returns the response. Throws a Problem or Unreachable.
   * repeat: it may be sent again after a broken connection; by default for GET and HEAD.
   * @param {string} method @param {string} path @param {RequestOptions} [options] */
  async request(method, path, options = {}) {
    const { repeat = method === 'GET' || method === 'HEAD', signal } = options;
    for (let attempt = 0; ; attempt++) {
      let failure, wait = 250 * 2 ** attempt;
      try {
        const answer = await this.#try(method, path, options);
        if (answer.ok) return answer;
        failure = await problemOf(answer);
        if (!(failure instanceof Busy)) throw failure;
        wait = Math.max(wait, 1000 * (failure.retryAfter ?? 0));
      } catch (error) {
        if (!(error instanceof Unreachable)) throw error;
        failure = error;
      }
      if (!repeat || attempt >= this.retries) throw failure;
      await rest(wait, signal);
    }
  }

  /** @param {string} path @param {RequestOptions} [options] @returns {Promise<any>} */
  async get(path, options) {
    return (await this.request('GET', path, options)).json();
  }

  /** The first items of a list, which may have several pages.
   * @param {string} path @param {string} member @param {number} [limit] @param {RequestOptions} [options] @returns {Promise<any[]>} */
  async list(path, member, limit = Infinity, options) {
    const found = [];
    for (let next = /** @type {string | null} */ (path); next && found.length < limit;) {
      const answer = await this.request('GET', next, options);
      found.push(...(await answer.json())[member]);
      next = nextPage(answer);
    }
    return found.slice(0, limit);
  }

  /** @param {string} path @param {AbortSignal} [signal] */
  async #has(path, signal) {
    try {
      await this.request('HEAD', path, { signal });
      return true;
    } catch (error) {
      if (error instanceof NotFound) return false;
      throw error;
    }
  }

  // -- Uploads ----------------------------------------------------------------------------------

  /** Uploads a BSDF (WINDOW XML) unless the daemon has it. Returns its id.
   * @param {FileLike} file @param {{name?: string, signal?: AbortSignal}} [options] */
  async uploadBsdf(file, { name, signal } = {}) {
    const source = await sourceOf(file), sha = await source.digest();
    if (sha && await this.#has(`/v1/bsdfs/${sha}`, signal)) return sha;
    const path = `/v1/bsdfs${queryOf({ name: name ?? baseName(source.name) })}`;
    const answer = await this.request('POST', path, { body: source.blob, headers: { 'Content-Type': 'application/xml' }, repeat: true, signal });
    return /** @type {string} */ ((await answer.json()).id);
  }

  /**
   * Uploads Radiance files unless the daemon has this scene. Returns its id. Measurements of a
   * goniophotometer are uploaded in the same way.
   * @param {FileLike[]} files  in the order in which they are read
   * @param {{resources?: FileLike[], folder?: string, bsdfs?: Record<string, string>, signal?: AbortSignal}} [options]
   *   resources: files that these refer to; in Node by default all files below folder that they mention.
   *   bsdfs: {name: id} of BSDFs that the daemon has, such as results of makeBsdf.
   */
  async uploadScene(files, { resources, folder = '', bsdfs = {}, signal } = {}) {
    const all = await Promise.all(files.map((file) => sourceOf(file, folder)));
    const mains = all.filter(({ name }) => !isXml(name));
    const further = resources ? await Promise.all(resources.map((file) => sourceOf(file, folder))) : await mentioned(mains, folder);
    const others = [...all.filter(({ name }) => isXml(name)), ...further].filter(({ name }) => !(name in bsdfs));
    const id = await sceneId(mains, others, bsdfs);
    if (id && await this.#has(`/v1/scenes/${id}`, signal)) return id;
    const form = new FormData(), known = { ...bsdfs };
    for (const { name, blob } of mains) form.append('file', blob, name);
    for (const source of others) {
      const sha = isXml(source.name) ? await source.digest() : null;
      if (sha && await this.#has(`/v1/bsdfs/${sha}`, signal)) known[source.name] = sha;
      else form.append('resource', source.blob, source.name);
    }
    if (Object.keys(known).length) form.append('bsdfs', JSON.stringify(known));
    const answer = await this.request('POST', '/v1/scenes', { body: form, repeat: true, signal });
    return /** @type {string} */ ((await answer.json()).id);
  }

  /**
   * Uploads what a folder or a drop contains: Radiance files, a Honeybee model with its weather file,
   * a folder that Honeybee exported, a zip. Returns the scene's id. A client sends the same files once.
   * @param {FileLike | FileLike[] | Bundle} files  in Node also the path of a folder
   * @param {UploadOptions} [options]
   *   main: names of the scene's main files, in order; by default the daemon chooses them.
   *   states: {group: state} of a Honeybee project. sky: the name of one of its skies.
   */
  async upload(files, { main, states = {}, sky, signal } = {}) {
    const { body, type } = files instanceof Bundle ? files : await Bundle.of(files);
    const path = `/v1/scenes${queryOf({ main, state: Object.entries(states).map((pair) => pair.join('=')), sky })}`;
    const sha = await digestOf(await body.arrayBuffer());
    const known = this.#sent.get(`${sha} ${path}`);
    if (sha && known && await this.#has(`/v1/scenes/${known}`, signal)) return known;
    const answer = await this.request('POST', path, { body, headers: { 'Content-Type': type }, repeat: true, signal });
    const id = /** @type {string} */ ((await answer.json()).id);
    if (sha) this.#sent.set(`${sha} ${path}`, id);
    return id;
  }

  /** Uploads a zip of a scene's folder. Returns the scene's id. @param {FileLike} zip @param {UploadOptions} [options] */
  async uploadZip(zip, options) {
    return this.upload(new Bundle((await sourceOf(zip)).blob, 'application/zip', []), options);
  }

  /** Uploads a Honeybee model, with files beside it such as weather. Returns the scene's id.
   * @param {FileLike | Json} model  a file, or the model itself ({type: "Model", ...})
   * @param {UploadOptions & {files?: FileLike[]}} [options] */
  async uploadModel(model, { files = [], ...options } = {}) {
    return this.upload(await Bundle.of([await modelSource(model), ...files]), options);
  }

  // -- Jobs -------------------------------------------------------------------------------------

  /**
   * Submits a job of any kind; its scene is given by id. Returns the job. After a broken connection it
   * tries again; the daemon recognises the submission by its key.
   * @param {Json} document
   * @param {{name?: string, tags?: string[], key?: string, signal?: AbortSignal}} [options]
   *   name, tags: replace those of the document. key: of the submission, by default a new one.
   */
  async submit(document, { name, tags, key = newKey(), signal } = {}) {
    const json = { ...document, ...(name ? { name } : {}), ...(tags?.length ? { tags } : {}) };
    const answer = await this.request('POST', '/v1/jobs', { json, headers: { 'Idempotency-Key': key }, repeat: true, signal });
    return new Job(this, (await answer.json()).id);
  }

  /** Which effects a render job would simulate, why, and how long accuracies take. The scene is given by
   * id. Returns a list of {sky, plan, curve, warnings}. @param {Json} document @param {Cancellable} [options] @returns {Promise<any[]>} */
  async plan(document, { signal } = {}) {
    return (await (await this.request('POST', '/v1/plans', { json: document, repeat: true, signal })).json()).plans;
  }

  /**
   * Runs a document of any kind: uploads the files that it names, submits it, waits, and returns the
   * results. Its "scene" is an id, {"files": [...]} or, for a Honeybee model, {"project": FILE, "states":
   * {...}}. Aborting the signal cancels the job.
   * @param {Json} document
   * @param {{folder?: string, files?: FileLike[], name?: string, tags?: string[], progress?: Progress, signal?: AbortSignal,
   *          timeout?: number}} [options]
   *   folder: in Node, where the named files are. files: in browsers, the named files.
   */
  async run(document, { folder, files, name, tags, ...waiting } = {}) {
    const { signal } = waiting;
    const prepared = await this.#prepared(document, { folder, files, signal });
    const job = await this.submit(prepared, { name, tags, signal });
    await job.wait(waiting);
    return job.results();
  }

  /** Renders sensors and views; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  render(document, options) { return this.run({ ...document, kind: 'render' }, options); }
  /** Computes a year of daylight; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  annual(document, options) { return this.run({ ...document, kind: 'annual' }, options); }
  /** Measures what accuracy costs in time; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  study(document, options) { return this.run({ ...document, kind: 'study' }, options); }
  /** Makes the BSDF of a panel; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  makeBsdf(document, options) { return this.run({ ...document, kind: 'bsdf_make' }, options); }
  /** Fits a BSDF to measurements; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  fitBsdf(document, options) { return this.run({ ...document, kind: 'bsdf_fit' }, options); }
  /** Renders views with glare metrics, by default DGP; see run. @param {Json} document @param {Parameters<Client["run"]>[1]} [options] */
  glare(document, options) {
    const views = (document.views ?? []).map((/** @type {Json} */ view) => ({ metrics: ['dgp'], ...view }));
    return this.render({ ...document, views }, options);
  }

  /** Uploads the files that a document names. Returns the document with ids in their place.
   * @param {Json} document @param {{folder?: string, files?: FileLike[], signal?: AbortSignal}} where @returns {Promise<Json>} */
  async #prepared(document, { folder = '', files, signal }) {
    const { scene, measurements } = document;
    const given = files && await Promise.all(files.map((file) => sourceOf(file)));
    /** @param {string[]} names */
    const find = (names) => Promise.all(names.map((name) => {
      const source = given?.find((one) => one.name === name || baseName(one.name) === name);
      if (given && !source) throw new OrielError(`the document names ${name}, which is not among the files`);
      return source ? new Source(name, source.blob) : sourceOf(name, folder);
    }));
    if (measurements?.files)
      return { ...document, measurements: await this.uploadScene(await find(measurements.files), { resources: [], signal }) };
    if (scene?.project) return this.#preparedProject(document, find, folder, signal);
    if (!scene?.files) return document;
    const mains = await find(scene.files), named = await find(namedFiles(document));
    const others = [...named, ...given ?? await mentioned(mains, folder)];
    const resources = new Map(others.filter(({ name }) => !scene.files.includes(name)).map((one) => [one.name, one]));
    return { ...document, scene: await this.uploadScene(mains, { resources: [...resources.values()], signal }) };
  }

  /** A document with a Honeybee model or folder in place: grids of the project, unless it has sensors or views.
   * @param {Json} document @param {(names: string[]) => Promise<Source[]>} find @param {string} folder @param {AbortSignal} [signal] */
  async #preparedProject(document, find, folder, signal) {
    const { project, states, sky } = document.scene;
    const beside = (await find(namedFiles(document))).map(({ name, blob }) => new Source(baseName(name), blob));
    const bundle = typeof project === 'string' && await isFolder(folder, project) ? await Bundle.of(`${folder ? `${folder}/` : ''}${project}`)
      : await this.#projectBundle(typeof project === 'string' ? (await find([project]))[0] : project, beside);
    const scene = await this.upload(bundle, { states, sky, signal });
    /** @type {Json} */ const prepared = { ...document, scene };
    if (typeof document.weather === 'string') prepared.weather = baseName(document.weather);
    if (document.sky?.weather?.file) prepared.sky = { ...document.sky, weather: { ...document.sky.weather, file: baseName(document.sky.weather.file) } };
    if (!document.grids && !document.sensors && !document.views) prepared.grids = (await this.scene(scene, { signal })).summary.project?.grids;
    return prepared;
  }

  /** @param {FileLike | Json} project @param {Source[]} beside */
  async #projectBundle(project, beside) {
    const isZip = /\.zip$/i.test(/** @type {any} */ (project).name ?? '');
    return Bundle.of(isZip ? /** @type {FileLike} */ (project) : [await modelSource(project), ...beside]);
  }

  /** An earlier job by its id, or by enough first digits to be unique. @param {string} id */
  job(id) {
    return new Job(this, id);
  }

  /** The latest jobs' documents, newest first.
   * @param {{state?: string, limit?: number, scene?: string, tags?: string[], since?: string, summary?: boolean, signal?: AbortSignal}} [options]
   *   summary: short documents without files, maps and links. since: only later ones, "2024-03-22T11:30:00Z". */
  jobs({ state, limit = 100, scene, tags, since, summary, signal } = {}) {
    const query = queryOf({ limit: Math.min(limit, 1000), tag: tags, state, scene, since, fields: summary ? 'summary' : undefined });
    return this.list(`/v1/jobs${query}`, 'jobs', limit, { signal });
  }

  /**
   * Events of jobs from now on, as {event, data, id}. "job": data is the job's summary. "removed": data
   * has the id. "reset": earlier events are lost, so request lists again. Throws Unreachable when the
   * connection ends; lastId continues after that event.
   * @param {{jobs?: string[], tags?: string[], lastId?: string, signal?: AbortSignal, opened?: () => void}} [options]
   *   opened: called when the daemon has accepted the connection.
   */
  events({ jobs, tags, ...options } = {}) {
    return this.eventStream(`/v1/events${queryOf({ job: jobs, tag: tags })}`, options);
  }

  /** Server-sent events at a path. @param {string} path
   * @param {{lastId?: string, signal?: AbortSignal, opened?: () => void}} [options] */
  async* eventStream(path, { lastId, signal, opened } = {}) {
    const abort = new AbortController(), stop = () => abort.abort(signal?.reason);
    signal?.throwIfAborted();
    signal?.addEventListener('abort', stop);
    try {
      const headers = { Accept: 'text/event-stream', ...this.#headers, ...(lastId ? { 'Last-Event-ID': lastId } : {}) };
      const answer = await this.#try('GET', path, { headers, signal: abort.signal, cache: 'no-store' });
      if (!answer.ok) throw await problemOf(answer);
      opened?.();
      if (answer.status === 204) return; // the final state has been received
      yield* eventsOf(answer, abort);
    } catch (error) {
      signal?.throwIfAborted();
      throw error instanceof OrielError ? error : new Unreachable(`no answer from ${this.url}: ${/** @type {any} */ (error).message}`, { cause: error });
    } finally {
      signal?.removeEventListener('abort', stop);
      abort.abort(); // closes the connection when the reader stops early
    }
  }

  // -- Stored things ----------------------------------------------------------------------------

  /** A scene's document, with its summary. @param {string} id @param {Cancellable} [options] */
  scene(id, options) { return this.get(`/v1/scenes/${id}`, options); }
  /** A BSDF's document, with its check. @param {string} id @param {Cancellable} [options] */
  bsdf(id, options) { return this.get(`/v1/bsdfs/${id}`, options); }
  /** The stored scenes, latest first. @param {number} [limit] */
  scenes(limit = 100) { return this.list(`/v1/scenes${queryOf({ limit: Math.min(limit, 1000) })}`, 'scenes', limit); }
  /** The BSDFs that were uploaded alone, latest first. @param {number} [limit] */
  bsdfs(limit = 100) { return this.list(`/v1/bsdfs${queryOf({ limit: Math.min(limit, 1000) })}`, 'bsdfs', limit); }
  /** The photon maps and loaded BSDFs that the daemon stores for later jobs. */
  maps() { return this.list('/v1/maps', 'maps'); }
  /** Removes a scene. Rejects with InUse while a waiting or running job needs it. @param {string} id */
  async removeScene(id) { await this.request('DELETE', `/v1/scenes/${id}`); }
  /** Removes a BSDF. Rejects with InUse while a scene contains it. @param {string} id */
  async removeBsdf(id) { await this.request('DELETE', `/v1/bsdfs/${id}`); }
  /** Removes an item of maps(). Later jobs build it again. @param {string} kind @param {string} key */
  async removeMap(kind, key) { await this.request('DELETE', `/v1/maps/${kind}/${key}`); }
  /** The daemon's limits by name. */
  limits() { return this.get('/v1/limits'); }
  /** The daemon's version and uptime_s. Rejects with Unreachable if it does not answer. */
  health() { return this.get('/healthz'); }
}

/** A Honeybee model as a file. @param {FileLike | Json} model */
async function modelSource(model) {
  const isModel = typeof model === 'object' && /** @type {Json} */ (model).type === 'Model';
  const source = await sourceOf(isModel ? { name: 'model.hbjson', text: JSON.stringify(model) } : /** @type {FileLike} */ (model));
  return /\.json$/i.test(source.name) ? new Source(source.name.replace(/json$/i, 'hbjson'), source.blob) : source;
}

/** @param {string} folder @param {string} name */
async function isFolder(folder, name) {
  if (!node) return false;
  const { fs, path } = await nodeFiles();
  return Boolean((await fs.stat(path.join(folder, name)).catch(() => null))?.isDirectory());
}

/** The address of a list's next page (RFC 8288), or null. @param {Response} answer */
export function nextPage(answer) {
  const found = /<([^>]+)>\s*;\s*rel="next"/.exec(answer.headers.get('Link') || '');
  return found ? found[1] : null;
}

/** The scene's id, as the daemon computes it (POST /v1/scenes); null without digests.
 * @param {Source[]} mains @param {Source[]} others @param {Record<string, string>} bsdfs */
async function sceneId(mains, others, bsdfs) {
  const resources = Object.entries(bsdfs);
  for (const source of others) resources.push([source.name, (await source.digest()) ?? '']);
  resources.sort(([a], [b]) => compareBytes(a, b));
  let text = 'oriel-scene 1\n';
  for (const source of mains) text += `main ${await source.digest()} ${source.name}\n`;
  for (const [name, sha] of resources) text += `resource ${sha} ${name}\n`;
  return digestOf(/** @type {any} */ (new TextEncoder().encode(text)));
}

/** The files beside the scene that a document names. @param {Json} document @returns {string[]} */
function namedFiles({ kind, weather, occupancy, grids, sensors, sky, skies, views, matrices }) {
  const names = kind === 'annual' ? [weather, occupancy?.file] : [];
  for (const one of [sky, ...[skies ?? []].flat()]) names.push(one?.weather?.file);
  for (const grid of grids ?? []) names.push(grid.sensors?.file);
  for (const view of views ?? []) names.push(view.file, view.glare?.mask);
  for (const { coefficients, view, transmission, daylight, sky: patches } of matrices ?? []) names.push(coefficients, view, transmission, daylight, patches);
  return [...new Set([sensors?.file, ...names].filter(Boolean))];
}

// ---- Jobs and results -------------------------------------------------------------------------

/** Called with a job's state when it changes; false cancels the job.
 * @typedef {(status: {id: string, state: string, stage: string | null, percent: number | null, eta_s: number | null}) => unknown} Progress */

/** A job of a daemon, identified by its id. */
export class Job {
  /** @param {Client} client @param {string} id */
  constructor(client, id) {
    this.client = client;
    this.id = id;
    this.path = `/v1/jobs/${encodeURIComponent(id)}`;
  }

  /** The job's document: state, stage, percent, eta_s and other members. @param {Cancellable} [options] */
  status(options) { return this.client.get(this.path, options); }
  /** The document that was submitted. */
  document() { return this.client.get(`${this.path}/document`); }
  /** Starts to cancel the job. Rejects with InUse if it has ended. */
  async cancel() { return (await this.client.request('POST', `${this.path}/cancel`)).json(); }
  /** Removes the job and its results. Rejects with InUse if it has not ended. */
  async remove() { await this.client.request('DELETE', this.path); }
  /** result.json; for a running job with a goal, the intermediate result. @param {Cancellable} [options] */
  result(options) { return this.client.get(`${this.path}/result`, options); }
  /** The results of an ended job. */
  async results() { return new Results(this, await this.result()); }
  /** The path of a result file on the daemon. @param {string} name */
  filePath(name) { return `${this.path}/files/${encodeURIComponent(name)}`; }
  /** A result file, as a Response. @param {string} name @param {Cancellable} [options] */
  file(name, options) { return this.client.request('GET', this.filePath(name), options); }

  /** URLs of result files that need no token, for a limited time, as {name: url}.
   * @param {string[]} files @param {number} [seconds] @returns {Promise<Record<string, string>>} */
  async links(files, seconds = 300) {
    const answer = await this.client.request('POST', `${this.path}/links`, { json: { files, seconds } });
    return Object.fromEntries((await answer.json()).links.map((/** @type {any} */ link) => [link.file, this.client.url + link.url]));
  }

  /** Downloads all result files into a folder (in Node), and returns their paths. No partial files remain.
   * @param {string} folder @param {Cancellable} [options] */
  async fetch(folder, options) {
    const { fs, path } = await nodeFiles(), paths = [];
    for (const { name } of (await this.status(options)).files ?? []) {
      if (name.split('/').some((/** @type {string} */ part) => !part || part.startsWith('.') || /[\\:]/.test(part)))
        throw new OrielError(`the daemon lists a file outside the output folder: ${name}`);
      const place = path.join(folder, ...name.split('/'));
      await fs.mkdir(path.dirname(place), { recursive: true });
      await fs.writeFile(`${place}.part`, new Uint8Array(await (await this.file(name, options)).arrayBuffer()));
      await fs.rename(`${place}.part`, place);
      paths.push(place);
    }
    return paths;
  }

  /**
   * Waits until the job has succeeded. Returns its last document. Listens to the daemon's events, and polls
   * where they do not arrive. Rejects with JobFailed or JobCancelled.
   * @param {{progress?: Progress, signal?: AbortSignal, timeout?: number, patience?: number, poll?: number, events?: boolean}} [options]
   *   signal: aborting it cancels the job. timeout: seconds until TimedOut; the job continues.
   *   patience: seconds to wait for a daemon that does not answer; jobs survive its restart.
   *   poll: seconds between two polls. events: false polls only.
   */
  async wait({ progress, signal, timeout, patience = 60, poll = 0.5, events = true } = {}) {
    const stop = new AbortController(), cancel = () => stop.abort(signal?.reason);
    const timer = timeout === undefined ? 0 : setTimeout(() => stop.abort(new TimedOut(`job ${this.id} did not end within ${timeout} s`)), 1000 * timeout);
    signal?.addEventListener('abort', cancel);
    try {
      signal?.throwIfAborted();
      return await this.#follow({ progress, signal: stop.signal, patience, poll, events });
    } catch (error) {
      if (signal?.aborted) await this.cancel().catch(() => {}); // it may have ended
      throw error;
    } finally {
      clearTimeout(timer);
      signal?.removeEventListener('abort', cancel);
    }
  }

  /** @param {{progress?: Progress, signal: AbortSignal, patience: number, poll: number, events: boolean}} options */
  async #follow({ progress, signal, patience, poll, events }) {
    let last = '', lastId = '', answered = Date.now();
    const take = async (/** @type {any} */ status) => {
      answered = Date.now();
      const text = JSON.stringify([status.state, status.stage, status.percent, status.eta_s]);
      if (text !== last && progress?.(status) === false && !ENDED.includes(status.state)) await this.cancel();
      last = text;
      return ENDED.includes(status.state);
    };
    const isTemporary = (/** @type {unknown} */ error) => error instanceof Unreachable || error instanceof Busy;
    for (let streams = events ? STREAM_TRIES : 0; ;) {
      try {
        for await (const { data, id } of streams > 0 ? this.client.eventStream(`${this.path}/events`, { lastId, signal }) : []) {
          [lastId, streams] = [id, STREAM_TRIES];
          if (await take(data)) break;
        }
      } catch (error) {
        if (!isTemporary(error)) throw error;
        streams = error instanceof Busy || error instanceof NoStream ? 0 : streams - 1;
      }
      try {
        const status = await this.status({ signal });
        if (await take(status)) return this.#ended(status);
      } catch (error) {
        if (!isTemporary(error) || Date.now() - answered > 1000 * patience) throw error;
      }
      await rest(1000 * poll, signal);
    }
  }

  /** @param {any} status */
  #ended(status) {
    if (status.state === 'failed') throw new JobFailed(status.error ?? { title: 'The job failed' });
    if (status.state === 'cancelled') throw new JobCancelled(`job ${this.id} was cancelled`);
    return status;
  }
}

/** @param {(number | null)[]} values  null becomes NaN */
const toArray = (values) => Float64Array.from(values, (value) => value ?? NaN);

/** The results of a job, by the names of its grids. Sensors without a grid belong to the grid "sensors". */
export class Results {
  /** @param {Job} job @param {any} document  result.json */
  constructor(job, document) {
    this.job = job;
    /** @type {Json} */ this.document = document;
  }

  /** Warnings, as sentences. @returns {string[]} */
  get warnings() { return this.document.warnings ?? []; }

  /** Ranges of the grids in the list of sensors. @param {Json} result @param {number} count @returns {Json[]} */
  #ranges(result, count) {
    return result.grids ?? (count ? [{ name: 'sensors', first: 0, count }] : []);
  }

  /** Illuminance of the sensors in lx, as {grid: Float64Array}; under several skies as {sky: {grid: ...}}.
   * @returns {Promise<Record<string, any>>} */
  async illuminances() {
    const { sensors, skies } = this.document;
    const byGrid = (/** @type {any} */ result, /** @type {any[]} */ values) => Object.fromEntries(this.#ranges(result, values.length)
      .map(({ name, first, count }) => [name, toArray(values.slice(first, first + count))]));
    if (!skies) return byGrid(this.document, (sensors ?? []).map((/** @type {any} */ one) => one.illuminance_lx));
    const grids = skies.length ? await (await this.job.file(skies[0].file)).json() : {};
    return Object.fromEntries(skies.map((/** @type {any} */ sky) => [sky.name, byGrid(grids, sky.illuminance_lx)]));
  }

  /** One row per sensor. A rendering has illuminance_lx with its error and interval. A year has the columns
   * of sensors.csv: position, direction and metrics with their intervals. @param {string} [grid]  by default all
   * @returns {Promise<Json[]>} */
  async table(grid) {
    const rows = this.document.kind === 'annual' ? tableOf(await (await this.job.file('sensors.csv')).text()) : this.#sensorRows();
    return grid === undefined ? rows : rows.filter((row) => row.grid === grid);
  }

  /** @returns {Json[]} */
  #sensorRows() {
    const { sensors = [], skies } = this.document;
    if (skies) throw new OrielError('under several skies there are illuminances() for each, and a file with the table of each');
    return this.#ranges(this.document, sensors.length).flatMap(({ name, first, count }) => sensors.slice(first, first + count).map((/** @type {any} */ one, /** @type {number} */ i) => (
      { grid: name, sensor: i, illuminance_lx: one.illuminance_lx, standard_error_lx: one.standard_error_lx ?? null, low_95_lx: one.interval_95_lx?.[0] ?? null, high_95_lx: one.interval_95_lx?.[1] ?? null })));
  }

  /** Of a year: one row per hour, as in hours.csv. @returns {Promise<Json[]>} */
  async hours() { return tableOf(await (await this.job.file('hours.csv')).text()); }

  /** Of a year: one row per target, with its value, interval and verdict. @returns {Json[]} */
  verdicts() {
    return /** @type {Json[]} */ (this.document.verdicts ?? []).map(({ rule, target, grid, value, unit, interval_95: [low, high], verdict, note }) => ({ rule, target, grid, value, unit, low_95: low, high_95: high, verdict, note }));
  }

  /** Glare of the views: one row per metric. Of a year: one row per seat. @returns {Json[]} */
  glare() {
    const { kind, glare, views = [] } = this.document;
    if (kind === 'annual') return /** @type {Json[]} */ (glare?.seats ?? []).map(({ name, exceeded_5: top, protection }) => ({ seat: name, dgp: top.dgp, low_95: top.interval_95[0], high_95: top.interval_95[1], protection }));
    return views.filter((/** @type {any} */ view) => view.glare).flatMap((/** @type {any} */ view) => Object.entries(view.glare.metrics).map(([metric, found]) => (
      { view: view.name, metric, value: found.value, standard_error: found.standard_error, low_95: found.interval_95[0], high_95: found.interval_95[1], class: view.glare.class })));
  }
}

/** The rows of a CSV file, by the names in its first line. Columns low_95 and high_95 get the name of
 * the column before them. @param {string} text @returns {Json[]} */
export function tableOf(text) {
  const [head, ...rows] = text.split(/\r?\n/).filter(Boolean).map((line) => [...line.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g)].slice(0, -1).map(([, cell]) => (cell.startsWith('"') ? cell.slice(1, -1).replaceAll('""', '"') : cell)));
  let before = '';
  const names = (head ?? []).map((name) => (/^(low|high)_95$/.test(name) ? `${before} ${name}` : (before = name)));
  return rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i] !== '' && Number.isFinite(Number(row[i])) ? Number(row[i]) : row[i] ?? ''])));
}

/** Rows as CSV, with the names of the first row's columns. @param {Json[]} rows */
export function csvOf(rows) {
  const names = Object.keys(rows[0] ?? {});
  const cell = (/** @type {any} */ value) => (/[",\n]/.test(String(value ?? '')) ? `"${String(value).replaceAll('"', '""')}"` : String(value ?? ''));
  return [names, ...rows.map((row) => names.map((name) => row[name]))].map((row) => `${row.map(cell).join(',')}\n`).join('');
}
