// The JavaScript client in a page of another origin, as a design tool would use it.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { Daemon, ROOM, SENSORS } from './daemon.mjs';

const TOOL = '<!doctype html><title>A tool</title><p>A tool';

// In the page: uploads files, follows the job, and reads its results; then cancels another one.
async function useModule({ url, text, sensors }) {
  const oriel = await import(`${url}/oriel.js`);
  const client = new oriel.Client(url);
  const files = [new File([text], 'room.rad')], states = [];
  const document = { scene: { files: ['room.rad'] }, grids: [{ name: 'desks', sensors }], technique: 'backward', gather_samples: 8 };
  const results = await client.render(document, { files, progress: ({ state }) => { states.push(state); } });
  const values = await results.illuminances();
  const zipped = await client.upload(files);
  const abort = new AbortController();
  const endless = await client.submit({ scene: zipped, sensors, accuracy: { deadline_s: 3600 } });
  setTimeout(() => abort.abort(), 300);
  const stopped = await endless.wait({ signal: abort.signal }).catch((error) => error.name);
  const last = await endless.wait().catch((error) => error.name);
  const refused = await client.submit({ scene: zipped, sensors: [[0, 0]] }).catch((error) => error.message);
  return { values: [...values.desks], states, stopped, last, refused, rows: (await results.table('desks')).length };
}

export function moduleCases({ test, browser, build }) {
  test('a page of another origin imports the module, renders and cancels', async () => {
    const tool = createServer((request, answer) => answer.setHeader('Content-Type', 'text/html').end(TOOL));
    await new Promise((done) => tool.listen(0, '127.0.0.1', done));
    const origin = `http://127.0.0.1:${tool.address().port}`;
    const daemon = await new Daemon(build).start('--allow-origin', origin);
    const context = await browser.browser.newContext();
    try {
      const page = await context.newPage();
      await page.goto(origin);
      const found = await page.evaluate(useModule, { url: daemon.url, text: ROOM, sensors: SENSORS });
      assert.ok(found.values.length === SENSORS.length && found.values.every((value) => value > 0), `${found.values}`);
      assert.equal(found.rows, SENSORS.length);
      assert.equal(found.states.at(-1), 'succeeded');
      assert.equal(found.stopped, 'AbortError');
      assert.equal(found.last, 'JobCancelled');
      assert.match(found.refused, /sensors/);
    } finally {
      await context.close();
      await daemon.remove();
      tool.close();
    }
  });

  test('the JavaScript client has sound types, and npm packs it', async () => {
    const packed = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json'], { cwd: 'client/javascript', encoding: 'utf8' }));
    assert.deepEqual(packed[0].files.map((file) => file.path).sort(), ['README.md', 'oriel.js', 'package.json']);
    const options = '--noEmit --checkJs --allowJs --strict --target es2022 --module esnext --moduleResolution bundler --lib es2022,dom,dom.iterable';
    execFileSync(process.execPath, [`${build}/browser/node_modules/typescript/bin/tsc`, ...options.split(' '), 'client/javascript/oriel.js'], { stdio: ['ignore', 2, 2] });
  });
}
