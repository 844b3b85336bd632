// The page of sensors: heat maps of their planes, a threshold and the fraction that reaches it.

import { client, explain } from '../api.js';
import { fill, h, setText } from '../dom.js';
import { count, jobName, number, percent } from '../format.js';
import { legend } from '../viewer/legend.js';
import { colorOf, roundUp, shareOf } from '../viewer/palette.js';
import { above, isOpen, planes, rowsOfCsv } from './planes.js';

const SHOWN = 500; // rows of the table; the file has all sensors

export class SensorsPage {
  title = 'Sensors';
  planes = [];
  rows = null;
  state = { threshold: 300, plane: 0, top: 1000, decades: 0 };

  constructor(app, id) {
    Object.assign(this, { app, id });
    this.crumb = h('p', { class: 'crumb' }, h('a', { href: '#/jobs' }, 'Jobs'), ' / ', h('a', { href: `#/jobs/${id}` }, 'Job'));
    this.notice = h('div', {}, h('p', { class: 'quiet' }, 'Loading'));
    this.canvas = h('canvas', { role: 'img', 'aria-label': 'Heat map', onpointermove: (event) => this.#point(event) });
    this.readout = h('p', { class: 'readout', 'aria-live': 'polite' });
    this.share = h('p', { class: 'figure', 'aria-live': 'polite' });
    this.panel = h('div', { class: 'panel' });
    this.table = h('div', { class: 'scroll listed', role: 'region', tabindex: 0, 'aria-label': 'Table of sensors' });
    this.stage = h('div', { class: 'stage plain' }, this.canvas);
    this.desk = h('div', { class: 'desk', hidden: true }, h('div', {}, this.share, this.stage, this.readout), this.panel);
    this.node = h('div', { class: 'page' }, this.crumb, h('h1', { tabindex: -1 }, 'Sensors'), this.notice, this.desk, this.table);
    this.observer = new ResizeObserver(() => this.#draw());
    this.observer.observe(this.stage);
    this.scheme = matchMedia('(prefers-color-scheme: dark)');
    this.recolor = () => this.#draw();
    this.scheme.addEventListener('change', this.recolor);
    this.#begin();
  }

  close() {
    this.observer.disconnect();
    this.scheme.removeEventListener('change', this.recolor);
  }

  async #begin() {
    try {
      this.job = await client.job(this.id).status();
      fill(this.crumb, this.job.name, () => [h('a', { href: '#/jobs' }, 'Jobs'), ' / ', h('a', { href: `#/jobs/${this.id}` }, jobName(this.job))]);
      this.app.setTitle(`Sensors, ${jobName(this.job)}`);
      const result = await client.job(this.id).result();
      this.skies = result.skies?.filter((sky) => !sky.dark) || null;
      this.document = await client.job(this.id).document();
      await this.#take(this.skies ? await this.#ofSky(this.skies[0]) : result);
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
    }
  }

  async #ofSky(sky) {
    this.sky = sky.name;
    return (await client.job(this.id).file(sky.file)).json();
  }

  async #take(result) {
    this.sensors = result.sensors || [];
    if (!this.sensors.length) {
      this.notice.replaceChildren(h('p', { class: 'empty' }, 'This job has no sensors.'));
      return;
    }
    this.rows ??= await this.#places(result);
    this.planes = this.rows.length === this.sensors.length ? planes(this.rows) : [];
    const values = this.sensors.map((one) => one.illuminance_lx).filter(Number.isFinite).sort((a, b) => a - b);
    this.state.top = roundUp(values[Math.floor((values.length - 1) * 0.99)] || 1);
    this.state.decades = this.state.top > 20 * values[values.length >> 1] ? 3 : 0; // the sun is on some
    this.desk.hidden = false;
    this.notice.replaceChildren();
    this.stage.hidden = !this.planes.length;
    if (!this.planes.length) this.notice.replaceChildren(h('p', { class: 'notice calm' }, 'The sensors come from a file of the scene, so their positions are not known here. Add heat_map to the job document to see them.'));
    this.#showPanel();
    this.#showTable();
    this.#update();
  }

  // Positions from the document, or else from the file of a job with a heat map.
  async #places(result) {
    if (Array.isArray(this.document.sensors)) return this.document.sensors;
    const csv = result.sensor_files?.csv;
    return csv ? rowsOfCsv(await (await client.job(this.id).file(csv)).text()) : [];
  }

  get plane() {
    return this.planes[this.state.plane];
  }

  get shown() {
    return this.plane ? this.plane.sensors.map(({ index }) => this.sensors[index]) : this.sensors;
  }

  #update() {
    const { threshold } = this.state;
    const { share, low, high, open } = above(this.shown, threshold);
    const range = open > 0 ? `between ${percent(low, 3)} and ${percent(high, 3)} by their 95\u202f% intervals` : 'for certain, by their 95\u202f% intervals';
    fill(this.share, [share, low, high, threshold], () => [h('strong', {}, percent(share, 3)), h('span', {}, ` have ${count(threshold)}\u202flx or more: ${range}`)]);
    this.canvas.setAttribute('aria-label', `Heat map of ${count(this.shown.length)} sensors; ${percent(share, 3)} have ${threshold} lx or more`);
    fill(this.legendPlace, [this.state.top, this.state.decades], () => legend(this.state.top, this.state.decades, 'lx'));
    this.#draw();
  }

  // Converts plane coordinates to canvas pixels.
  #fit() {
    const [u0, v0, u1, v1] = this.plane.box, { width, height } = this.canvas;
    const scale = Math.min((width - 24) / (u1 - u0), (height - 24) / (v1 - v0));
    const left = (width - scale * (u1 - u0)) / 2, low = (height + scale * (v1 - v0)) / 2;
    return { scale, place: (u, v) => [left + scale * (u - u0), low - scale * (v - v0)] };
  }

  #draw() {
    if (!this.plane) return;
    const ratio = devicePixelRatio || 1;
    this.canvas.width = this.stage.clientWidth * ratio;
    this.canvas.height = this.stage.clientHeight * ratio;
    const context = this.canvas.getContext('2d');
    const { place } = this.#fit();
    const style = getComputedStyle(document.documentElement);
    for (const { index, across, along } of this.plane.sensors) {
      const sensor = this.sensors[index];
      const [x, y] = place(across.from, along.to), [right, low] = place(across.to, along.from);
      const width = right - x, height = low - y;
      context.fillStyle = `rgb(${colorOf(shareOf(sensor.illuminance_lx ?? 0, this.state.top, this.state.decades)).join(' ')})`;
      context.fillRect(Math.round(x), Math.round(y), Math.ceil(width), Math.ceil(height));
      if (isOpen(sensor, this.state.threshold)) this.#hatch(context, x, y, width, height);
    }
    this.#edge(context, place, style.getPropertyValue('--ink'), ratio);
  }

  #hatch(context, x, y, width, height) {
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    context.strokeStyle = '#fff';
    for (let at = -height; at < width; at += 8 * (devicePixelRatio || 1)) {
      context.moveTo(x + at, y + height);
      context.lineTo(x + at + height, y);
    }
    context.stroke();
    context.restore();
  }

  // Draws a line between sensors that reach the threshold and neighbours that do not.
  #edge(context, place, ink, ratio) {
    const reaches = ({ index }) => this.sensors[index].illuminance_lx >= this.state.threshold;
    const lit = this.plane.sensors.filter(reaches), keys = new Set(lit.map(({ across, along }) => `${across.i},${along.i}`));
    const line = (from, to) => {
      context.moveTo(...place(...from));
      context.lineTo(...place(...to));
    };
    context.beginPath();
    for (const { across, along } of lit) {
      const [u0, u1, v0, v1] = [across.from, across.to, along.from, along.to];
      if (!keys.has(`${across.i - 1},${along.i}`)) line([u0, v0], [u0, v1]);
      if (!keys.has(`${across.i + 1},${along.i}`)) line([u1, v0], [u1, v1]);
      if (!keys.has(`${across.i},${along.i - 1}`)) line([u0, v0], [u1, v0]);
      if (!keys.has(`${across.i},${along.i + 1}`)) line([u0, v1], [u1, v1]);
    }
    context.strokeStyle = ink;
    context.lineWidth = 2 * ratio;
    context.stroke();
    context.lineWidth = 1;
  }

  #point(event) {
    const box = this.canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
    const at = [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
    const { place } = this.#fit();
    const found = this.plane.sensors.find(({ across, along }) => {
      const [x, y] = place(across.from, along.to), [right, low] = place(across.to, along.from);
      return at[0] >= x && at[0] < right && at[1] >= y && at[1] < low;
    });
    if (found) setText(this.readout, `${found.place.map((value) => number(value)).join(', ')}: ${this.#words(this.sensors[found.index])}`);
  }

  #words({ illuminance_lx: value, interval_95_lx: interval, unreliable }) {
    return `${number(value, 4)}\u202flx${interval ? `, ${number(interval[0], 4)} to ${number(interval[1], 4)}` : ''}${unreliable ? ', unreliable' : ''}`;
  }

  #slider(id, label, from, to, value, act) {
    const number_ = h('input', { id: `${id}-number`, type: 'number', min: 1, step: 'any', value, 'aria-label': `${label} as a number` });
    const range = h('input', { id, type: 'range', min: Math.log10(from), max: Math.log10(to), step: 0.01, value: Math.log10(value) });
    range.addEventListener('input', () => { number_.value = Number((10 ** range.value).toPrecision(2)); act(Number(number_.value)); });
    number_.addEventListener('input', () => { if (number_.value > 0) { range.value = Math.log10(number_.value); act(Number(number_.value)); } });
    return h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: id }, label)), h('div', { class: 'pair' }, range, number_));
  }

  #showPanel() {
    const { state } = this;
    this.legendPlace = h('div', {});
    this.panel.replaceChildren(...[
      this.skies && h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: 'sky' }, 'Sky')),
        h('select', { id: 'sky', onchange: async (event) => this.#take(await this.#ofSky(this.skies[event.target.selectedIndex])) },
          this.skies.map((sky) => h('option', { selected: sky.name === this.sky }, sky.name)))),
      this.planes.length > 1 && h('div', { class: 'control' }, h('div', { class: 'label' }, h('label', { for: 'plane' }, 'Plane')),
        h('select', { id: 'plane', onchange: (event) => { state.plane = event.target.selectedIndex; this.#showTable(); this.#update(); } },
          this.planes.map((plane, i) => h('option', { selected: i === state.plane }, plane.name)))),
      this.#slider('threshold', 'Threshold, lx', 1, 100000, state.threshold, (value) => { state.threshold = value; this.#update(); }),
      this.planes.length > 0 && this.#slider('scale-top', 'Top of the colours, lx', 10, 200000, state.top, (value) => { state.top = value; this.#update(); }),
      this.planes.length > 0 && h('label', { class: 'check' }, h('input', { type: 'checkbox', id: 'scale-log', checked: state.decades > 0, onchange: (event) => { state.decades = event.target.checked ? 3 : 0; this.#update(); } }), 'Logarithmic, three decades'),
      this.planes.length > 0 && this.legendPlace,
      this.planes.length > 0 && h('p', { class: 'quiet' }, 'The line surrounds sensors that reach the threshold. Hatched sensors have it within their interval.'),
      h('p', {}, h('a', { href: this.#csv(), download: 'sensors.csv' }, 'All sensors as CSV')),
    ].filter(Boolean));
  }

  #csv() {
    if (this.address) URL.revokeObjectURL(this.address);
    const lines = this.sensors.map((one, i) => [...(this.rows[i] || ['', '', '', '', '', '']), one.illuminance_lx, one.standard_error_lx, ...(one.interval_95_lx || ['', '']), (one.unreliable || []).join(' ')].join());
    this.address = URL.createObjectURL(new Blob([['x,y,z,dx,dy,dz,illuminance_lx,standard_error_lx,low_95_lx,high_95_lx,unreliable', ...lines].join('\n')], { type: 'text/csv' }));
    return this.address;
  }

  #showTable() {
    const list = (this.plane?.sensors || this.sensors.map((_, index) => ({ index }))).slice(0, SHOWN);
    const heads = ['Place', 'Illuminance, lx', 'Standard error', '95\u202f% interval'];
    fill(this.table, [this.state.plane, this.sky, this.job.finished], () => h('table', { class: 'sensors' },
      h('caption', {}, this.shown.length > SHOWN ? `The first ${SHOWN} of ${count(this.shown.length)}` : `${count(this.shown.length)} sensors`),
      h('thead', {}, h('tr', {}, heads.map((text, i) => h('th', { scope: 'col', class: i ? 'n' : '' }, text)))),
      h('tbody', {}, list.map(({ index, place }) => {
        const one = this.sensors[index], interval = one.interval_95_lx;
        return h('tr', {}, h('td', {}, place ? place.map((value) => number(value)).join(', ') : `Sensor ${index + 1}`), h('td', { class: 'n' }, number(one.illuminance_lx, 4)),
          h('td', { class: 'n' }, number(one.standard_error_lx ?? NaN, 2)), h('td', { class: 'n' }, interval ? `${number(interval[0], 4)} to ${number(interval[1], 4)}${one.unreliable ? ', unreliable' : ''}` : ''));
      }))));
  }
}
