// The form for a new job: scene, sky, sensors, views, accuracy, and the predicted time.

import { client, explain } from '../api.js';
import { h, setText } from '../dom.js';
import { bytes, count, duration, moment, number, shortId } from '../format.js';
import * as parts from '../job_parts.js';
import { documentOf, gridOf } from './document.js';
import { ordered } from './mains.js';
import { Outline } from './outline.js';
import { PlanPart } from './plan_part.js';
import { bundleOf, ofChoice, ofDrop } from './dropped.js';

const SKIES = [['own', 'The scene\u2019s own'], ['overcast', 'CIE overcast'], ['clear', 'CIE clear'], ['perez', 'Measured (Perez)'], ['weather', 'Weather file of the scene']];

function field(name, label, value, more = {}) {
  const id = `f-${name}`;
  return h('div', { class: 'field' }, h('label', { for: id }, label), h('input', { id, name, type: 'number', step: 'any', required: true, value, ...more }));
}

function radio(name, value, label, checked) {
  return h('label', { class: 'check' }, h('input', { type: 'radio', name, value, checked }), label);
}

// Shown only while the choice has one of the values. Hidden fields are not validated.
function when(name, values, ...children) {
  return h('fieldset', { class: 'when', 'data-name': name, 'data-values': values }, children);
}

export class NewPage {
  title = 'New job';
  scene = null;

  constructor(app, params) {
    this.app = app;
    this.notice = h('div', { role: 'alert' });
    this.sceneWords = h('div', {});
    this.planPlace = h('div', { 'aria-live': 'polite' });
    this.form = h('form', { hidden: true, onsubmit: (event) => this.#submit(event), onchange: () => this.#settle(), oninput: () => this.#settle() });
    this.node = h('div', { class: 'page new' }, h('h1', { tabindex: -1 }, 'New job'), this.#scenePart(), this.notice, this.sceneWords, this.form, this.planPlace);
    this.#listScenes(params.get('scene'));
  }

  close() {
    this.plan?.close();
  }

  #scenePart() {
    const choose = (id, label, more) => [h('input', { id, type: 'file', class: 'unseen', ...more, onchange: (event) => this.#take(ofChoice(event.target.files)) }), h('label', { for: id, class: 'button' }, label)];
    this.drop = h('div', { class: 'drop' }, h('p', {}, h('strong', {}, 'Drop a Radiance scene here, a folder or a zip, or a Honeybee model')),
      h('p', { class: 'quiet' }, 'Include all files that it refers to: materials, geometry, BSDFs, weather.'),
      h('div', { class: 'controls' }, choose('folder', 'Choose a folder', { webkitdirectory: true }), choose('files', 'Choose files, a zip or a model', { multiple: true })));
    this.drop.addEventListener('dragover', (event) => { event.preventDefault(); this.drop.classList.add('over'); });
    this.drop.addEventListener('dragleave', () => this.drop.classList.remove('over'));
    this.drop.addEventListener('drop', (event) => { event.preventDefault(); this.drop.classList.remove('over'); this.#take(ofDrop(event.dataTransfer)); });
    this.scenes = h('select', { id: 'scene', onchange: (event) => event.target.value && this.#choose(event.target.value) }, h('option', { value: '' }, 'a stored scene'));
    this.known = h('p', { class: 'known', hidden: true }, h('label', { for: 'scene' }, 'Or'), ' ', this.scenes);
    return h('section', { 'aria-label': 'Scene' }, this.drop, this.known);
  }

  async #listScenes(chosen) {
    const scenes = await client.scenes().catch(() => []);
    this.known.hidden = !scenes.length;
    this.scenes.append(...scenes.map((one) => h('option', { value: one.id, selected: one.id === chosen }, `${shortId(one.id)}, ${bytes(one.bytes)}, ${moment(one.created_at)}, ${count(one.jobs)} job${one.jobs === 1 ? '' : 's'}`)));
    if (chosen) this.#choose(chosen);
  }

  #say(error) {
    this.notice.replaceChildren(...(error ? [h('p', { class: 'notice' }, typeof error === 'string' ? error : explain(error))] : []));
  }

  async #take(found) {
    this.#say('');
    this.sceneWords.replaceChildren(h('p', { class: 'quiet' }, 'Reading, sending and checking\u2026'));
    try {
      this.dropped = await bundleOf(await found);
      this.chosen = [];
      this.choices = {};
      await this.#send();
    } catch (error) {
      this.#say(error);
    }
  }

  // Uploads the dropped files, with the chosen main files if there are any.
  async #send() {
    const { bundle, mains } = this.dropped, { chosen } = this;
    this.#say('');
    this.names = bundle.names;
    this.sceneWords.replaceChildren(h('p', { class: 'quiet' }, 'Reading, sending and checking\u2026'));
    try {
      const id = await client.upload(bundle, { main: chosen, ...this.choices });
      await this.#show(await client.scene(id));
    } catch (error) {
      this.sceneWords.replaceChildren(mains?.all.length > 1 ? parts.section('mains', 'Scene', this.#mains(chosen.length ? chosen : mains.all, mains.all)) : '');
      this.form.hidden = true;
      this.#say(error);
    }
  }

  // Choice of main files: often not all files of a folder belong to the scene.
  #mains(chosen, others) {
    const files = this.dropped.mains?.files || [];
    const known = [...new Set([...chosen, ...others])], left = others.filter((name) => !chosen.includes(name));
    const boxes = known.map((name, i) => h('label', { class: 'check' }, h('input', { type: 'checkbox', id: `main-${i}`, value: name, checked: chosen.includes(name) }), name));
    const again = () => {
      const picked = boxes.map((box) => box.firstChild).filter((box) => box.checked).map((box) => box.value);
      const seen = picked.map((name) => files.find((one) => one.name === name));
      this.chosen = seen.every(Boolean) ? ordered(seen) : picked;
      if (this.chosen.length) this.#send();
    };
    return h('details', { class: 'mains' }, h('summary', {}, `Read: ${chosen.join(', ')}${left.length ? `, not ${left.slice(0, 4).join(', ')}${left.length > 4 ? ` and ${left.length - 4} more` : ''}` : ''}`),
      h('p', { class: 'quiet' }, 'Main files of the scene. They are read in an order in which names are defined before they are used.'), boxes, h('button', { type: 'button', onclick: again }, 'Read these'));
  }

  // Choices of a Honeybee project: a state for each group of windows, and one of its skies.
  #projectPart({ states, skies, left_out: leftOut }) {
    const choices = Object.entries(states).map(([group, { chosen, of }]) => ({ label: group, group, chosen, of }));
    if (skies.length > 1) choices.push({ label: 'Sky of the project', chosen: this.choices.sky || '', of: ['', ...skies] });
    const several = choices.filter(({ of }) => of.length > 1);
    const again = () => {
      this.choices = { states: {}, sky: '' };
      for (const [i, { group }] of several.entries()) {
        if (group) this.choices.states[group] = selects[i].value;
        else this.choices.sky = selects[i].value;
      }
      this.#send();
    };
    const selects = several.map(({ chosen, of }, i) => h('select', { id: `choice-${i}`, disabled: !this.dropped, onchange: again }, of.map((name) => h('option', { value: name, selected: name === chosen }, name || 'None'))));
    const more = leftOut.length - 8;
    return [selects.length > 0 && h('div', { class: 'fields' }, selects.map((select, i) => h('div', { class: 'field' }, h('label', { for: select.id }, several[i].label), select))),
      leftOut.length > 0 && h('p', { class: 'quiet' }, `Left out: ${leftOut.slice(0, 8).map(({ file, why }) => `${file} (${why})`).join(', ')}${more > 0 ? ` and ${more} more` : ''}`)];
  }

  async #choose(id) {
    this.dropped = null;
    this.choices = {};
    this.#say('');
    try {
      this.names = [];
      await this.#show(await client.scene(id));
    } catch (error) {
      this.#say(error);
    }
  }

  async #show(scene) {
    this.scene = scene;
    const { surfaces, materials, sources, bsdfs, bounds, referenced, main = [], unread = [], project } = scene.summary;
    const extent = bounds.min.every(Number.isFinite) ? bounds.min.map((low, i) => number(bounds.max[i] - low)).join(' \u00d7 ') : '';
    this.outline = extent ? new Outline(scene, (change) => this.#place(change)) : null;
    this.sceneWords.replaceChildren(parts.section('scene-found', 'Scene', h('div', { class: 'found' },
      h('div', {}, h('p', { class: 'sound' }, 'Checked: the whole scene can be simulated.'), project ? this.#projectPart(project) : this.dropped && main.length + unread.length > 1 && this.#mains(main, unread), parts.facts([
        ['Read', main.length === 1 && !unread.length ? main[0] : null], ['Surfaces', count(surfaces)], ['Materials', count(materials)], ['BSDFs', bsdfs ? this.#bsdfs(scene) : '0'], ['Suns, skies', count(sources)], ['Extent', extent],
        ['Refers to', referenced.length ? referenced.slice(0, 12).join(', ') + (referenced.length > 12 ? ` and ${referenced.length - 12} more` : '') : null], ['Id', h('span', { class: 'mono' }, shortId(scene.id))]])),
      this.outline?.node)));
    const height = extent ? Number((bounds.min[2] + 0.85).toFixed(2)) : 0.85;
    const area = this.outline ? await this.outline.begin(height) : [0, 0, 0, 0];
    if (this.scene !== scene) return;
    this.form.replaceChildren(...this.#fields(sources > 0, area, height));
    this.form.hidden = false;
    this.planPlace.replaceChildren();
    this.#settle();
  }

  // Links to the pages of the BSDFs.
  #bsdfs(scene) {
    const place = h('span', {}, count(scene.summary.bsdfs));
    client.get(`/v1/bsdfs?${new URLSearchParams({ scene: scene.id, limit: 12 })}`).then(({ bsdfs, more }) => bsdfs.length && place.replaceChildren(
      ...bsdfs.flatMap((one, i) => [i ? ', ' : '', h('a', { href: `#/bsdfs/${one.id}` }, one.name)]), more ? ' and others' : '')).catch(() => {});
    return place;
  }

  #skyPart(own) {
    const weather = (this.names || []).filter((name) => /\.(epw|wea)$/i.test(name));
    const kinds = SKIES.filter(([kind]) => (kind === 'own') === own);
    return parts.section('sky', 'Sky', h('div', { class: 'fields' },
      h('div', { class: 'field' }, h('label', { for: 'f-sky' }, 'Light from'), h('select', { id: 'f-sky', name: 'sky' }, kinds.map(([kind, words]) => h('option', { value: kind }, words)))),
      when('sky', 'overcast', field('diffuse', 'Outside, lx', 10000, { min: 1 })),
      when('sky', 'weather', h('div', { class: 'field' }, h('label', { for: 'f-weather' }, 'File'), h('input', { id: 'f-weather', name: 'weather', type: 'text', required: true, value: weather[0] || '' }))),
      when('sky', 'clear perez weather', h('div', { class: 'field' }, h('label', { for: 'f-date' }, 'Day'), h('input', { id: 'f-date', name: 'date', type: 'date', required: true, value: `${new Date().getFullYear()}-03-21` })),
        h('div', { class: 'field' }, h('label', { for: 'f-time' }, 'Standard time'), h('input', { id: 'f-time', name: 'time', type: 'time', required: true, value: '12:00' }))),
      when('sky', 'clear perez', field('latitude', 'Latitude, \u00b0', 50), field('longitude', 'Longitude, \u00b0 east', 10), field('zone', 'Time zone, h east', 1)),
      when('sky', 'perez', field('direct_w', 'Direct normal, W/m\u00b2', 600), field('diffuse_w', 'Diffuse horizontal, W/m\u00b2', 150))));
  }

  // Takes the result of dragging in the floor plan.
  #place({ view, area }) {
    const { elements } = this.form;
    if (view) elements.view.value = view;
    if (area && elements.sensors.value === 'grid')
      ['left', 'low', 'right', 'high'].forEach((name, i) => { elements[name].value = Number(area[i].toFixed(2)); });
    this.#settle();
  }

  // area: x and y ranges for the sensors.
  #fields(own, area, height) {
    this.usual = height;
    const { grids = [], views = [] } = this.scene.summary.project || {};
    const [min, max] = [area.slice(0, 2), area.slice(2)];
    const size = Math.max(max[0] - min[0], max[1] - min[1]) || 4;
    const spacing = Number((size / 12).toPrecision(1));
    const edge = (value) => (Number.isFinite(value) ? Number(value.toFixed(2)) : 0);
    const eye = [(min[0] + max[0]) / 2, min[1] + 0.25 * (max[1] - min[1]), height + 0.4].map((value) => Number(value.toFixed(2))).join(' ');
    this.submit = h('button', { type: 'submit', class: 'main' }, 'Submit');
    this.ask = h('button', { type: 'button', onclick: () => this.#plan() }, 'What will it take?');
    return [
      this.#skyPart(own),
      parts.section('sensors-asked', 'Illuminance', h('div', { class: 'fields' },
        h('div', { class: 'field' }, h('label', { for: 'f-sensors' }, 'Sensors'), h('select', { id: 'f-sensors', name: 'sensors' },
          grids.length > 0 && h('option', { value: 'project' }, grids.length === 1 ? `The project\u2019s grid, ${grids[0].name}` : `The project\u2019s ${grids.length} grids`),
          h('option', { value: 'grid' }, 'On a grid over the scene'), h('option', { value: 'rows' }, 'These'), h('option', { value: 'none' }, 'None'))),
        when('sensors', 'grid', field('spacing', 'Spacing', spacing, { min: 0.01 }), field('height', 'At height', height),
          field('left', 'x from', edge(min[0])), field('right', 'x to', edge(max[0])), field('low', 'y from', edge(min[1])), field('high', 'y to', edge(max[1]))),
        when('sensors', 'rows', h('div', { class: 'field wide' }, h('label', { for: 'f-rows' }, 'x y z dx dy dz, one sensor per line'), h('textarea', { id: 'f-rows', name: 'rows', rows: 4, required: true }))))),
      parts.section('view-asked', 'View', h('div', { class: 'fields' }, h('label', { class: 'check' }, h('input', { type: 'checkbox', name: 'with_view', id: 'with-view', checked: true }), 'Render a view'),
        when('with_view', 'on', views.length > 0 ? h('div', { class: 'field' }, h('label', { for: 'f-views' }, 'Views'), h('select', { id: 'f-views', name: 'views' },
          h('option', { value: 'project' }, views.length === 1 ? `The project\u2019s, ${views[0].name}` : `The project\u2019s ${views.length}`), h('option', { value: 'own' }, 'This one')))
          : h('input', { type: 'hidden', name: 'views', value: 'own' }),
        field('width', 'Width', 480, { min: 1, max: 16384, step: 1 }), field('view_height', 'Height', 360, { min: 1, max: 16384, step: 1 })),
        when('views', 'own', h('div', { class: 'field' }, h('label', { for: 'f-view-name' }, 'Name'), h('input', { id: 'f-view-name', name: 'view_name', type: 'text', required: true, value: 'view' })),
          h('div', { class: 'field wide' }, h('label', { for: 'f-view' }, 'Radiance view'), h('input', { id: 'f-view', name: 'view', type: 'text', required: true, value: `-vtv -vp ${eye} -vd 0 1 0 -vh 75 -vv 60` }))))),
      parts.section('goal-asked', 'Accuracy', h('div', { class: 'fields' },
        h('div', { class: 'pair-of' }, radio('goal', 'error', 'An error', true), radio('goal', 'deadline', 'A time', false)),
        when('goal', 'error', field('error', 'Relative error, %', 5, { min: 0.01 })), when('goal', 'deadline', field('deadline', 'Seconds', 60, { min: 0.1 })))),
      parts.section('names', 'Name', h('div', { class: 'fields' },
        h('div', { class: 'field wide' }, h('label', { for: 'f-name' }, 'Job name'), h('input', { id: 'f-name', name: 'name', type: 'text', maxlength: 100 })),
        h('div', { class: 'field wide' }, h('label', { for: 'f-tags' }, 'Tags, separated by commas'), h('input', { id: 'f-tags', name: 'tags', type: 'text' })))),
      h('div', { class: 'controls send' }, this.submit, this.ask, this.counted = h('span', { class: 'quiet' })),
    ];
  }

  // Shows the fields that the current choices need.
  #settle() {
    for (const part of this.form.querySelectorAll('.when')) {
      const chosen = String(new FormData(this.form).get(part.dataset.name)); // a visible field above
      part.hidden = part.disabled = !part.dataset.values.split(' ').includes(chosen);
    }
    const form = new FormData(this.form);
    const asked = documentOf(form, this.scene);
    this.outline?.show({ sensors: asked.sensors, view: asked.views?.[0].view, height: Number(form.get('height')) || this.usual });
    setText(this.counted, form.get('sensors') === 'grid' ? `${count(gridOf(form).length)} sensors` : '');
  }

  get document() {
    return documentOf(new FormData(this.form), this.scene);
  }

  async #plan() {
    if (!this.form.reportValidity()) return;
    this.#say('');
    this.ask.disabled = true;
    try {
      const asked = this.document;
      this.plan?.close();
      this.planPlace.replaceChildren(h('p', { class: 'quiet' }, 'Rendering two small rounds\u2026'));
      const plans = await client.plan(asked);
      this.plan = new PlanPart(plans[0], asked.accuracy);
      this.planPlace.replaceChildren(this.plan.node);
      this.planPlace.scrollIntoView({ block: 'nearest' });
    } catch (error) {
      this.planPlace.replaceChildren();
      this.#say(error);
    }
    this.ask.disabled = false;
  }

  async #submit(event) {
    event.preventDefault();
    this.#say('');
    this.submit.disabled = true;
    try {
      const job = await client.submit(this.document);
      location.hash = `#/jobs/${job.id}`;
    } catch (error) {
      this.#say(error);
      this.submit.disabled = false;
    }
  }
}
