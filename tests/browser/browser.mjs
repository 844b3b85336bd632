// Chromium, and pages that keep account of what a page must not do.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

export class Browser {
  constructor(build) {
    this.folder = resolve(build, 'browser');
    const require = createRequire(`${this.folder}/`);
    this.playwright = require('playwright-core');
    this.axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
  }

  async start() {
    this.browser = await this.playwright.chromium.launch({
      executablePath: '/usr/bin/chromium',
      args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    });
  }

  async stop() {
    await this.browser?.close();
  }

  // faults: console errors, exceptions, CSP reports, requests to elsewhere. mayFail: of an address that
  // is expected not to answer, as of a daemon that is killed. prepare: of the page before it is asked for.
  async open(daemon, { path = '/', scheme = 'light', width = 1280, height = 860, mayFail = () => false, prepare = () => {} } = {}) {
    const context = await this.browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: 'reduce' });
    const page = await context.newPage();
    page.setDefaultTimeout(90000);
    const faults = [];
    page.on('console', (message) => {
      if (message.type() === 'error' && !mayFail(message.location().url, message.text())) faults.push(`console: ${message.text()} ${message.location().url}`);
    });
    page.on('pageerror', (error) => faults.push(`exception: ${error.stack}`));
    page.on('request', (request) => {
      if (!request.url().startsWith(daemon.url) && !request.url().startsWith('blob:')) faults.push(`elsewhere: ${request.url()}`);
    });
    await page.addInitScript(() => {
      addEventListener('securitypolicyviolation', (event) => console.error(`CSP: ${event.violatedDirective} ${event.blockedURI}`));
    });
    await prepare(page);
    await page.goto(daemon.url + path);
    return { page, faults, close: () => context.close() };
  }

  // Findings of axe-core that are serious or worse, each as a line. parts: of the document, as axe takes them.
  async audit(page, parts = { include: ['html'] }) {
    await page.evaluate(this.axe);
    const { violations } = await page.evaluate((of) => globalThis.axe.run(of, { resultTypes: ['violations'] }), parts);
    return violations.filter((one) => ['serious', 'critical'].includes(one.impact))
      .map((one) => `${one.id}: ${one.nodes.slice(0, 3).map((node) => node.html).join(' | ')}`);
  }

  async keep(page, name) {
    await page.screenshot({ path: `${this.folder}/${name}.png`, fullPage: true });
  }
}
