// The viewer of HDR pictures: luminances, errors, glare sources.

import { client, explain, filePath } from '../api.js';
import { fill, h, setText, svg } from '../dom.js';
import { count, jobName, number, percent } from '../format.js';
import { Painter } from './gl.js';
import { legend } from './legend.js';
import { roundUp } from './palette.js';
import { load } from './picture.js';
import { Surface } from './surface.js';

const MODES = [['exposure', 'Exposure'], ['colors', 'False colours'], ['errors', 'Error'], ['eye', 'Human eye']];
const NUMBER = { exposure: 0, colors: 1, errors: 2, eye: 3 };
const FAR = 1e9; // a wipe beyond any picture

const isPicture = (name) => name.endsWith('.hdr') && !name.endsWith('.error.hdr');
const viewOf = (name) => name.replace(/\.hdr$/, '');

export class ViewerPage {
  title = 'Picture';
  state = { mode: 'exposure', ev: 0, top: 1000, decades: 0, lines: false, wipe: 0.5, glare: true, errorTop: 0.2, cover: 0.75 };

  constructor(app, id, file) {
    Object.assign(this, { app, id, file });
    this.canvas = h('canvas', { tabindex: 0, role: 'img', 'aria-label': 'Picture', 'aria-describedby': 'readout', onkeydown: (event) => this.#key(event) });
    this.overlay = svg('svg', { class: 'overlay', 'aria-hidden': 'true' });
    this.wipeBar = h('input', { type: 'range', class: 'wipe', min: 0, max: 1, step: 0.001, value: 0.5, 'aria-label': 'Where the two pictures meet', hidden: true, oninput: (event) => this.#set({ wipe: Number(event.target.value) }) });
    this.wipeLine = h('span', { class: 'wipe-line', 'aria-hidden': 'true', hidden: true });
    this.readout = h('p', { id: 'readout', class: 'readout', 'aria-live': 'polite' }, 'Loading the picture\u2026');
    this.notice = h('div', {});
    this.panel = h('div', { class: 'panel' });
    this.heading = h('h1', { tabindex: -1 }, viewOf(file));
    this.crumb = h('p', { class: 'crumb' }, h('a', { href: '#/jobs' }, 'Jobs'), ' / ', h('a', { href: `#/jobs/${id}` }, 'Job'));
    this.node = h('div', { class: 'page viewer' }, this.crumb, this.heading, this.notice,
      this.desk = h('div', { class: 'desk' },
        h('div', {}, h('div', { class: 'stage' }, this.canvas, this.overlay, this.wipeLine, this.wipeBar), this.readout), this.panel));
    this.heard = new AbortController();
    app.store.addEventListener('job', (event) => this.#renewed(event), { signal: this.heard.signal });
    this.#begin();
  }

  close() {
    this.heard.abort();
    this.surface?.close();
    this.painter?.gl.getExtension('WEBGL_lose_context')?.loseContext();
    this.closed = true;
  }

  async #begin() {
    try {
      this.painter = new Painter(this.canvas);
      this.job = await client.job(this.id).status();
      this.names = this.job.files?.map((one) => one.name) || (this.job.links.files || []).map((link) => decodeURIComponent(link.split('/').pop()));
      fill(this.crumb, this.job.name, () => [h('a', { href: '#/jobs' }, 'Jobs'), ' / ', h('a', { href: `#/jobs/${this.id}` }, jobName(this.job))]);
      this.app.setTitle(`${viewOf(this.file)}, ${jobName(this.job)}`);
      const document = await client.job(this.id).document().catch(() => ({}));
      this.unit = document.views?.find((view) => view.name === viewOf(this.file).split('.').pop())?.irradiance ? 'lx' : 'cd/m\u00b2';
      this.first = await load(this.id, this.file, this.names.includes(`${viewOf(this.file)}.error.hdr`));
      if (this.closed) return;
      this.#settle();
      this.#lookForGlare();
      this.#lookForOthers();
    } catch (error) {
      this.desk.hidden = true;
      this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)), this.job?.evicted ? h('p', { class: 'after' }, h('a', { href: `#/jobs/${this.id}` }, 'Run the job again to get them back')) : '');
    }
  }

  #settle() {
    this.painter.take('first', this.first);
    this.state.top = roundUp(179 * this.first.high);
    this.canvas.parentElement.style.setProperty('--aspect', this.first.width / this.first.height);
    this.surface = new Surface(this.canvas);
    this.surface.addEventListener('change', () => this.#draw());
    this.surface.addEventListener('point', (event) => this.#read(event.pixel));
    this.surface.addEventListener('region', (event) => this.#mark(event));
    this.surface.setSize([this.first.width, this.first.height]);
    this.#read([this.first.width >> 1, this.first.height >> 1]);
    this.#showPanel();
  }

  // A running job replaces its picture by one with less noise.
  async #renewed({ job, before }) {
    if (!job.id.startsWith(this.id) || !this.surface || !before || before.error === job.error || this.loading) return;
    this.loading = true;
    const found = await load(this.id, this.file, this.names.includes(`${viewOf(this.file)}.error.hdr`)).catch(() => null);
    this.loading = false;
    if (!found || this.closed) return;
    this.first = found;
    this.painter.take('first', found);
    this.#draw();
  }

  async #lookForGlare() {
    const result = await client.job(this.id).result().catch(() => null);
    this.glare = result?.views?.find((view) => view.hdr === this.file)?.glare || null;
    if (this.glare) this.#showPanel();
  }

  // Finds jobs of the scene with a picture of the same view.
  async #lookForOthers() {
    const jobs = await client.jobs({ scene: this.job.scene, limit: 50 }).catch(() => []);
    this.others = jobs.filter((job) => job.id !== this.job.id && !job.evicted && job.files?.some((one) => one.name === this.file));
    if (!this.closed) this.#showPanel();
  }

  async #compare(id) {
    this.second = null;
    this.other = this.others.find((job) => job.id === id) || null;
    if (this.other) {
      try {
        this.second = await load(id, this.file, this.other.files.some((one) => one.name === `${viewOf(this.file)}.error.hdr`));
        this.painter.take('second', this.second);
      } catch (error) {
        this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
      }
    }
    this.wipeBar.hidden = this.wipeLine.hidden = !this.second;
    this.#draw();
    this.#read(this.pixel);
  }

  #set(change) {
    Object.assign(this.state, change);
    this.#showLegend();
    this.#draw();
  }

  async #setMode(mode) {
    if (mode === 'eye' && !this.eye) {
      const answer = await fetch(filePath(this.id, `${viewOf(this.file)}.png`));
      this.eye = await createImageBitmap(await answer.blob());
      this.painter.takeEye(this.eye);
    }
    this.#set({ mode });
    this.#showParts();
  }

  // Shows only the controls that the current mode and isolines use.
  #showParts() {
    const uses = [this.state.mode, this.state.lines && this.state.mode !== 'errors' ? 'lines' : ''];
    for (const part of this.panel.querySelectorAll('[data-of]')) part.hidden = !part.dataset.of.split(' ').some((one) => uses.includes(one));
  }

  get auto() {
    return 0.18 / this.first.mean;
  }

  #draw() {
    if (!this.surface || this.closed) return;
    const { state, surface, first, second } = this;
    const errors = state.mode === 'errors';
    this.painter.draw({
      size: [first.width, first.height], otherSize: second ? [second.width, second.height] : [1, 1], scale: surface.scale, offset: surface.offset,
      mode: NUMBER[state.mode], exposure: this.auto * 2 ** state.ev, top: errors ? state.errorTop : state.top, decades: errors ? 0 : state.decades,
      bands: state.lines && !errors ? (state.decades > 0 ? 3 * state.decades : 10) : 0, cover: state.cover, wipe: second ? state.wipe * first.width : FAR,
    });
    this.#drawOverlay();
  }

  #drawOverlay() {
    const { surface, first, glare, state, marked } = this;
    const parts = [];
    if (state.glare && glare) this.#outlineGlare(parts);
    if (marked) {
      const [from, to] = [surface.placeOn(marked.from), surface.placeOn([marked.to[0] + 1, marked.to[1] + 1])];
      parts.push(svg('rect', { x: from[0], y: from[1], width: to[0] - from[0], height: to[1] - from[1] }));
    }
    if (this.cross && this.pixel) {
      const [x, y] = surface.placeOn([this.pixel[0] + 0.5, this.pixel[1] + 0.5]);
      parts.push(svg('path', { d: `M${x - 9} ${y}h6M${x + 3} ${y}h6M${x} ${y - 9}v6M${x} ${y + 3}v6` }));
    }
    if (this.second) this.#placeWipe(parts);
    this.overlay.replaceChildren(...parts);
  }

  // Draws the outline of pixels above the threshold, and the numbers of glare sources.
  #outlineGlare(parts) {
    const { surface, first, glare } = this;
    const [left, top] = surface.placeOn([0, 0]), scale = surface.scale / surface.ratio;
    if (this.outlined !== first) this.glareEdge = first.edgeOf(glare.threshold_cd_m2);
    this.outlined = first;
    parts.push(svg('path', { class: 'lit', d: this.glareEdge, transform: `translate(${left} ${top}) scale(${scale})` }));
    glare.sources.forEach((source, i) => {
      const [x, y] = surface.placeOn([source.position[0], first.height - source.position[1]]);
      parts.push(svg('text', { x, y: y + 5, 'text-anchor': 'middle' }, String(i + 1)));
    });
  }

  // The slider has the width of the picture, so that its thumb is on the line.
  #placeWipe(parts) {
    const { surface, first, state } = this;
    const [left, right] = [surface.placeOn([0, 0])[0], surface.placeOn([first.width, 0])[0]];
    const at = surface.placeOn([state.wipe * first.width, 0])[0];
    this.wipeLine.style.insetInlineStart = `${at}px`;
    Object.assign(this.wipeBar.style, { insetInlineStart: `${left - 8}px`, inlineSize: `${right - left + 16}px` });
    parts.push(svg('text', { x: at - 10, y: 22, 'text-anchor': 'end' }, 'A'), svg('text', { x: at + 10, y: 22 }, 'B'));
  }

  #words({ value, error }) {
    return `${number(value, 4)}${Number.isFinite(error) ? ` \u00b1\u202f${number(error, 2)}` : ''}\u202f${this.unit}`;
  }

  #read(pixel) {
    if (!pixel || !this.first) return;
    this.pixel = pixel;
    const place = `x ${pixel[0]}, y ${pixel[1]}`;
    const here = this.first.at(pixel);
    if (!this.second) {
      setText(this.readout, `${place}: ${this.#words(here)}`);
      return;
    }
    const there = this.second.at(scaled(pixel, this.first, this.second));
    setText(this.readout, `${place}: A ${this.#words(here)}, B ${this.#words(there)}, B \u2212 A ${percent(there.value / here.value - 1)}`);
  }

  #mark({ from, to }) {
    this.marked = { from: from.map((value, i) => Math.min(value, to[i])), to: to.map((value, i) => Math.max(value, from[i])) };
    const { mean, least, most, count: pixels } = this.first.region(from, to);
    fill(this.regionWords, [mean, least, most, pixels], () => h('dl', { class: 'facts' },
      [['Mean', mean], ['Minimum', least], ['Maximum', most]].map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, `${number(value, 4)}\u202f${this.unit}`))),
      h('div', {}, h('dt', {}, 'Pixels'), h('dd', {}, count(pixels)))));
    this.#drawOverlay();
  }

  #key(event) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key === '+' || event.key === '=') this.surface.zoom(1.25);
    else if (event.key === '-') this.surface.zoom(0.8);
    else if (event.key === '0') this.surface.fit();
    else if (moves[event.key]) {
      const most = [this.first.width - 1, this.first.height - 1], far = event.shiftKey ? 10 : 1;
      this.cross = true;
      this.#read(this.pixel.map((value, i) => Math.min(most[i], Math.max(0, value + far * moves[event.key][i]))));
      this.surface.show(this.pixel);
    } else return;
    event.preventDefault();
  }

  #showLegend() {
    const { mode, top, decades, errorTop, lines } = this.state;
    if (!this.legendPlace) return;
    fill(this.legendPlace, [mode, top, decades, errorTop, lines, this.unit], () =>
      (mode === 'colors' || (lines && mode !== 'errors') ? legend(top, decades, this.unit) : mode === 'errors' ? legend(100 * errorTop, 0, '%') : []));
  }

  #part(of, ...children) {
    return h('div', { class: 'control', 'data-of': of }, children);
  }

  #slider(id, label, value, range, words, act) {
    const output = h('output', { for: id }, words(value));
    const input = h('input', { id, type: 'range', ...range, value, oninput: () => { setText(output, words(Number(input.value))); act(Number(input.value)); } });
    return { node: [h('div', { class: 'label' }, h('label', { for: id }, label), output), input], input, output };
  }

  #showPanel() {
    const { state, first, others = [] } = this;
    const ev = (value) => `${value > 0 ? '+' : value < 0 ? '\u2212' : ''}${number(Math.abs(value), 2)} EV, white ${number(179 / (this.auto * 2 ** value), 3)}\u202f${this.unit}`;
    const exposure = this.#slider('ev', 'Exposure', state.ev, { min: -8, max: 8, step: 0.1 }, ev, (value) => this.#set({ ev: value }));
    const light = (value) => `${number(10 ** value, 3)}\u202f${this.unit}`;
    const top = this.#slider('top', 'Top of the scale', Math.log10(state.top), { min: -1, max: 6, step: 0.02 }, light, (value) => this.#set({ top: Number((10 ** value).toPrecision(2)) }));
    const worst = this.#slider('error-top', 'Top of the scale', Math.log10(100 * state.errorTop), { min: -1, max: 2, step: 0.02 }, (value) => `${number(10 ** value, 2)}\u202f%`, (value) => this.#set({ errorTop: 10 ** value / 100 }));
    const cover = this.#slider('cover', 'Opacity over the picture', state.cover, { min: 0, max: 1, step: 0.05 }, (value) => percent(value), (value) => this.#set({ cover: value }));
    const check = (id, label, key, change) => h('label', { class: 'check' }, h('input', { type: 'checkbox', id, checked: !!state[key], onchange: (event) => change(event.target.checked) }), label);
    const setExposure = (value) => { exposure.input.value = value; setText(exposure.output, ev(value)); this.#set({ ev: value }); };
    this.legendPlace = h('div', {});
    this.regionWords = h('div', {});
    const modes = MODES.filter(([mode]) => (mode !== 'errors' || first.knowsErrors) && (mode !== 'eye' || this.names.includes(`${viewOf(this.file)}.png`)));
    this.panel.replaceChildren(...[
      this.#views(),
      h('fieldset', { class: 'modes' }, h('legend', { class: 'unseen' }, 'Shown as'), modes.map(([mode, words]) => h('label', {},
        h('input', { type: 'radio', name: 'mode', value: mode, checked: mode === state.mode, onchange: () => this.#setMode(mode) }), h('span', {}, words)))),
      this.#part('exposure', exposure.node, h('button', { type: 'button', onclick: () => setExposure(0) }, 'Auto')),
      this.#part('exposure colors eye', check('lines', 'Isolines (means of nine pixels)', 'lines', (on) => { this.#set({ lines: on }); this.#showParts(); })),
      this.#part('colors lines', top.node, check('log', 'Logarithmic, three decades', 'decades', (on) => this.#set({ decades: on ? 3 : 0 }))),
      this.#part('errors', worst.node, cover.node),
      this.legendPlace,
      h('div', { class: 'control' }, h('div', { class: 'label' }, h('span', { class: 'name' }, 'Zoom')), h('div', { class: 'buttons' },
        h('button', { type: 'button', onclick: () => this.surface.fit() }, 'Fit'), h('button', { type: 'button', onclick: () => this.surface.zoomTo(1) }, '1:1'),
        h('button', { type: 'button', 'aria-label': 'Closer', onclick: () => this.surface.zoom(1.5) }, '+'), h('button', { type: 'button', 'aria-label': 'Farther', onclick: () => this.surface.zoom(1 / 1.5) }, '\u2212'))),
      h('div', { class: 'control' }, check('region', 'Measure a region by dragging', 'region', (on) => {
        this.surface.region = state.region = on;
        if (!on) { this.marked = null; this.regionWords.replaceChildren(); this.#drawOverlay(); }
      }), this.regionWords),
      this.glare && h('div', { class: 'control' }, check('glare', `Glare sources (${this.glare.sources.length})`, 'glare', (on) => this.#set({ glare: on })),
        this.glare.metrics.dgp && h('p', { class: 'quiet' }, `DGP ${number(this.glare.metrics.dgp.value, 3)}, ${this.glare.class}`),
        h('p', { class: 'quiet' }, `Outlined: above ${number(this.glare.threshold_cd_m2)}\u202fcd/m\u00b2`),
        h('ol', { class: 'sources' }, this.glare.sources.slice(0, 8).map((source) => h('li', {}, `${number(source.luminance_cd_m2)}\u202fcd/m\u00b2, ${number(source.solid_angle_sr, 2)}\u202fsr`)))),
      others.length > 0 && h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: 'other' }, 'Beside it (B)')),
        h('select', { id: 'other', onchange: (event) => this.#compare(event.target.value) }, h('option', { value: '' }, 'nothing'),
          others.map((job) => h('option', { value: job.id, selected: job.id === this.other?.id }, `${jobName(job)}${job.technique ? `, ${job.technique}` : ''}`)))),
      h('p', { class: 'quiet' }, h('a', { href: filePath(this.id, this.file) }, 'Download HDR'), `, ${first.width} \u00d7 ${first.height}`),
    ].filter(Boolean));
    this.#showParts();
    this.#showLegend();
    this.#draw();
  }

  #views() {
    const names = this.names.filter(isPicture);
    if (names.length < 2) return null;
    return h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: 'view' }, 'View')),
      h('select', { id: 'view', onchange: (event) => { location.hash = `#/view/${this.id}/${encodeURIComponent(event.target.value)}`; } },
        names.map((name) => h('option', { value: name, selected: name === this.file }, viewOf(name)))));
  }
}

// Converts a pixel to the same position in a picture of another size.
function scaled([x, y], from, to) {
  return [Math.floor(((x + 0.5) * to.width) / from.width), Math.floor(((y + 0.5) * to.height) / from.height)];
}
