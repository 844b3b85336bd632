// Photon maps, loaded BSDFs, scenes and BSDF files that the daemon stores, the time that they saved, and their use.

import { client, explain } from './api.js';
import { fill, h } from './dom.js';
import { NONE, bytes, count, duration, fullMoment, moment, shortId } from './format.js';
import { facts, section } from './job_parts.js';
import { MAPS } from './words.js';

const when = (text) => h('span', { title: fullMoment(text) }, moment(text));
const short = (id) => h('span', { class: 'mono' }, shortId(id));

// heads: [label, is a number]; rows: {cells, what, path, held: why it cannot be removed}
function table(caption, heads, rows, remove) {
  return h('div', { class: 'scroll', role: 'region', tabindex: 0, 'aria-label': caption }, h('table', { class: 'kept' },
    h('thead', {}, h('tr', {}, heads.map(([label, numeric]) => h('th', { scope: 'col', class: numeric ? 'n' : '' }, label)), remove && h('th', { scope: 'col' }, h('span', { class: 'unseen' }, 'Removal')))),
    h('tbody', {}, rows.map(({ cells, what, path, held }) => h('tr', {}, cells.map((cell, i) => h('td', { class: heads[i][1] ? 'n' : '' }, cell)),
      remove && h('td', { class: 'n' }, held ? h('span', { class: 'quiet' }, held) : h('button', { type: 'button', class: 'plain', 'aria-label': `Remove ${what}`, onclick: () => remove(what, path) }, 'Remove')))))));
}

const MOST = 1000; // items of a list

export class CachePage {
  title = 'Cache';

  constructor(app) {
    this.app = app;
    this.notice = h('div', { role: 'alert' });
    this.word = h('p', { class: 'quiet' }, 'Loading');
    this.places = ['totals', 'maps', 'scenes', 'bsdfs'].map((name) => (this[name] = h('div', {})));
    this.node = h('div', { class: 'page' }, h('h1', { tabindex: -1 }, 'Cache'), this.word, this.notice, h('div', { class: 'job-main stacked' }, this.places));
    this.#load();
  }

  close() {}

  async #load() {
    try {
      const [maps, scenes, bsdfs, limits] = await Promise.all([client.maps(), client.scenes(MOST), client.bsdfs(MOST), client.limits()]);
      this.#show(maps, scenes, bsdfs.filter((one) => one.by_itself), limits);
    } catch (error) {
      this.word.hidden = true;
      this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
    }
  }

  #show(maps, scenes, bsdfs, limits) {
    this.word.hidden = true;
    const remove = this.app.session.may('admin') ? (what, path) => this.#remove(what, path) : null;
    const sum = (list, key) => list.reduce((total, one) => total + one[key], 0);
    fill(this.totals, [maps, limits.storage_bytes], () => facts([
      ['Maps', bytes(sum(maps, 'bytes'))], ['Time saved', duration(sum(maps, 'seconds_saved'))], ['Hits', count(sum(maps, 'hits'))],
      ['Scenes', bytes(sum(scenes, 'bytes'))], ['Storage limit', bytes(limits.storage_bytes)]]));
    fill(this.maps, maps, () => section('kept-maps', 'Maps', maps.length === 0 ? h('p', { class: 'quiet' }, 'None yet. Jobs with photon maps store them here, and later jobs reuse them.')
      : table('Maps', [['Kind'], ['Key'], ['Stored', true], ['Size', true], ['Hits', true], ['Time saved', true], ['Last used', true]], maps.map((map) => ({
        what: `${MAPS[map.kind]} ${shortId(map.key)}`, path: `/v1/maps/${map.kind}/${map.key}`, held: map.in_use ? 'in use' : '',
        cells: [MAPS[map.kind], short(map.key), count(map.stored), bytes(map.bytes), count(map.hits), map.hits ? duration(map.seconds_saved) : NONE, when(map.last_used)] })), remove)));
    fill(this.scenes, scenes, () => section('kept-scenes', 'Scenes', scenes.length === 0 ? h('p', { class: 'quiet' }, 'None yet.')
      : table('Scenes', [['Scene'], ['Uploaded', true], ['Size', true], ['Jobs', true], ['Last used', true]], scenes.map((scene) => ({
        what: `scene ${shortId(scene.id)}`, path: `/v1/scenes/${scene.id}`, held: scene.jobs_under_way ? 'in use' : '',
        cells: [h('a', { class: 'mono', href: `#/new?scene=${scene.id}` }, shortId(scene.id)), when(scene.created_at), bytes(scene.bytes), h('a', { href: `#/jobs?scene=${scene.id}` }, count(scene.jobs)), when(scene.last_used)] })), remove)));
    fill(this.bsdfs, bsdfs, () => (bsdfs.length === 0 ? [] : section('kept-bsdfs', 'BSDFs uploaded alone',
      table('BSDFs', [['Name'], ['Id'], ['Uploaded', true], ['Size', true], ['Scenes', true], ['Last used', true]], bsdfs.map((one) => ({
        what: one.name, path: `/v1/bsdfs/${one.id}`, held: one.scene_count ? 'in use' : '',
        cells: [h('a', { href: `#/bsdfs/${one.id}` }, one.name), short(one.id), when(one.created_at), bytes(one.bytes), count(one.scene_count), when(one.last_used)] })), remove))));
  }

  async #remove(what, path) {
    if (!confirm(`Remove ${what}? Jobs that need it must build or upload it again.`)) return;
    this.notice.replaceChildren();
    try {
      await client.request('DELETE', path);
    } catch (error) {
      this.notice.replaceChildren(h('p', { class: 'notice' }, explain(error)));
    }
    this.#load();
  }
}
