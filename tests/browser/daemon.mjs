// A daemon of one's own, with a room that is lit, and what a program would ask of it.

import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

export const ROOM = `void plastic grey 0 0 5 .5 .5 .5 0 0
void glass pane 0 0 3 .9 .9 .9
grey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
grey polygon top 0 0 12 0 0 3 0 4 3 3 4 3 3 0 3
grey polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
grey polygon east 0 0 12 3 0 0 3 0 3 3 4 3 3 4 0
grey polygon north 0 0 12 0 4 0 3 4 0 3 4 3 0 4 3
pane polygon window 0 0 12 3 0 0 0 0 0 0 0 3 3 0 3
void glow sky_glow 0 0 4 10 10 10 0
sky_glow source sky 0 0 4 0 0 1 180
`;
export const SENSORS = [];
for (let y = 0.5; y < 4; y += 1) for (let x = 0.5; x < 3; x += 1) SENSORS.push([x, y, 0.8, 0, 0, 1]);
export const words = (text) => ({ name: text, sensors: SENSORS, technique: 'backward', gather_samples: 8 });
export const LONG = { accuracy: { deadline_s: 3600 }, sensors: SENSORS };
export const VIEW = { name: 'north', view: '-vtv -vp 1.5 .5 1.5 -vd 0 1 0', width: 64, height: 48 };

// Below the range that connections and listeners on port 0 are given ports from (32768 and up): a daemon
// that is killed finds its port free when it starts again.
async function freePort() {
  for (;;) {
    const server = createServer(), port = 20000 + Math.floor(12000 * Math.random());
    const free = await new Promise((resolve) => server.once('error', () => resolve(false)).listen(port, '127.0.0.1', () => resolve(true)));
    if (!free) continue;
    await new Promise((resolve) => server.close(resolve));
    return port;
  }
}

// Waits until what is read is as it should be, and fails with the last reading: pages draw later than
// they receive, and how much later depends on what else the machine does.
export async function until(read, holds, what = 'reading') {
  for (const end = performance.now() + 90000; ;) {
    const value = await read();
    if (await holds(value)) return value;
    if (performance.now() > end) throw new Error(`the ${what} is still ${JSON.stringify(value)}`);
    await sleep(30);
  }
}

export class Daemon {
  constructor(build) {
    this.build = build;
    this.folder = mkdtempSync(join(tmpdir(), 'oriel-browser-'));
  }

  async start(...options) {
    this.options = options.length ? options : this.options || [];
    this.port ||= await freePort();
    this.url = `http://127.0.0.1:${this.port}`;
    const arguments_ = ['--data', this.folder, '--listen', `127.0.0.1:${this.port}`, '--threads', '1', '--log-level', 'error', ...this.options];
    this.process = spawn(`${this.build}/orield`, arguments_, { stdio: ['ignore', 'ignore', 'inherit'] });
    this.end = null;
    this.ended = new Promise((resolve) => this.process.once('exit', (code, signal) => resolve(this.end = signal || `exit status ${code}`)));
    for (const end = performance.now() + 120000; performance.now() < end && !this.end;) {
      if (await fetch(`${this.url}/healthz`).then((answer) => answer.ok, () => false)) return this;
      await sleep(50);
    }
    throw new Error('the daemon does not start');
  }

  async stop(signal = 'SIGTERM') {
    this.process.kill(signal);
    await this.ended;
  }

  async remove() {
    await this.stop('SIGKILL');
    rmSync(this.folder, { recursive: true, force: true });
  }

  token(name, scope) {
    const words = ['token', 'add', name, '--scope', scope, '--data', this.folder];
    return execFileSync(`${this.build}/orield`, words, { encoding: 'utf8' }).trim();
  }

  async ask(method, path, body) {
    const headers = { ...(body ? { 'Content-Type': 'application/json' } : {}), ...(this.bearer ? { Authorization: `Bearer ${this.bearer}` } : {}) };
    const answer = await fetch(this.url + path, { method, headers, body: body && JSON.stringify(body) });
    if (!answer.ok) throw new Error(`${method} ${path}: ${answer.status} ${await answer.text()}`);
    return answer.status === 204 ? null : answer.json();
  }

  async bytes(path) {
    return new Uint8Array(await (await fetch(this.url + path)).arrayBuffer());
  }

  async upload() {
    this.scene ||= (await this.ask('POST', '/v1/scenes', { files: [{ name: 'room.rad', text: ROOM }] })).id;
    return this.scene;
  }

  async submit(document) {
    return (await this.ask('POST', '/v1/jobs', { scene: await this.upload(), ...document })).id;
  }

  async wait(id, wanted = (job) => !['queued', 'running', 'cancelling'].includes(job.state)) {
    for (;;) {
      const job = await this.ask('GET', `/v1/jobs/${id}`);
      if (wanted(job)) return job;
      await sleep(50);
    }
  }
}
