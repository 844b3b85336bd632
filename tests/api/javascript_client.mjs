// client/javascript/oriel.js against a live daemon: one case a run, named by the first argument. The others: the
// daemon's URL, and a folder of its own. A failed assertion ends the process with status 1.

import assert from 'node:assert/strict';
import { File } from 'node:buffer'; // a global from Node 20
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, mkdtempSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { createServer, connect } from 'node:net';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import * as oriel from '../../client/javascript/oriel.js';

const here = dirname(fileURLToPath(import.meta.url));
const module_ = join(here, '../../client/javascript');
const fixtures = join(here, '../fixtures');
const [name, url, folder] = process.argv.slice(2);

const OPENING = 'pane polygon window\n0\n0\n12 3 0 0  0 0 0  0 0 3  3 0 3\n';
const SKY = 'void glow sky_glow\n0\n0\n4 10 10 10 0\nsky_glow source sky\n0\n0\n4 0 0 1 180\n';
const WALLS = `void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0
grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0
grey polygon top\n0\n0\n12 0 0 3  0 4 3  3 4 3  3 0 3
grey polygon west\n0\n0\n12 0 0 0  0 4 0  0 4 3  0 0 3
grey polygon east\n0\n0\n12 3 0 0  3 0 3  3 4 3  3 4 0
grey polygon north\n0\n0\n12 0 4 0  3 4 0  3 4 3  0 4 3
!xform -t 0 0 0 window.rad\n`;
const write = (file, text) => writeFileSync(join(folder, file), text);
write('room.rad', WALLS + SKY);
write('skyless.rad', WALLS);
write('window.rad', `void glass pane\n0\n0\n3 0.96 0.96 0.96\n${OPENING}`);
write('sensors.txt', '1.5 1 0.8 0 0 1\n\n1.5 3 0.8 0 0 1 # back\n');
const SENSORS = [[1.5, 1, 0.8, 0, 0, 1], [1.5, 3, 0.8, 0, 0, 1]];
const GRIDS = [{ name: 'desks', sensors: SENSORS }, { name: 'wall', sensors: [[1.5, 2, 1.2, 0, -1, 0]] }];
const QUICK = { technique: 'backward', gather_samples: 16, seed: 1 };
const ENDLESS = { accuracy: { deadline_s: 3600 }, sensors: SENSORS };

// A client that notes what it sends.
const sent = [];
const noted = (address, options) => { sent.push(`${options.method} ${String(address).replace(/^https?:\/\/[^/]+/, '')}`); return fetch(address, options); };
const client = new oriel.Client(url, { fetch: noted });
const scene = () => client.uploadScene(['room.rad'], { folder });

// A connection to the daemon that can be broken: what `cut` accepts (bytes of a request or an answer) ends it.
async function proxy(cut) {
  const { hostname, port } = new URL(url);
  const server = createServer((socket) => {
    const daemon = connect(Number(port), hostname);
    const end = () => { socket.destroy(); daemon.destroy(); };
    for (const [from, to, side] of [[socket, daemon, 'request'], [daemon, socket, 'answer']]) {
      from.on('data', (bytes) => (cut(side, bytes.toString('latin1')) ? end() : to.write(bytes)));
      from.on('error', end).on('close', end);
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  server.unref();
  return `http://127.0.0.1:${server.address().port}`;
}

const cases = {
  async 'whole_way'() {
    const seen = [];
    const results = await client.render({ scene: { files: ['room.rad'] }, grids: GRIDS, ...QUICK,
      views: [{ name: 'north', view: '-vtv -vp 1.5 0.5 1.5 -vd 0 1 0', width: 16, height: 12 }] }, { folder, progress: (status) => { seen.push(status); } });
    assert.equal(seen.at(-1).state, 'succeeded');
    assert.ok(sent.some((line) => /GET .*\/events$/.test(line)), `${sent}`);
    assert.ok(sent.filter((line) => /^GET \/v1\/jobs\/[0-9a-f]+$/.test(line)).length <= 2, `events were listened to: ${sent}`);
    const values = await results.illuminances();
    assert.deepEqual(Object.keys(values), ['desks', 'wall']);
    assert.ok(values.desks instanceof Float64Array && values.desks.length === 2 && values.desks.every((value) => value > 0));
    const table = await results.table('wall');
    assert.equal(table.length, 1);
    assert.equal(table[0].illuminance_lx, values.wall[0]);
    assert.ok(table[0].low_95_lx <= values.wall[0] && values.wall[0] <= table[0].high_95_lx);
    const rows = await results.table();
    assert.deepEqual(oriel.tableOf(oriel.csvOf(rows)), rows);
    const paths = await results.job.fetch(join(folder, 'out'));
    const files = (await results.job.status()).files;
    assert.equal(paths.length, files.length);
    for (const { name: file, bytes } of files) assert.equal(statSync(join(folder, 'out', file)).size, bytes);
    assert.deepEqual(JSON.parse(readFileSync(join(folder, 'out/result.json'), 'utf8')), results.document);
    assert.ok(!readdirSync(join(folder, 'out')).some((file) => file.endsWith('.part')));
    const [plan] = await client.plan(await results.job.document());
    assert.equal(plan.plan.technique, 'backward');
    const links = await results.job.links(['north.png'], 60);
    assert.deepEqual([...new Uint8Array(await (await fetch(links['north.png'])).arrayBuffer()).subarray(1, 4)], [80, 78, 71]);
  },

  // The examples of the README, as they are written there.
  async 'example'() {
    const blocks = readFileSync(join(module_, 'README.md'), 'utf8').split('\n\n').map((text) => text.split('\n')).reduce((found, lines) => {
      if (!lines.every((line) => line.startsWith('    '))) return [...found, null];
      return found.at(-1) ? [...found.slice(0, -1), [...found.at(-1), ...lines]] : [...found, lines];
    }, []).filter(Boolean);
    assert.equal(blocks.length, 2);
    write('materials.rad', '# none\n');
    write('sky.rad', '# in the room\n');
    copyFileSync(join(fixtures, 'honeybee/two_rooms.hbjson'), join(folder, 'office.hbjson'));
    copyFileSync(join(fixtures, 'weather.epw'), join(folder, 'place.epw'));
    for (const [i, lines] of blocks.entries()) {
      assert.ok(lines.length <= 10, `${lines.length} lines`);
      const code = lines.map((line) => line.slice(4)).join('\n').replace('./oriel.js', pathToFileURL(join(module_, 'oriel.js')).href).replace('http://127.0.0.1:8423', url)
        .replace("rules: ['LEED']", "samples: 16, rules: ['LEED']"); // as it is written, but for the time that it takes
      write(`example${i}.mjs`, code);
      const said = execFileSync(process.execPath, [`example${i}.mjs`], { cwd: folder, encoding: 'utf8', env: { ...process.env, ORIEL_URL: url } });
      assert.match(said, i ? /LEED/ : /illuminance_lx/);
    }
    assert.ok(statSync(join(folder, 'out/result.json')).size > 0);
  },

  async 'upload_if_absent'() {
    const first = await scene();
    sent.length = 0;
    assert.equal(await scene(), first);
    assert.deepEqual(sent, [`HEAD /v1/scenes/${first}`]);
    write('window.rad', `# another\n${readFileSync(join(folder, 'window.rad'), 'utf8')}`);
    assert.notEqual(await scene(), first, 'files that a scene mentions count');
    // As in a browser: files, not paths.
    const texts = ['room.rad', 'window.rad'].map((file) => ({ name: file, text: readFileSync(join(folder, file), 'utf8') }));
    assert.equal(await client.uploadScene([texts[0]], { resources: [texts[1]] }), await scene());
    // BSDFs go once, by themselves or with a scene.
    const xml = readFileSync(join(fixtures, 'bsdf_klems41.xml'));
    write('pane.xml', xml);
    write('bsdf.rad', `void BSDF pane\n6 0 pane.xml 0 0 1 .\n0\n0\n${OPENING}`);
    const sha = createHash('sha256').update(xml).digest('hex');
    assert.equal(await client.uploadBsdf(join(folder, 'pane.xml')), sha);
    sent.length = 0;
    assert.equal(await client.uploadBsdf(join(folder, 'pane.xml')), sha);
    assert.deepEqual(sent, [`HEAD /v1/bsdfs/${sha}`]);
    sent.length = 0;
    const glazed = await client.uploadScene(['bsdf.rad'], { folder });
    assert.deepEqual(sent, [`HEAD /v1/scenes/${glazed}`, `HEAD /v1/bsdfs/${sha}`, 'POST /v1/scenes']);
    assert.equal(await client.uploadScene(['bsdf.rad'], { folder, bsdfs: { 'pane.xml': sha } }), glazed);
    assert.equal(await client.uploadScene(['bsdf.rad'], { resources: [], folder, bsdfs: { 'pane.xml': sha } }), glazed);
  },

  // A folder, its zip, and Honeybee models.
  async 'bundles'() {
    const place = mkdtempSync(join(folder, 'scene-'));
    for (const file of ['room.rad', 'window.rad']) copyFileSync(join(folder, file), join(place, file));
    const id = await client.upload(place);
    assert.deepEqual((await client.scene(id)).summary.main, ['room.rad']);
    sent.length = 0;
    assert.equal(await client.upload(place), id);
    assert.deepEqual(sent, [`HEAD /v1/scenes/${id}`]);
    writeFileSync(join(folder, 'scene.zip'), new Uint8Array(await (await oriel.Bundle.of(place)).body.arrayBuffer()));
    assert.equal(await new oriel.Client(url).uploadZip(join(folder, 'scene.zip')), id);
    assert.equal(await client.upload([new File([readFileSync(join(folder, 'scene.zip'))], 'scene.zip')]), id);
    const model = JSON.parse(readFileSync(join(fixtures, 'honeybee/two_rooms.hbjson'), 'utf8'));
    const weather = { name: 'place.epw', bytes: readFileSync(join(fixtures, 'weather.epw')) };
    const rooms = await client.uploadModel(model, { files: [weather] });
    const { project, main } = (await client.scene(rooms)).summary;
    assert.deepEqual(project.grids.map((grid) => grid.name), ['desks', 'store/floor']);
    assert.ok(main.length > 0);
    const group = Object.keys(project.states)[0], state = project.states[group].of[1];
    const other = await client.uploadModel(model, { files: [weather], states: { [group]: state } });
    assert.equal((await client.scene(other)).summary.project.states[group].chosen, state);
    const results = await client.render({ scene: { project: model }, sky: { cie: { type: 'overcast', diffuse_horizontal_lx: 10000 } }, ...QUICK });
    assert.deepEqual(Object.keys(await results.illuminances()), ['desks', 'store/floor']);
    await assert.rejects(client.upload([]), /no file/);
    await assert.rejects(client.upload('absent.rad'), /cannot read absent.rad/);
  },

  async 'skies_and_years'() {
    copyFileSync(join(fixtures, 'weather.epw'), join(folder, 'place.epw'));
    const hour = { month: 3, day: 22 };
    const hours = await client.render({ scene: { files: ['skyless.rad'] }, grids: GRIDS, ...QUICK,
      skies: { weather: { file: 'place.epw' }, from: { ...hour, hour: 10.5 }, to: { ...hour, hour: 11.5 } } }, { folder });
    const values = await hours.illuminances();
    assert.deepEqual(Object.keys(values), ['0322-1030', '0322-1130']);
    assert.deepEqual(Object.entries(values['0322-1030']).map(([grid, { length }]) => [grid, length]), [['desks', 2], ['wall', 1]]);
    await assert.rejects(hours.table(), oriel.OrielError);
    const year = await client.annual({ scene: { files: ['skyless.rad'] }, weather: 'place.epw', samples: 16, rules: ['LEED'],
      grids: [{ name: 'desks', sensors: { file: 'sensors.txt' } }, GRIDS[1]] }, { folder });
    const table = await year.table('desks');
    assert.equal(table.length, 2);
    assert.deepEqual([table[1].x, table[1].y, table[1].z], [1.5, 3, 0.8]);
    assert.ok(table[0]['mean illuminance (lx) low_95'] <= table[0]['mean illuminance (lx)']);
    const lit = await year.hours();
    assert.ok(lit.length > 0 && lit.some((row) => row.desks > 0));
    const [verdict] = year.verdicts();
    assert.match(verdict.rule, /LEED/);
    assert.ok(verdict.low_95 <= verdict.value && verdict.value <= verdict.high_95 && verdict.verdict);
    const glare = await client.glare({ scene: { files: ['room.rad'] }, ...QUICK, pixel_samples: 16, views: [{ name: 'eye', view: '-vta -vp 1.5 2 1.2 -vd 0 -1 0 -vh 180 -vv 180', width: 64, height: 64 }] }, { folder });
    const [dgp] = glare.glare();
    assert.equal(dgp.metric, 'dgp');
    assert.ok(dgp.view === 'eye' && dgp.value > 0 && dgp.low_95 <= dgp.value);
    const study = await client.study({ scene: { files: ['room.rad'] }, sensors: SENSORS, techniques: ['backward'], gather_samples: [16, 32], repeats: 2, reference: { samples: 256, runs: 2 } }, { folder });
    assert.equal(study.document.points.length, 2);
  },

  async 'panels'() {
    write('slats.rad', 'void plastic p 0 0 5 .5 .5 .5 0 0\np polygon s 0 0 12 0 0 0 1 0 0 1 .7 -.7 0 .7 -.7\n');
    const made = await client.makeBsdf({ scene: { files: ['slats.rad'] }, basis: 'klems_quarter', paths: 64 }, { folder });
    write('made.rad', `void BSDF slats\n6 0 slats.xml 0 0 1 .\n0\n0\n${OPENING.replace('pane', 'slats')}`);
    const id = await client.uploadScene(['made.rad'], { folder, bsdfs: { 'slats.xml': made.document.bsdf.id } });
    assert.equal((await client.scene(id)).summary.bsdfs, 1);
    const rows = [];
    for (const theta of [0, 40]) for (let out = 3; out < 90; out += 6) for (let phi = 0; phi < 360; phi += 15) rows.push(`${theta},0,${out},${phi},0.2\n`);
    const fitted = await client.fitBsdf({ measurements: { files: ['paper.csv'] }, basis: 'klems_quarter' },
      { files: [new File([`theta_in,phi_in,theta_out,phi_out,bsdf\n${rows.join('')}`], 'paper.csv')] });
    assert.ok(Math.abs(fitted.document.components.reflection_front.diffuse.value - 0.2 * Math.PI) < 0.005);
  },

  async 'cancel'() {
    const abort = new AbortController(), reason = new Error('the user closed the window');
    const job = await client.submit({ scene: await scene(), ...ENDLESS });
    setTimeout(() => abort.abort(reason), 300);
    await assert.rejects(job.wait({ signal: abort.signal }), reason);
    await assert.rejects(job.wait({ patience: 5 }), oriel.JobCancelled);
    assert.equal((await job.status()).state, 'cancelled');
    const other = await client.submit({ scene: await scene(), ...ENDLESS, seed: 2 });
    await assert.rejects(other.wait({ progress: ({ state }) => state !== 'running' }), oriel.JobCancelled);
    const third = await client.submit({ scene: await scene(), ...ENDLESS, seed: 3 });
    await assert.rejects(third.wait({ timeout: 0.3 }), oriel.TimedOut);
    assert.ok(['queued', 'running'].includes((await third.status()).state));
    await assert.rejects(third.remove(), oriel.InUse);
    await third.cancel();
    await assert.rejects(third.wait(), oriel.JobCancelled);
    await third.remove();
    await assert.rejects(third.status(), oriel.NotFound);
    await assert.rejects(client.run({ scene: await scene(), ...ENDLESS, seed: 4 }, { signal: AbortSignal.abort() }), { name: 'AbortError' });
  },

  // Where events do not arrive, waiting polls.
  async 'polling'() {
    const deaf = new oriel.Client(url, { fetch: (address, options) => (String(address).endsWith('/events') ? Promise.reject(new TypeError('blocked')) : noted(address, options)) });
    const job = await deaf.submit({ scene: await scene(), sensors: SENSORS, ...QUICK });
    const seen = [];
    await job.wait({ poll: 0.05, progress: ({ state }) => { seen.push(state); } });
    assert.equal(seen.at(-1), 'succeeded');
    sent.length = 0;
    await client.job(job.id).wait({ events: false });
    assert.deepEqual(sent, [`GET /v1/jobs/${job.id}`]);
  },

  // A connection that breaks after the daemon took the job makes no second one; a broken stream is resumed.
  async 'broken_connection'() {
    const id = await scene();
    const before = (await client.jobs({ scene: id, limit: 1000 })).length;
    const broken = { post: 0, stream: 0 };
    let posted = false, streams = 0;
    const shaky = new oriel.Client(await proxy((side, text) => {
      if (side === 'request') {
        posted = text.startsWith('POST /v1/jobs');
        streams += text.includes('/events ');
        return false;
      }
      if (posted && !broken.post) return Boolean(++broken.post);
      return !posted && /^id: /m.test(text) && !broken.stream && Boolean(++broken.stream);
    }));
    const job = await shaky.submit({ scene: id, sensors: SENSORS, accuracy: { deadline_s: 2 } });
    assert.equal(broken.post, 1);
    assert.equal((await client.jobs({ scene: id, limit: 1000 })).length, before + 1);
    const status = await job.wait({ poll: 0.05 });
    assert.ok(status.state === 'succeeded' && broken.stream === 1 && streams >= 2, `${broken.stream} breaks, ${streams} streams`);
    const gone = new oriel.Client(await proxy(() => true), { retries: 1 });
    await assert.rejects(gone.health(), oriel.Unreachable);
    await assert.rejects(gone.job(job.id).wait({ patience: 0.2, poll: 0.05 }), oriel.Unreachable);
    // A busy daemon is asked again, and one that stays busy is reported.
    let busy = 2;
    const turned = () => Promise.resolve(new Response('{"title": "It is busy", "status": 503}', { status: 503, headers: { 'Retry-After': '0' } }));
    const patient = new oriel.Client(url, { fetch: (address, options) => (busy-- > 0 ? turned() : fetch(address, options)) });
    assert.equal((await patient.health()).status, 'ok');
    await assert.rejects(new oriel.Client(url, { fetch: turned, retries: 1 }).health(), (error) => error instanceof oriel.Busy && error.retryAfter === 0);
  },

  async 'problems'() {
    const refused = async (promise, kind) => {
      const error = await promise.then(() => assert.fail('it was accepted'), (found) => found);
      assert.ok(error instanceof kind && error instanceof oriel.OrielError, `${error.stack}`);
      return error;
    };
    let error = await refused(client.submit({ scene: '0'.repeat(64), sedd: 1 }), oriel.Problem);
    assert.ok(error.status === 422 && error.message.includes('sedd') && error.kind);
    error = await refused(client.job('0'.repeat(32)).status(), oriel.NotFound);
    assert.equal(error.type, 'urn:oriel:error:no-such-resource');
    write('wrong.rad', 'void plastic grey\n0\n0\n5 0.5 0.5\n');
    error = await refused(client.uploadScene(['wrong.rad'], { folder }), oriel.Problem);
    assert.ok(error.file === 'wrong.rad' && error.line > 0 && error.detail && error.title, error.message);
    assert.match(error.message, /wrong\.rad, line \d/);
    error = await refused(client.submit({ scene: await client.uploadScene(['skyless.rad'], { folder }), sensors: { file: 'absent.txt' } }), oriel.Problem);
    assert.ok(error.detail);
    write('dark.rad', 'void plastic grey 0 0 5 .5 .5 .5 0 0\ngrey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0\n');
    error = await refused(client.render({ scene: { files: ['dark.rad'] }, sensors: SENSORS, ...QUICK }, { folder }), oriel.JobFailed);
    assert.ok(error.title && error.hint && error.message.includes(error.detail), `${JSON.stringify(error.document)}`);
    await refused(new oriel.Client('http://127.0.0.1:1', { retries: 0 }).health(), oriel.Unreachable);
    assert.throws(() => new oriel.Client('ftp://x'), oriel.OrielError);
    assert.throws(() => new oriel.Client('http://example.org', { token: 'oriel_x' }), /intercepted/);
    assert.equal(await refused(client.uploadBsdf({ name: 'x' }), oriel.OrielError).then(({ name: kind }) => kind), 'OrielError');
    error = await refused(client.render({ scene: { files: ['room.rad'] }, sensors: SENSORS }, { files: [new File(['#'], 'other.rad')] }), oriel.OrielError);
    assert.match(error.message, /room\.rad/);
  },

  async 'lists'() {
    const id = await scene();
    const jobs = [];
    for (const seed of [1, 2, 3]) jobs.push(await client.submit({ scene: id, sensors: SENSORS, ...QUICK, seed }, { name: `Büro ${seed}`, tags: ['listed', `${seed % 2}`] }));
    for (const job of jobs) await job.wait();
    assert.deepEqual((await client.jobs({ tags: ['listed', '1'], summary: true })).map((job) => job.name), ['Büro 3', 'Büro 1']);
    sent.length = 0;
    assert.equal((await client.list('/v1/jobs?tag=listed&limit=1', 'jobs', 3)).length, 3);
    assert.ok(sent.length === 3 && sent[1].includes('cursor='));
    assert.equal((await client.job(jobs[2].id.slice(0, 12)).status()).name, 'Büro 3');
    const stream = client.events({ tags: ['watched'] });
    assert.equal((await stream.next()).value.event, 'reset');
    const watched = await client.submit({ scene: id, sensors: SENSORS, ...QUICK, seed: 9 }, { tags: ['watched'] });
    let last;
    for await (const { event, data, id: position } of stream) {
      assert.equal(event, 'job');
      last = position;
      if (data.state === 'succeeded') break;
    }
    await watched.remove();
    const { value } = await client.events({ jobs: [watched.id], lastId: last }).next();
    assert.deepEqual([value.event, value.data], ['removed', { id: watched.id }]);
    assert.ok((await client.scenes()).some((one) => one.id === id));
    assert.ok(Array.isArray(await client.bsdfs()) && Array.isArray(await client.maps()));
    assert.ok((await client.limits()).views > 0 && (await client.health()).status === 'ok');
  },
};

await cases[name]();
process.exit(0); // connections that are kept open would hold the process
