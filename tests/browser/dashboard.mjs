// The dashboard as a user sees it. Each case has the lines "ok N - name" or "not ok N - name".

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { Browser } from './browser.mjs';
import { crowdCases } from './crowd.mjs';
import { Daemon, LONG, ROOM, SENSORS, VIEW, until, words } from './daemon.mjs';
import { guideCases } from './guide.mjs';
import { moduleCases } from './module.mjs';
import { luminance } from './rgbe.mjs';

const build = process.argv[2] || 'build';
const browser = new Browser(build);
const cases = [];
const only = process.argv[3]; // a part of a case's name
const test = (name, run) => cases.push([name, run]);
let daemon;

// A page that has done nothing it must not when the case ends.
async function visit(options, run) {
  const visited = await browser.open(options.daemon || daemon, options);
  try {
    await run(visited.page, visited);
    assert.deepEqual(visited.faults, []);
  } finally {
    await visited.close();
  }
}

const same = (value) => (one) => one === value;
const live = (page) => page.getByRole('status').getByText('Live').waitFor();
const row = (page, name) => page.getByRole('row', { name });
const nears = (wanted) => (value) => Math.abs(value / wanted - 1) < 0.005;
const CASE_S = 240; // a machine may be busy; an idle one takes a minute for all of them

test('an empty list says how to begin', () => visit({}, async (page) => {
  await page.getByText('No jobs yet').waitFor();
  await until(() => page.title(), same('Jobs \u2013 Oriel'), 'title');
  await live(page);
  assert.deepEqual(await browser.audit(page), []);
}));

test('the page takes less than 150 kB without the pictures of its job', () => visit({}, async (page) => {
  await page.goto('about:blank');
  const client = await page.context().newCDPSession(page);
  let bytes = 0;
  const files = new Set(); // the job's own pictures, which are as large as the job makes them
  await client.send('Network.enable');
  client.on('Network.requestWillBeSent', (event) => { if (/\/v1\/jobs\/[^/]+\/files\//.test(event.request.url)) files.add(event.requestId); });
  client.on('Network.loadingFinished', (event) => { if (!files.has(event.requestId)) bytes += event.encodedDataLength; });
  await client.send('Network.setCacheDisabled', { cacheDisabled: true });
  const id = await daemon.submit({ ...words('weighed'), accuracy: { relative_error: 0.05 }, gather_samples: undefined, technique: 'auto' });
  await daemon.wait(id);
  await page.goto(`${daemon.url}/#/jobs/${id}`);
  await page.getByRole('heading', { name: 'Plan' }).waitFor();
  await page.getByRole('img', { name: /^Error against time: from/ }).waitFor();
  // All that is asked for has been counted when nothing more comes for half a second.
  for (let last = -1; last !== bytes;) {
    last = bytes;
    await page.waitForTimeout(500);
  }
  process.stdout.write(`# ${bytes} bytes transferred, with Chart.js\n`);
  assert.ok(bytes > 10000 && bytes < 150000, `${bytes} bytes`);
  const scripts = await page.evaluate(() => performance.getEntriesByType('resource').map((one) => one.name).filter((name) => /dashboard.*(?<!chart)\.js$/.test(name)));
  assert.ok(scripts.length > 8, `${scripts}`);
  for (const address of scripts) {
    const name = address.replace(/^.*?\/dashboard\/[^/]+\//, '');
    assert.equal(await (await fetch(address)).text(), readFileSync(name === 'oriel.js' ? 'client/javascript/oriel.js' : `client/dashboard/${name}`, 'utf8'), `${name} is served as it is`);
  }
}));

test('a job that comes is seen at once, and its end', () => visit({}, async (page) => {
  await live(page);
  await daemon.submit(words('comes later'));
  await row(page, 'comes later').waitFor();
  await row(page, 'comes later').getByText('Succeeded').waitFor();
}));

test('the error falls while one looks on', () => visit({}, async (page) => {
  await daemon.submit({ name: 'falls', tags: ['tagged'], sensors: SENSORS, accuracy: { relative_error: 0.02 } });
  await page.getByRole('link', { name: 'falls' }).click();
  // The chart has no range before the first round, and one point after it; its label and the figure
  // beside it are read at once.
  const read = () => page.evaluate(() => [document.querySelector('canvas')?.getAttribute('aria-label'), document.querySelector('.figure strong')?.textContent]);
  await until(read, ([label, figure]) => {
    const [, from, to] = /from (\S+)\s% to (\S+)\s% after .* the goal is 2\s%/.exec(label || '') || [];
    return Number(to) < Number(from) && parseFloat(figure) <= Number(to);
  }, 'range of the error');
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'job-falling');
}));

// A result so far that is asked for may have gone with its job by then.
test('a job that runs is cancelled', () => visit({ mayFail: (url, text) => url.endsWith('/result') && text.includes('409') }, async (page) => {
  const id = await daemon.submit({ name: 'endless', ...LONG });
  await page.getByRole('link', { name: 'endless' }).click();
  await page.locator('.state').getByText('Running').waitFor();
  await browser.keep(page, 'job-running');
  await page.getByRole('button', { name: 'Cancel' }).click();
  await page.getByText('It was cancelled before its end.').waitFor();
  assert.equal((await daemon.wait(id)).state, 'cancelled');
}));

test('a job that has ended shows pictures, plan and health, and is run again', () => visit({}, async (page) => {
  const id = await daemon.submit({ name: 'shown', sensors: SENSORS, views: [VIEW], accuracy: { relative_error: 0.2 } });
  await daemon.wait(id);
  await page.goto(`${daemon.url}/#/jobs/${id}`);
  for (const title of ['Error', 'Sensors', 'Pictures', 'Plan', 'Health', 'Time', 'Files']) await page.getByRole('heading', { name: title, exact: true }).waitFor();
  await page.getByText(/Cross-check by path tracing: agrees at \d+ sensors/).waitFor();
  const image = page.getByAltText('Picture of the view north');
  await page.waitForFunction((node) => node.naturalWidth === 64, await image.elementHandle());
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'job-done');
  await page.getByRole('button', { name: /Halve the error/ }).click();
  await page.getByRole('heading', { name: /shown, to .* %/ }).waitFor();
  const halved = await daemon.ask('GET', `/v1/jobs/${page.url().split('/').pop()}/document`);
  const before = await daemon.ask('GET', `/v1/jobs/${id}/result`);
  assert.ok(Math.abs(halved.accuracy.relative_error / before.cost.next.error - 0.5) < 0.01);
  assert.deepEqual(halved.sensors, SENSORS);
  await page.goto(`${daemon.url}/#/jobs/${id}`);
  await page.getByRole('button', { name: 'Another view' }).click();
  await page.getByLabel('Radiance view').fill('-vtv -vp 1.5 3.5 1.5 -vd 0 -1 0');
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'another-view');
  await page.getByRole('dialog').getByRole('button', { name: 'Submit' }).click();
  await page.getByRole('heading', { name: 'shown, north-2' }).waitFor();
  const turned = await daemon.ask('GET', `/v1/jobs/${page.url().split('/').pop()}/document`);
  assert.deepEqual(turned.views, [{ ...VIEW, name: 'north-2', view: '-vtv -vp 1.5 3.5 1.5 -vd 0 -1 0' }]);
  assert.equal(turned.sensors, undefined);
}));

test('the viewer tells the light of a pixel, with its error, and wipes between two jobs', () => visit({}, async (page) => {
  const document = { sensors: SENSORS, views: [VIEW], technique: 'backward', pixel_samples: 8, gather_samples: 8 };
  const ids = [await daemon.submit({ ...document, name: 'one' }), await daemon.submit({ ...document, name: 'other', seed: 2 })];
  for (const id of ids) await daemon.wait(id);
  await page.goto(`${daemon.url}/#/jobs/${ids[0]}`);
  await page.getByAltText('Picture of the view north').click();
  const readout = page.locator('#readout');
  const place = [VIEW.width / 2, VIEW.height / 2];
  await readout.getByText(`x ${place[0]}, y ${place[1]}:`).waitFor();
  const shown = async (name) => parseFloat(new RegExp(`${name}([0-9.\u202f]+) \u00b1`).exec(await readout.innerText())[1].replace(/\u202f/g, ''));
  const truth = [];
  for (const id of ids) truth.push(luminance(await daemon.bytes(`/v1/jobs/${id}/files/north.hdr`), ...place));
  await until(() => shown(': '), nears(truth[0]), 'luminance');
  await page.getByLabel('Beside it (B)').selectOption({ label: 'other, backward' });
  await readout.getByText('B \u2212 A').waitFor();
  await until(() => shown('A '), nears(truth[0]), 'luminance of A');
  await until(() => shown('B '), nears(truth[1]), 'luminance of B');
  const colors = () => page.evaluate(() => {
    const gl = document.querySelector('canvas').getContext('webgl2'), bytes = new Uint8Array(8);
    for (const i of [0, 1]) {
      const one = new Uint8Array(4);
      gl.readPixels(Math.round(gl.drawingBufferWidth * (0.45 + 0.1 * i)), gl.drawingBufferHeight >> 1, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one);
      bytes.set(one, 4 * i);
    }
    return [...bytes];
  });
  const before = await until(colors, (all) => all[3] === 255 && all[0] > 0, 'picture');
  await page.getByLabel('False colours').check();
  await page.getByRole('img', { name: /^Scale from 0 to/ }).waitFor();
  await until(colors, (all) => String(all) !== String(before), 'picture in false colours');
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'viewer');
  await page.locator('canvas').first().focus();
  await page.keyboard.press('ArrowRight');
  await readout.getByText(`x ${place[0] + 1}, y ${place[1]}:`).waitFor();
}));


// As a file manager would: browsers let scripts fill a DataTransfer, too.
async function drop(page, files) {
  const transfer = await page.evaluateHandle((all) => {
    const made = new DataTransfer();
    for (const [name, text] of all) made.items.add(new File([text], name));
    return made;
  }, files);
  await page.dispatchEvent('.drop', 'drop', { dataTransfer: transfer });
}

test('a scene that is dropped becomes a job, and its sensors a map', () => visit({ path: '/#/new', mayFail: (url, text) => url.includes('/v1/scenes') && text.includes('400') }, async (page) => {
  await page.locator('.drop').waitFor();
  await drop(page, [['wrong.rad', 'void plastic grey 0 0 5 .5 .5\n']]);
  await page.locator('.notice').getByText(/wrong.rad, line 2/).waitFor();
  const [gray, glass, ...surfaces] = ROOM.split('void glow')[0].split('\n');
  await drop(page, [['a_room.rad', surfaces.join('\n')], ['b_materials.rad', `# what is used in a_room\n${gray}\n${glass}\n`], ['note.txt', 'of no use']]);
  await page.getByRole('heading', { name: 'Sky' }).waitFor();
  await page.getByText('Read: b_materials.rad, a_room.rad', { exact: true }).waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'new-job');
  await page.locator('.walls[d^="M"]').waitFor({ state: 'attached' }); // the plan is cut
  const plan = await page.locator('.outline svg').boundingBox();
  await page.mouse.move(plan.x + plan.width / 2, plan.y + plan.height / 2);
  await page.mouse.down();
  await page.mouse.move(plan.x + plan.width / 2 + 60, plan.y + plan.height / 2);
  await page.mouse.up();
  await until(() => page.getByLabel('Radiance view').inputValue(), (view) => /^-vtv -vp 1\.\d+ 2\.?\d* 1\.25 -vd 1 -?0 0 /.test(view), 'view');
  await page.getByLabel('Spacing').fill('1');
  await page.getByText('12 sensors').waitFor();
  await page.getByLabel('Render a view').uncheck();
  await page.getByLabel('Relative error').fill('20');
  await page.getByLabel('Job name').fill('dropped');
  await page.getByRole('button', { name: 'What will it take?' }).click();
  await page.getByRole('heading', { name: 'Plan' }).waitFor();
  await page.getByRole('img', { name: /^Error against seconds: from/ }).waitFor();
  await page.getByRole('button', { name: 'Submit' }).click();
  await page.getByRole('heading', { name: 'dropped' }).waitFor();
  const id = page.url().split('/').pop();
  assert.equal((await daemon.wait(id)).state, 'succeeded');
  await page.getByRole('link', { name: 'Heat map' }).click();
  const { sensors } = await daemon.ask('GET', `/v1/jobs/${id}/result`);
  const values = sensors.map((one) => one.illuminance_lx).sort((a, b) => a - b);
  await page.getByLabel('Threshold, lx as a number').fill(((values[2] + values[3]) / 2).toFixed(1));
  await page.getByText('75\u202f%').first().waitFor();
  await until(() => page.locator('table.sensors tbody tr').count(), same(12), 'number of sensors');
  assert.ok(await page.locator('.listed').evaluate((list) => list.scrollHeight <= list.clientHeight)); // none is cut
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'sensors');
}));

test('a Honeybee model that is dropped brings its grids, its view and its states', () => visit({ path: '/#/new' }, async (page) => {
  await page.locator('.drop').waitFor();
  await drop(page, [['two_rooms.hbjson', readFileSync('tests/fixtures/honeybee/two_rooms.hbjson', 'utf8')], ['place.epw', readFileSync('tests/fixtures/weather.epw', 'latin1')]]);
  await page.getByRole('heading', { name: 'Sky' }).waitFor();
  const states = page.getByLabel('south_glass'), [first, second] = await until(() => states.locator('option').allInnerTexts(), (all) => all.length > 1, 'list of states');
  await until(() => states.inputValue(), same(first), 'state');
  const before = await page.locator('.found .mono').innerText();
  await states.selectOption(second);
  await page.waitForFunction((id) => ![id, undefined].includes(document.querySelector('.found .mono')?.textContent), before); // another scene
  await until(() => page.getByLabel('south_glass').inputValue(), same(second), 'state');
  await until(() => page.getByLabel('Sensors', { exact: true }).inputValue(), same('project'), 'choice of sensors');
  await until(() => page.getByLabel('Views').inputValue(), same('project'), 'choice of views');
  await page.getByLabel('Radiance view').waitFor({ state: 'hidden' });
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'new-model');
  await page.getByLabel('Light from').selectOption('weather');
  await until(() => page.getByLabel('File', { exact: true }).inputValue(), same('place.epw'), 'weather file');
  await page.getByLabel('Light from').selectOption('overcast');
  await page.getByLabel('Width').fill('32');
  await page.getByLabel('Height', { exact: true }).fill('24');
  await page.getByLabel('Relative error').fill('40');
  await page.getByLabel('Job name').fill('two rooms');
  await page.getByRole('button', { name: 'Submit' }).click();
  await page.getByRole('heading', { name: 'two rooms' }).waitFor();
  const id = page.url().split('/').pop();
  const asked = await daemon.ask('GET', `/v1/jobs/${id}/document`);
  assert.deepEqual([asked.grids[0].name, asked.views[0].name, asked.views[0].width], ['desks', 'from_door', 32]);
  assert.equal((await daemon.wait(id)).state, 'succeeded');
}));

test('several skies and a study have their tables', () => visit({}, async (page) => {
  const uniform = (name, light) => ({ name, cie: { type: 'uniform', diffuse_horizontal_lx: light } });
  const scene = (await daemon.ask('POST', '/v1/scenes', { files: [{ name: 'room.rad', text: ROOM.split('void glow')[0] }] })).id;
  const skies = await daemon.submit({ scene, skies: [uniform('bright', 20000), uniform('dull', 5000)], sensors: SENSORS, technique: 'backward', gather_samples: 8 });
  const study = await daemon.submit({ kind: 'study', techniques: ['backward'], sensors: SENSORS, gather_samples: [8, 32], repeats: 2, reference: { samples: 1024, runs: 2 } });
  for (const id of [skies, study]) assert.equal((await daemon.wait(id)).state, 'succeeded');
  await page.goto(`${daemon.url}/#/jobs/${skies}`);
  await page.getByRole('heading', { name: 'Skies' }).waitFor();
  for (const name of ['bright', 'dull']) await page.getByRole('cell', { name }).waitFor();
  await page.getByRole('link', { name: 'Heat map' }).click();
  await page.getByLabel('Sky').selectOption('dull');
  const { sensors } = await daemon.ask('GET', `/v1/jobs/${skies}/files/dull.json`);
  await page.getByRole('cell', { name: String(Number(sensors[0].illuminance_lx.toPrecision(4))), exact: true }).first().waitFor();
  await page.goto(`${daemon.url}/#/jobs/${study}`);
  await page.getByRole('heading', { name: 'What accuracy costs' }).waitFor();
  await until(() => page.locator('.part-kind tbody tr').count(), same(2), 'number of settings');
  await page.getByRole('img', { name: /^Error against seconds of 2 settings/ }).waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'study');
  await page.getByRole('button', { name: 'Start backward, 32 samples' }).click();
  await page.getByRole('heading', { name: 'Study: backward, 32 samples' }).waitFor();
  const started = await daemon.ask('GET', `/v1/jobs/${page.url().split('/').pop()}/document`);
  assert.deepEqual([started.kind, started.technique, started.gather_samples, started.sensors], ['render', 'backward', 32, SENSORS]);
}));

// The client asks first whether the daemon has the file.
test('a BSDF that is dropped tells what its check found, and where light goes', () => visit({ mayFail: (url, text) => url.includes('/v1/bsdfs/') && text.includes('404'), path: '/#/bsdfs' }, async (page) => {
  await page.locator('.drop').waitFor();
  await drop(page, [['klems.xml', readFileSync('tests/fixtures/bsdf_klems41.xml', 'latin1')]]);
  await page.getByRole('heading', { name: 'What the check found' }).waitFor();
  const id = page.url().split('/').pop();
  const { summary } = await daemon.ask('GET', `/v1/bsdfs/${id}`);
  await until(() => page.locator('.findings li').count(), same(summary.check.verdicts.length), 'number of findings');
  assert.doesNotMatch(await page.locator('.findings').innerText(), /\de\+?\d/); // numbers as people write them
  const share = async (label) => parseFloat(/: ([0-9.]+)\s% of the light/.exec(await page.getByRole('img', { name: new RegExp(`^${label}: `) }).getAttribute('aria-label'))[1]);
  await page.getByRole('img', { name: /^Transmitted: [0-9.]+\s% of the light/ }).waitFor();
  await page.getByLabel('Light from outside').check();
  await page.getByRole('button', { name: /show light from above, 60 degrees/ }).click();
  const wanted = summary.check.hemispherical.back.find((one) => one.theta_deg === 60 && one.phi_deg === 90);
  await page.waitForFunction((value) => document.querySelectorAll('.polar canvas')[1].getAttribute('aria-label').includes(`: ${value}`), Number((100 * wanted.transmitted).toPrecision(3)).toString());
  await until(() => share('Reflected'), nears(100 * wanted.reflected), 'share reflected');
  await page.locator('.polar canvas').last().hover();
  await page.getByText(/^Transmitted at 0 to 2.5\u00b0 from the normal/).waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'bsdf');
}));

test('a BSDF that came with a scene has its page', () => visit({ path: '/#/new' }, async (page) => {
  await page.locator('.drop').waitFor();
  const blinds = `void BSDF pane 6 0 blinds.xml 0 0 1 . 0 0\n${ROOM.split('\n').filter((line) => !line.startsWith('void glass')).join('\n')}`;
  await drop(page, [['room.rad', blinds], ['blinds.xml', readFileSync('tests/fixtures/bsdf_lcp8.xml', 'latin1')], ['old.rad', ROOM], ['job.json', '{"scene": {"files": ["room.rad"]}}']]);
  await page.getByText('Read: room.rad, not old.rad').waitFor();
  await page.getByRole('link', { name: 'blinds.xml' }).click();
  await page.getByRole('heading', { name: 'What the check found' }).waitFor();
  await page.getByRole('img', { name: /^Transmitted: [0-9.]+\s% of the light/ }).waitFor();
  await page.getByRole('link', { name: 'BSDFs' }).first().click();
  await page.getByRole('row', { name: /blinds.xml with a scene/ }).waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'bsdfs');
}));

test('what is kept is listed and removed, and the daemon says how it fares', () => visit({}, async (page) => {
  for (const { kind, key } of (await daemon.ask('GET', '/v1/maps')).maps) await daemon.ask('DELETE', `/v1/maps/${kind}/${key}`);
  const id = await daemon.submit({ name: 'by photons', sensors: SENSORS, technique: 'gather', photons: { global: 5000 }, gather_samples: 16 });
  await daemon.wait(id);
  await page.getByRole('link', { name: 'Cache' }).click();
  const remove = page.getByRole('button', { name: /^Remove Global photons/ });
  await remove.waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'cache');
  page.once('dialog', (dialog) => dialog.accept());
  await remove.click();
  await remove.waitFor({ state: 'detached' });
  const { maps } = await daemon.ask('GET', '/v1/maps');
  assert.equal(maps.filter((map) => map.kind === 'global').length, 0);
  await page.getByRole('link', { name: 'Operations' }).click();
  await page.getByText(/^Accepts jobs/).waitFor();
  await page.getByRole('meter', { name: 'Kept on disk' }).waitFor();
  assert.deepEqual(await browser.audit(page), []);
  await browser.keep(page, 'operations');
}));

test('a job that failed says why', () => visit({ mayFail: (url, text) => url.endsWith('/ffffffff') && text.includes('404') }, async (page) => {
  const id = await daemon.submit({ name: 'dark', sensors: [[1, 1, -4, 0, 0, -1]], technique: 'backward', gather_samples: 8 });
  const { state } = await daemon.wait(id);
  assert.equal(state, 'failed');
  await page.goto(`${daemon.url}/#/jobs/${id}`);
  await page.locator('.notice').getByText(/no light/i).waitFor();
  await page.goto(`${daemon.url}/#/jobs?state=failed`);
  await row(page, 'dark').waitFor();
  await until(() => page.getByRole('row').count(), same(2), 'number of rows');
  await page.goto(`${daemon.url}/#/jobs/ffffffff`);
  await page.getByText('There is no such job').waitFor();
}));

test('a daemon that is killed comes back, and nothing is lost', () => visit({ mayFail: () => true }, async (page) => {
  const id = await daemon.submit({ name: 'survives', ...LONG });
  await row(page, 'survives').waitFor();
  await daemon.wait(id, (job) => job.state === 'running');
  await daemon.stop('SIGKILL');
  await page.getByText('The daemon does not answer.').waitFor();
  await browser.keep(page, 'daemon-away');
  await daemon.start();
  await daemon.submit(words('after the restart'));
  await page.getByRole('alert').waitFor({ state: 'hidden' });
  await row(page, 'after the restart').waitFor();
  await row(page, 'survives').getByText(/Rendering|Photons/).waitFor();
  await live(page);
  await daemon.ask('POST', `/v1/jobs/${id}/cancel`);
  await row(page, 'survives').getByText('Cancelled').waitFor();
  await row(page, 'after the restart').getByText('Succeeded').waitFor();
}));

test('with tokens one signs in, and out', async () => {
  const guarded = new Daemon(build);
  const token = guarded.token('studio', 'submit'), reader = guarded.token('board', 'read');
  await guarded.start('--tokens', 'always');
  guarded.bearer = token;
  try {
    await visit({ daemon: guarded, mayFail: (url, text) => text.includes('401') }, async (page) => {
      await page.getByLabel('Access token').fill('oriel_0123456789abcdef_' + 'A'.repeat(43));
      await page.getByRole('button', { name: 'Sign in' }).click();
      await page.getByText('The daemon does not know this token.').waitFor();
      assert.deepEqual(await browser.audit(page), []);
      await browser.keep(page, 'sign-in');
      await page.getByLabel('Access token').fill(token);
      await page.keyboard.press('Enter');
      await page.getByText('No jobs yet').waitFor();
      const id = await guarded.submit({ name: 'guarded', sensors: SENSORS, views: [VIEW], technique: 'backward', pixel_samples: 4, gather_samples: 8 });
      await page.getByRole('link', { name: 'guarded' }).click();
      const image = page.getByAltText('Picture of the view north');
      await page.waitForFunction((node) => node.naturalWidth === 64, await image.elementHandle());
      await guarded.wait(id);
      await page.getByRole('button', { name: 'Run again' }).waitFor();
      assert.equal(await page.evaluate(() => document.cookie), '');
      await page.getByRole('button', { name: 'Sign out' }).click();
      await page.getByLabel('Access token').fill(reader);
      await page.keyboard.press('Enter');
      await page.getByRole('link', { name: 'guarded' }).click();
      await page.locator('.state').getByText('Succeeded').waitFor();
      assert.equal(await page.getByRole('button', { name: 'Run again' }).count(), 0);
    });
  } finally {
    await guarded.remove();
  }
});

moduleCases({ test, browser, build });
guideCases({ test, visit, browser, daemon: () => daemon, document: { sensors: SENSORS, views: [VIEW], technique: 'backward', pixel_samples: 4, gather_samples: 8 }, ended: async (document) => (await daemon.wait(await daemon.submit(document))).id });
crowdCases({ test, visit, browser, build });

// No case leaves the daemon busy.
async function calm() {
  for (const state of ['queued', 'running'])
    for (const job of (await daemon.ask('GET', `/v1/jobs?fields=summary&state=${state}`)).jobs) await daemon.ask('POST', `/v1/jobs/${job.id}/cancel`).catch(() => {}); // it may just have ended
}

async function main() {
  let failed = 0, number = 0;
  daemon = await new Daemon(build).start();
  await browser.start();
  process.stdout.write(`1..${cases.length}\n`);
  for (const [name, run] of cases.filter(([one]) => !only || one.includes(only))) {
    const began = performance.now();
    let fault = null;
    try {
      await Promise.race([run(), new Promise((_, reject) => { setTimeout(() => reject(new Error(`it takes longer than ${CASE_S} s`)), 1000 * CASE_S).unref(); })]);
    } catch (error) {
      fault = error;
    }
    await calm().catch(() => {});
    // The cases after it are not to fail for what ended the daemon in this one.
    if (daemon.end) {
      fault = new Error(`the daemon ended with ${daemon.end}; ${fault ? fault.stack : 'the case saw nothing of it'}`);
      await daemon.start();
    }
    process.stdout.write(`${fault ? 'not ok' : 'ok'} ${++number} - ${name}\n# ${((performance.now() - began) / 1000).toFixed(1)} s\n`);
    failed += fault ? 1 : 0;
    if (fault) process.stdout.write(`${String(fault.stack || fault).replace(/^/gm, '# ')}\n`);
  }
  await browser.stop();
  await daemon.remove();
  process.exitCode = failed ? 1 : 0;
}

main().catch((error) => {
  process.stdout.write(`not ok 0 - ${error.stack}\n`);
  process.exit(1);
});
