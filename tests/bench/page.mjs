// The dashboard's own cost, in Chromium: bytes, first paint, processor time with a running job in view,
// memory over an hour of events that pass in seconds. Lines "what|measured|wanted|yes or no" for
// tests/bench/dashboards.py. Usage: node tests/bench/page.mjs BUILD.

import { Browser } from '../browser/browser.mjs';
import { Daemon, SENSORS, VIEW } from '../browser/daemon.mjs';

const build = process.argv[2] || 'build';
const LOADS = 5, WATCHED_S = 10, PARTS = 12, PER_PART = 1200; // an hour: four events a second, in parts of five minutes
const daemon = await new Daemon(build).start();
const browser = new Browser(build);
await browser.start();

const row = (what, measured, wanted, met) => process.stdout.write(`${what}|${measured}|${wanted}|${met ? 'yes' : 'no'}\n`);

async function cost() {
  const id = await daemon.submit({ name: 'watched', sensors: SENSORS, views: [VIEW], accuracy: { deadline_s: 3600 } });
  await daemon.wait(id, (job) => job.state === 'running' && job.accuracy?.rounds > 1);
  const { page, close } = await browser.open(daemon);
  const client = await page.context().newCDPSession(page);
  let bytes = 0;
  await client.send('Network.enable');
  client.on('Network.loadingFinished', (event) => { bytes += event.encodedDataLength; });
  await client.send('Network.setCacheDisabled', { cacheDisabled: true });
  const loads = [];
  for (let i = 0; i < LOADS; i++) { // other work on the machine only adds to them
    await page.goto('about:blank');
    bytes = 0;
    await page.goto(`${daemon.url}/#/jobs/${id}`);
    await page.locator('canvas').waitFor();
    await page.waitForTimeout(500);
    loads.push({ bytes, paint: await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? Infinity) });
  }
  const least = (name) => Math.min(...loads.map((one) => one[name]));
  row('the page of a running job, with chart and picture', `${(least('bytes') / 1000).toFixed(0)} kB`, '< 150 kB', least('bytes') < 150000);
  row(`  first paint, the soonest of ${LOADS}`, `${least('paint').toFixed(0)} ms`, '< 1000 ms', least('paint') < 1000);
  await client.send('Performance.enable', { timeDomain: 'threadTicks' });
  const busy = async () => (await client.send('Performance.getMetrics')).metrics.find((one) => one.name === 'TaskDuration').value;
  const before = await busy();
  await page.waitForTimeout(1000 * WATCHED_S);
  const share = (await busy() - before) / WATCHED_S;
  row('  its main thread while the job runs', `${(100 * share).toFixed(1)} % of a core`, '< 5 %', share < 0.05);
  await close();
  await daemon.ask('POST', `/v1/jobs/${id}/cancel`);
}

// Events as the daemon sends them, of a job that runs and of others that come and end.
function part(job, number) {
  let text = '';
  for (let i = 0; i < PER_PART; i++) {
    const at = number * PER_PART + i, other = (at >> 2).toString(16).padStart(32, '0');
    const one = i % 4 === 3 ? { ...job, id: other, name: `of the hour ${at >> 2}`, state: 'succeeded', percent: 100 }
      : { ...job, percent: (100 * at) / (PARTS * PER_PART), error: 1 / Math.sqrt(1 + at), eta_s: PARTS * PER_PART - at };
    text += `id: 1-${at + 1}\nevent: job\ndata: ${JSON.stringify(one)}\n\n`;
    if (i % 4 === 3 && at >= 400) text += `event: removed\ndata: ${JSON.stringify({ id: ((at >> 2) - 100).toString(16).padStart(32, '0') })}\n\n`;
  }
  return text;
}

async function hour() {
  const id = await daemon.submit({ name: 'of an hour', sensors: SENSORS, technique: 'backward', gather_samples: 8 });
  await daemon.wait(id);
  const job = { ...(await daemon.ask('GET', '/v1/jobs?fields=summary&limit=1')).jobs[0], state: 'running' };
  const { page, close } = await browser.open(daemon, { path: '/#/jobs' });
  const client = await page.context().newCDPSession(page);
  let number = 0;
  await page.getByText('of an hour').waitFor();
  await page.route('**/v1/events', (route) => (number < PARTS
    ? route.fulfill({ status: 200, headers: { 'Content-Type': 'text/event-stream' }, body: part(job, number++) }) : route.continue()));
  await daemon.stop();
  await daemon.start();
  const sizes = [];
  while (sizes.length < PARTS) {
    const last = ((number * PER_PART - 1) >> 2);
    if (number > sizes.length) {
      await page.getByText(`of the hour ${last}`, { exact: true }).first().waitFor({ timeout: 30000 });
      await client.send('HeapProfiler.collectGarbage');
      sizes.push((await client.send('Runtime.getHeapUsage')).usedSize);
    }
    await page.waitForTimeout(50);
  }
  await close();
  const grown = sizes.at(-1) - sizes[1];
  row(`memory over an hour, ${PARTS * PER_PART} events`, `${(grown / 2 ** 20 >= 0 ? '+' : '')}${(grown / 2 ** 20).toFixed(2)} of ${(sizes[1] / 2 ** 20).toFixed(1)} MiB`, '< 1 MiB more', grown < 2 ** 20);
}

try {
  await cost();
  await hour();
} finally {
  await browser.stop();
  await daemon.remove();
}
