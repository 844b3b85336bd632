// Signs in (exchanges a token for a cookie) and out; the scope of the session.

import { client, explain } from './api.js';
import { h } from './dom.js';

const SCOPES = ['read', 'submit', 'admin'];

export class Session {
  needed = false;
  signedIn = false;
  scope = null;
  name = null;

  async look() {
    this.#take(await client.get('/v1/session'));
  }

  #take({ needed, signed_in: signedIn, scope, token }) {
    Object.assign(this, { needed, signedIn, scope, name: token });
  }

  get open() {
    return !this.needed || this.signedIn;
  }

  may(scope) {
    return !this.needed || SCOPES.indexOf(this.scope) >= SCOPES.indexOf(scope);
  }

  async signIn(token) {
    this.#take(await (await client.request('POST', '/v1/session', { headers: { Authorization: `Bearer ${token}` } })).json());
  }

  async signOut() {
    await client.request('DELETE', '/v1/session');
    this.signedIn = false;
  }
}

const REFUSALS = { 401: 'The daemon does not know this token. It may be mistyped or revoked.' };

export class SignInPage {
  title = 'Sign in';

  constructor(app) {
    this.app = app;
    this.field = h('input', { id: 'token', type: 'password', autocomplete: 'current-password', spellcheck: 'false', required: true, 'aria-describedby': 'token-help token-fault' });
    this.fault = h('p', { id: 'token-fault', class: 'fault', role: 'alert' });
    this.button = h('button', { type: 'submit', class: 'main' }, 'Sign in');
    this.node = h('div', { class: 'page narrow' },
      h('h1', { tabindex: -1 }, 'Sign in'),
      h('form', { onsubmit: (event) => this.#submit(event) },
        h('label', { for: 'token' }, 'Access token'), this.field,
        h('p', { id: 'token-help', class: 'quiet' }, 'The administrator of the daemon creates one:'),
        h('pre', {}, 'orield token add studio --scope submit'),
        this.fault, this.button));
  }

  close() {}

  async #submit(event) {
    event.preventDefault();
    this.button.disabled = true;
    this.fault.textContent = '';
    try {
      await this.app.session.signIn(this.field.value.trim());
      this.field.value = '';
      this.app.enter();
    } catch (error) {
      this.fault.textContent = REFUSALS[error.status] || explain(error);
      this.field.select();
    }
    this.button.disabled = false;
  }
}
