// The frame of the dashboard: the current page, the connection to the daemon, the session.

import { explain, signals } from './api.js';
import { fill, h, setAttr, setText } from './dom.js';
import { Stream } from './events.js';
import { JobsPage } from './jobs_page.js';
import { Session, SignInPage } from './session.js';
import { Store } from './store.js';

const NAV = [['#/jobs', 'Jobs', 'read'], ['#/new', 'New job', 'submit'], ['#/bsdfs', 'BSDFs', 'read'], ['#/cache', 'Cache', 'read'], ['#/operations', 'Operations', 'read']];
const LINK_WORDS = { live: 'Live', connecting: 'Connecting', lost: 'No answer', refused: '', off: '', old: 'Another version' };

// Pages that are used rarely are loaded on demand. The last item is the section of the guide about the page.
const GUIDE = '/guide/howto/dashboard';
const ROUTES = [
  [/^\/jobs$/, (app, params) => new JobsPage(app, params), 'jobs'],
  [/^\/jobs\/([0-9a-f]+)$/, async (app, params, id) => new (await import('./job_page.js')).JobPage(app, id), 'one-job'],
  [/^\/view\/([0-9a-f]+)\/(.+)$/, async (app, params, id, file) => new (await import('./viewer/viewer_page.js')).ViewerPage(app, id, decodeURIComponent(file)), 'pictures'],
  [/^\/sensors\/([0-9a-f]+)$/, async (app, params, id) => new (await import('./sensors/sensors_page.js')).SensorsPage(app, id), 'sensors'],
  [/^\/new$/, async (app, params) => new (await import('./new/new_page.js')).NewPage(app, params), 'new-job'],
  [/^\/bsdfs$/, async (app) => new (await import('./bsdf/bsdf_page.js')).BsdfsPage(app), 'bsdfs'],
  [/^\/bsdfs\/([0-9a-f]+)$/, async (app, params, id) => new (await import('./bsdf/bsdf_page.js')).BsdfPage(app, id), 'bsdfs'],
  [/^\/cache$/, async (app) => new (await import('./cache_page.js')).CachePage(app), 'cache'],
  [/^\/operations$/, async () => new (await import('./operations_page.js')).OperationsPage(), 'operations'],
];

class App {
  session = new Session();
  stream = new Stream();
  store = new Store(this.stream);
  main = document.getElementById('main');
  banner = document.getElementById('banner');
  page = null;
  shown = {};

  constructor() {
    addEventListener('hashchange', () => this.route());
    signals.addEventListener('signed-out', () => this.#leave());
    this.stream.addEventListener('state', () => this.#showLink());
    this.stream.addEventListener('reset', () => this.#checkVersion());
  }

  async begin() {
    try {
      await this.session.look();
      this.enter();
    } catch (error) {
      this.#notice(explain(error));
      setTimeout(() => this.begin(), 2000);
    }
  }

  enter() {
    this.#notice('');
    if (this.session.open) this.stream.start();
    this.#showFrame();
    this.route();
  }

  #leave() {
    if (!this.session.needed || !this.session.signedIn) return;
    this.session.signedIn = false;
    this.stream.stop();
    this.#showFrame();
    this.route();
  }

  async #signOut() {
    this.stream.stop();
    try {
      await this.session.signOut();
    } catch (error) {
      this.#notice(explain(error));
    }
    location.hash = '#/jobs';
    this.enter();
  }

  #showFrame() {
    const { session } = this;
    const path = location.hash.slice(1).split('?')[0] || '/jobs';
    document.body.classList.toggle('closed', !session.open);
    fill(document.getElementById('nav'), [session.open, session.scope, path], () => session.open && NAV.filter(([, , scope]) => session.may(scope)).map(([href, words]) =>
      h('li', {}, h('a', { href, 'aria-current': path.startsWith(href.slice(1)) || (href === '#/jobs' && /^\/(view|sensors)\//.test(path)) ? 'page' : null }, words))));
    fill(document.getElementById('who'), [session.signedIn, session.name], () => session.signedIn && [
      h('span', { class: 'quiet' }, session.name),
      h('button', { type: 'button', class: 'plain', onclick: () => this.#signOut() }, 'Sign out')]);
  }

  #showLink() {
    const { state } = this.stream;
    const link = document.getElementById('link');
    setText(link, LINK_WORDS[state]);
    setAttr(link, 'data-state', state);
    clearTimeout(this.lateWord);
    if (state === 'lost') {
      const since = new Intl.DateTimeFormat('en-GB', { timeStyle: 'medium' }).format(new Date());
      this.lateWord = setTimeout(() => this.#notice(`The daemon does not answer. This page shows the state of ${since}; it reconnects automatically.`), 1500);
    }
    if (state === 'live') this.#notice('');
    if (state === 'old') this.#notice('The daemon is older than this page and sends no updates.', h('button', { type: 'button', onclick: () => location.reload() }, 'Load the matching page'));
    if (state === 'refused') this.session.look().then(() => this.enter(), () => {});
  }

  // A restarted daemon may have another version of the page.
  async #checkVersion() {
    const answer = await fetch(new URL('icon.svg', import.meta.url), { cache: 'no-store' }).catch(() => null);
    if (answer && answer.status === 404)
      this.#notice('The daemon was updated, and there is a new version of this page.', h('button', { type: 'button', onclick: () => location.reload() }, 'Load it'));
  }

  #notice(text, ...more) {
    this.banner.hidden = !text;
    this.banner.replaceChildren(text, ...more);
  }

  async route() {
    const [path, query] = (location.hash.slice(1) || '/jobs').split('?');
    const turn = (this.turn = {});
    const first = !this.page;
    let page, section = 'signing-in';
    if (this.session.open) {
      const found = ROUTES.find(([pattern]) => pattern.test(path));
      if (!found) {
        location.replace('#/jobs');
        return;
      }
      [,, section] = found;
      try {
        page = await found[1](this, new URLSearchParams(query), ...found[0].exec(path).slice(1));
      } catch (error) {
        this.#notice(explain(error));
        return;
      }
    } else {
      page = new SignInPage(this);
    }
    if (turn !== this.turn) {
      page.close();
      return;
    }
    this.page?.close();
    this.page = page;
    this.main.replaceChildren(page.node);
    document.getElementById('help').href = `${GUIDE}#${section}`;
    this.setTitle(page.title);
    this.#showFrame();
    scrollTo(0, 0);
    if (!first) page.node.querySelector('h1')?.focus({ preventScroll: true });
  }

  setTitle(title) {
    document.title = title ? `${title} \u2013 Oriel` : 'Oriel';
  }
}

new App().begin();
