// The user guide in the browser.

import assert from 'node:assert/strict';

// Pages of the dashboard, by their address, and where their help leads. %: the id of a job that has ended.
const HELP = { '#/jobs': 'jobs', '#/jobs/%': 'one-job', '#/view/%/north.hdr': 'pictures', '#/sensors/%': 'sensors', '#/new': 'new-job', '#/bsdfs': 'bsdfs', '#/cache': 'cache', '#/operations': 'operations' };

export function guideCases({ test, visit, browser, daemon, document, ended }) {
  test('the guide is read, leafed through and searched', () => visit({ path: '/guide', mayFail: (url) => url.endsWith('/guide/nowhere') }, async (page) => {
    await page.getByRole('heading', { level: 1 }).waitFor();
    assert.deepEqual(await browser.audit(page), []);
    await browser.keep(page, 'guide-start');
    const contents = page.getByRole('navigation', { name: 'Contents' });
    await contents.getByRole('link', { name: 'Use the dashboard' }).click();
    await page.getByRole('heading', { level: 1, name: 'Use the dashboard' }).waitFor();
    assert.equal(await contents.locator('[aria-current="page"]').innerText(), 'Use the dashboard');
    await page.waitForFunction(() => [...document.querySelectorAll('article img')].every((image) => image.complete && image.naturalWidth > 0));
    const here = page.url();
    const turns = page.getByRole('navigation', { name: 'Previous and next page' });
    await turns.getByRole('link', { name: /^Previous/ }).click();
    await turns.getByRole('link', { name: /^Next/ }).click();
    assert.equal(page.url(), here);
    await page.getByRole('searchbox', { name: 'Search the guide' }).fill('threshold share');
    await page.getByRole('button', { name: 'Search' }).click();
    await page.getByRole('status').getByText(/\d+ section/).waitFor();
    assert.deepEqual(await browser.audit(page), []);
    await browser.keep(page, 'guide-search');
    await page.getByRole('link', { name: /Use the dashboard . Sensors/ }).click();
    await page.getByRole('heading', { name: 'Sensors' }).waitFor();
    assert.equal(new URL(page.url()).hash, '#sensors');
    await page.goto(`${new URL(page.url()).origin}/guide/nowhere`);
    await page.getByRole('heading', { name: 'No such page' }).waitFor();
  }));

  for (const [look, options] of [['dark', { scheme: 'dark' }], ['phone', { width: 390, height: 844 }]])
    test(`the guide is legible: ${look}`, () => visit({ path: '/guide/howto/javascript', ...options }, async (page) => {
      await page.getByRole('heading', { level: 1 }).waitFor();
      assert.deepEqual(await browser.audit(page), []);
      const [width, view] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      assert.ok(width <= view, `the page is ${width} wide in a window of ${view}`);
      await browser.keep(page, `guide-${look}`);
      await page.emulateMedia({ media: 'print' });
      for (const part of ['.top', '#contents', '.turns']) assert.equal(await page.locator(part).isVisible(), false, `${part} is not printed`);
    }));

  test('help on each page of the dashboard leads to its section of the guide', () => visit({}, async (page) => {
    const id = await ended(document);
    for (const [address, section] of Object.entries(HELP)) {
      await page.goto(`${daemon().url}/${address.replace('%', id)}`);
      await page.locator(`#help[href="/guide/howto/dashboard#${section}"]`).waitFor();
    }
    await page.goto(`${daemon().url}/guide/howto/dashboard`);
    for (const section of [...Object.values(HELP), 'signing-in']) assert.equal(await page.locator(`[id="${section}"]`).count(), 1, section);
  }));
}
