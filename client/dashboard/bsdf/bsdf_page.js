// The list of BSDFs, uploaded alone or with a scene; and the page of one BSDF: findings of its check, scattering of light.

import { client, explain } from '../api.js';
import { NotFound } from '../oriel.js';
import { fill, h, setText } from '../dom.js';
import { bytes, count, moment, number, percent, shortId } from '../format.js';
import { facts, section } from '../job_parts.js';
import { legend } from '../viewer/legend.js';
import { roundUp } from '../viewer/palette.js';
import { PolarMap } from './polar.js';

const LEVELS = { ok: 'Sound', note: 'Note', warning: 'Warning', fault: 'Fault' };
const VERDICTS = { ok: 'No problems found.', note: 'Sound; see the notes.', warning: 'Use it with care.', fault: 'The file has faults.' };
const DECADES = 4;
const WAIT_MS = 120; // after the last move of a slider

const SIDES = { 0: 'from the right', 90: 'from above', 180: 'from the left', 270: 'from below' };
const angleWords = (key, angle) => `${angle}\u00b0${key === 'phi' && SIDES[angle] ? `, ${SIDES[angle]}` : ''}`;

export class BsdfsPage {
  title = 'BSDFs';

  constructor(app) {
    this.app = app;
    this.notice = h('div', { role: 'alert' });
    this.list = h('div', { class: 'stacked' });
    this.node = h('div', { class: 'page' }, h('h1', { tabindex: -1 }, 'BSDFs'), app.session.may('submit') && this.#drop(), this.notice, this.list);
    this.#load();
  }

  close() {}

  #drop() {
    const input = h('input', { id: 'xml', type: 'file', accept: '.xml', class: 'unseen', onchange: (event) => this.#send(event.target.files[0]) });
    const drop = h('div', { class: 'drop' }, h('p', {}, h('strong', {}, 'Drop a BSDF file (WINDOW XML) here')),
      h('p', { class: 'quiet' }, 'Oriel checks energy, reciprocity and direct transmission, and draws the scattering for every direction of light.'),
      h('div', { class: 'controls' }, input, h('label', { for: 'xml', class: 'button' }, 'Choose a file')));
    drop.addEventListener('dragover', (event) => { event.preventDefault(); drop.classList.add('over'); });
    drop.addEventListener('dragleave', () => drop.classList.remove('over'));
    drop.addEventListener('drop', (event) => { event.preventDefault(); drop.classList.remove('over'); this.#send(event.dataTransfer.files[0]); });
    return drop;
  }

  async #send(file) {
    if (!file) return;
    this.notice.replaceChildren(h('p', { class: 'quiet after' }, 'Sending and checking\u2026'));
    try {
      location.hash = `#/bsdfs/${await client.uploadBsdf(file)}`;
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice after' }, explain(error)));
    }
  }

  async #load() {
    try {
      const bsdfs = await client.bsdfs(200);
      this.list.replaceChildren(bsdfs.length === 0 ? h('p', { class: 'quiet' }, 'None yet. BSDFs that are dropped here or uploaded with a scene appear in this list.')
        : h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-label': 'BSDFs' }, h('table', { class: 'kept' },
          h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Name'), h('th', { scope: 'col' }, 'Origin'), ['Uploaded', 'Size', 'Scenes'].map((word) => h('th', { scope: 'col', class: 'n' }, word)))),
          h('tbody', {}, bsdfs.map((one) => h('tr', {}, h('td', {}, h('a', { href: `#/bsdfs/${one.id}` }, one.name)), h('td', {}, one.by_itself ? 'uploaded alone' : 'with a scene'),
            [moment(one.created_at), bytes(one.bytes), count(one.scene_count)].map((cell) => h('td', { class: 'n' }, cell))))))));
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice after' }, explain(error)));
    }
  }
}

export class BsdfPage {
  title = 'BSDF';
  state = { from: 'front', theta: 30, phi: 90 };

  constructor(app, id) {
    Object.assign(this, { app, id });
    this.heading = h('h1', { tabindex: -1 }, 'BSDF');
    this.verdict = h('p', { class: 'state' }, 'Loading');
    for (const name of ['notice', 'findings', 'scatter', 'angles', 'about']) this[name] = h('div', { class: 'part' });
    this.node = h('div', { class: 'page' }, h('p', { class: 'crumb' }, h('a', { href: '#/bsdfs' }, 'BSDFs')), this.heading, this.verdict, this.notice,
      h('div', { class: 'job stacked' }, h('div', { class: 'job-main' }, this.findings, this.scatter, this.angles), h('div', { class: 'job-side' }, this.about)));
    this.#load();
  }

  close() {
    clearTimeout(this.timer);
    this.maps?.forEach((map) => map.close());
    this.closed = true;
  }

  async #load() {
    try {
      this.bsdf = await client.bsdf(this.id);
      const bsdfs = await client.bsdfs(200).catch(() => []);
      this.name = bsdfs.find((one) => one.id === this.id)?.name;
      if (!this.closed) this.#show();
    } catch (error) {
      const text = error instanceof NotFound ? 'There is no such BSDF. It may have been removed.' : explain(error);
      setText(this.verdict, '');
      this.notice.replaceChildren(h('p', { class: 'notice' }, text));
    }
  }

  #show() {
    const { summary } = this.bsdf, { check } = summary;
    const name = summary.name || this.name || `BSDF ${shortId(this.id)}`;
    this.title = name;
    this.app.setTitle(name);
    setText(this.heading, name);
    setText(this.verdict, VERDICTS[check.verdict]);
    this.findings.append(section('findings', 'What the check found', h('ul', { class: 'findings' }, check.verdicts.map(({ level, text }) =>
      h('li', { 'data-level': level }, h('strong', {}, LEVELS[level]), h('span', {}, text))))));
    this.about.append(this.#about(summary));
    this.scatter.append(this.#scatter());
    this.#ask();
    this.#showAngles();
  }

  #about(summary) {
    const { components: has, check } = summary;
    const given = [has.reflection_front && 'reflection inside', has.reflection_back && 'reflection outside', has.transmission_front && 'transmission outwards', has.transmission_back && 'transmission inwards'].filter(Boolean).join(', ');
    const straight = check.straight_through.normal;
    return section('about', 'The file', facts([['Name', this.name], ['Kind', summary.kind], ['Directions', count(summary.resolution)], ['Values', count(summary.values)], ['Contains', given || 'nothing'],
      ['Colour', summary.colored ? 'yes' : 'no'], ['Thickness', summary.thickness_m > 0 ? `${number(1000 * summary.thickness_m)}\u202fmm` : null], ['Size', bytes(this.bsdf.bytes)],
      ['Largest R + T', `${percent(summary.max_albedo.front, 3)} inside, ${percent(summary.max_albedo.back, 3)} outside`], ['Direct transmission', straight ? `${percent(straight.straight)} at normal incidence` : null],
      ['Id', h('span', { class: 'mono wrap' }, this.id)]]));
  }

  // ---- Where light goes -------------------------------------------------------------------------

  #scatter() {
    const { state } = this;
    const side = (value, words) => h('label', {}, h('input', { type: 'radio', name: 'from', value, checked: value === state.from, onchange: () => { state.from = value; this.#ask(); this.#showAngles(); } }), h('span', {}, words));
    this.sliders = { theta: this.#slider('theta', 'From the normal', 0, 85, 'theta'), phi: this.#slider('phi', 'Azimuth', 0, 355, 'phi') };
    this.figures = h('div', {});
    this.readout = h('p', { class: 'readout quiet', 'aria-live': 'polite' }, 'Point at a map to read its values.');
    this.maps = ['Reflected', 'Transmitted'].map((label) => new PolarMap(label, (found) => this.#read(label, found)));
    this.legendPlace = h('div', {});
    return section('scatter', 'Where light goes',
      h('div', { class: 'incidence' }, h('fieldset', { class: 'modes across' }, h('legend', { class: 'unseen' }, 'Light comes from'), side('front', 'Light from inside'), side('back', 'Light from outside')), Object.values(this.sliders).map((one) => one.node)),
      this.figures,
      h('div', { class: 'polars' }, this.maps.map((map, i) => h('figure', {}, map.node, h('figcaption', {}, ['Reflected', 'Transmitted'][i]))), this.legendPlace),
      this.readout,
      h('p', { class: 'quiet after' }, 'Both maps are seen from inside, with the normal in the middle and rings at 30\u00b0 and 60\u00b0 from it. The circle marks the direction of the light, or its undeviated continuation. Values are f in 1/sr.'));
  }

  #slider(id, label, least, most, key) {
    const output = h('output', { for: id }, angleWords(key, this.state[key]));
    const input = h('input', { id, type: 'range', min: least, max: most, step: 5, value: this.state[key], oninput: () => {
      this.state[key] = Number(input.value);
      setText(output, angleWords(key, this.state[key]));
      this.#ask();
    } });
    return { node: h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: id }, label), output), input), input, output };
  }

  #ask() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.#look(), this.polar ? WAIT_MS : 0);
  }

  async #look() {
    const { from, theta, phi } = this.state, turn = (this.turn = {});
    try {
      const polar = await client.get(`/v1/bsdfs/${this.id}/polar?${new URLSearchParams({ from, theta_deg: theta, phi_deg: phi })}`, { cache: 'default' });
      if (turn !== this.turn || this.closed) return;
      this.polar = polar;
      this.notice.replaceChildren();
      this.#draw();
    } catch (error) {
      if (turn === this.turn) this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
    }
  }

  #draw() {
    const { polar } = this;
    const most = Math.max(...[polar.reflection, polar.transmission].map((rows) => Math.max(...rows.flat())));
    const top = most > 0 ? roundUp(most) : 1;
    const absorbed = Math.max(0, 1 - polar.reflected - polar.transmitted);
    fill(this.figures, polar, () => facts([['Reflected', percent(polar.reflected, 3)], ['Transmitted', percent(polar.transmitted, 3)], ['of that undeviated', percent(polar.straight, 3)], ['Absorbed', percent(absorbed, 3)]]));
    fill(this.legendPlace, top, () => legend(top, DECADES, '1/sr'));
    const from = { theta: polar.theta_deg, phi: polar.phi_deg };
    this.maps[0].show(polar.reflection, top, DECADES, from, `${percent(polar.reflected, 3)} of the light`);
    this.maps[1].show(polar.transmission, top, DECADES, { theta: from.theta, phi: from.phi + 180 }, `${percent(polar.transmitted, 3)} of the light`);
  }

  #read(label, found) {
    if (!found) return;
    setText(this.readout, `${label} at ${found.theta.join(' to ')}\u00b0 from the normal, azimuth ${found.phi.join(' to ')}\u00b0: ${number(found.value)}\u202f/sr, ${percent(found.light)} of the light`);
  }

  // ---- By angle ---------------------------------------------------------------------------------

  #showAngles() {
    const rows = this.bsdf.summary.check.hemispherical[this.state.from], { from } = this.state;
    const order = [90, 270, 0, 180];
    const at = (theta, phi) => rows.find((one) => one.theta_deg === theta && (theta === 0 || one.phi_deg === phi));
    const cell = (theta, phi) => {
      const found = at(theta, phi), text = `${percent(found.transmitted)} / ${percent(found.reflected)}`;
      const words = theta === 0 ? 'along the normal' : `${SIDES[phi]}, ${theta} degrees from the normal`;
      return h('td', { class: 'n', colspan: theta === 0 ? '4' : null }, h('button', { type: 'button', class: 'plain', 'aria-label': `${text}: show light ${words}`, onclick: () => this.#go(theta, phi) }, text));
    };
    fill(this.angles, from, () => section('angles', `Transmitted / reflected, light from ${from === 'front' ? 'inside' : 'outside'}`, h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-labelledby': 'angles' },
      h('table', { class: 'kept' }, h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Normal'), order.map((phi) => h('th', { scope: 'col', class: 'n' }, SIDES[phi])))),
        h('tbody', {}, [0, 15, 30, 45, 60, 75].map((theta) => h('tr', {}, h('th', { scope: 'row' }, `${theta}\u00b0`), (theta === 0 ? [90] : order).map((phi) => cell(theta, phi)))))))));
  }

  #go(theta, phi) {
    Object.assign(this.state, { theta, phi });
    for (const key of ['theta', 'phi']) {
      this.sliders[key].input.value = this.state[key];
      setText(this.sliders[key].output, angleWords(key, this.state[key]));
    }
    this.#ask();
    this.scatter.scrollIntoView({ block: 'nearest' });
  }
}
