// Cases of a daemon with hundreds of jobs, or with ORIEL_LONG with a thousand.

import assert from 'node:assert/strict';
import { Daemon, LONG, words } from './daemon.mjs';

const many = ['', '0', undefined].includes(process.env.ORIEL_LONG) ? 320 : 1000;

export function crowdCases({ test, visit, browser, build }) {
  test('a crowd of jobs is listed as one scrolls, in light and dark, on a phone, by the keyboard', async () => {
    const crowd = await new Daemon(build).start();
    try {
      await crowd.submit({ name: 'holds the queue', ...LONG });
      for (let i = 0; i < many; i += 40) await Promise.all(Array.from({ length: 40 }, (_, k) => crowd.submit({ ...words(`one of many ${i + k}`), seed: i + k })));
      await visit({ daemon: crowd }, (page) => scrollThrough(page));
      for (const [name, options] of [['light', {}], ['dark', { scheme: 'dark' }], ['phone', { width: 390, height: 844 }]])
        await visit({ daemon: crowd, ...options }, (page) => look(page, browser, name));
      await visit({ daemon: crowd }, (page) => walk(page));
      await visit({ daemon: crowd, path: '/#/new' }, (page) => overtake(page, crowd));
    } finally {
      await crowd.remove();
    }
  });
}

async function scrollThrough(page) {
  await page.getByText(/^The newest 100/).waitFor();
  for (let last = 0; ;) {
    await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
    const rows = await page.locator('tbody tr').count();
    if (rows === many + 1) break;
    if (rows === last) await page.waitForTimeout(30);
    last = rows;
  }
  assert.match(await page.locator('tbody tr').last().innerText(), /holds the queue/);
}

async function look(page, browser, name) {
  await page.getByText(/^The newest 100/).waitFor();
  assert.deepEqual(await browser.audit(page, { exclude: ['tbody tr:nth-child(n+12)'] }), []); // rows are alike
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'nothing beside the page');
  await page.screenshot({ path: `${browser.folder}/jobs-${name}.png` });
}

async function walk(page) {
  await page.getByText(/^The newest 100/).waitFor();
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.className), 'skip');
  const focused = () => page.evaluate(() => document.activeElement.textContent);
  for (let i = 0; i < 20 && !(await focused()).startsWith('one of many'); i++) await page.keyboard.press('Tab');
  const name = await focused();
  await page.keyboard.press('Enter');
  await page.getByRole('heading', { name }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.tagName), 'H1');
}

// Events of a job on a later page, of a new one, of one that ends and of one that goes, all told before a
// list comes that is older than they are.
async function overtake(page, crowd) {
  const { jobs } = await crowd.ask('GET', '/v1/jobs?fields=summary&limit=3');
  const held = [];
  let release = null;
  const released = new Promise((resolve) => { release = resolve; });
  await page.route(/\/v1\/jobs\?fields=summary/, async (route) => {
    const answer = await route.fetch();
    held.push(answer);
    await released;
    await route.fulfill({ response: answer });
  });
  await page.getByRole('status').getByText('Live').waitFor();
  await page.getByRole('link', { name: 'Jobs' }).click();
  while (!held.length) await page.waitForTimeout(10);
  await page.evaluate(() => {
    const dispatch = EventTarget.prototype.dispatchEvent;
    globalThis.told = [];
    EventTarget.prototype.dispatchEvent = function (event) {
      const result = dispatch.call(this, event);
      if (event.detail?.name) globalThis.told.push(event.detail.name);
      return result;
    };
  });
  const id = await crowd.submit(words('came meanwhile'));
  for (const job of jobs.slice(1)) await crowd.ask('POST', `/v1/jobs/${job.id}/cancel`);
  await crowd.ask('DELETE', `/v1/jobs/${jobs[2].id}`);
  // Events keep their order: the page has heard all of these when it hears the next of the job that runs.
  await page.evaluate(() => { globalThis.told = []; });
  await page.waitForFunction(() => globalThis.told.includes('holds the queue'));
  release();
  await page.getByText(/^The newest 100/).waitFor();
  const rows = await page.locator('tbody tr').evaluateAll((all) => all.map((one) => [one.querySelector('a').getAttribute('href').split('/').pop(), one.dataset.state]));
  assert.deepEqual(rows.slice(0, 3), [[id, 'queued'], [jobs[0].id, 'queued'], [jobs[1].id, 'cancelled']]);
  assert.ok(!rows.some(([one]) => one === jobs[2].id), 'what was removed is not shown');
  assert.equal(new Set(rows.map(([one]) => one)).size, 100);
  await page.unroute(/\/v1\/jobs\?fields=summary/);
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  await page.getByText(/^The newest 200/).waitFor();
}
