// Result pictures: views by name, and other images of the job.

import { filePath } from './api.js';
import { fill, h } from './dom.js';

const FORMS = [[/\.false\.png$/, 'False colours'], [/\.lines\.png$/, 'Isolines'], [/\.bands\.png$/, 'Bands'], [/\.error\.png$/, 'Standard error']];
const ASIDE = /^(sensors\.map.*|study|sequence\..*)\.png$/;

// Returns [{view, forms: [{name, words}]}, ...] and the pictures that belong to no view.
// drawn: all of them are charts, not views.
export function sort(names, drawn) {
  const views = new Map(), others = [];
  for (const name of names.filter((one) => one.endsWith('.png') && !one.endsWith('16.png'))) {
    if (drawn || ASIDE.test(name)) {
      others.push(name);
      continue;
    }
    const [ending, words] = FORMS.find(([pattern]) => pattern.test(name)) || [/\.png$/, 'Picture'];
    const view = name.replace(ending, '');
    views.set(view, (views.get(view) || []).concat({ name, words }));
  }
  for (const forms of views.values()) forms.sort((a, b) => (a.words === 'Picture' ? -1 : b.words === 'Picture' ? 1 : 0));
  return { views: [...views].map(([view, forms]) => ({ view, forms })), others };
}

class View {
  constructor(job, { view, forms }) {
    this.job = job;
    this.view = view;
    this.chosen = forms[0].name;
    this.image = h('img', { loading: 'lazy' });
    this.tabs = h('div', { class: 'tabs', role: 'group', 'aria-label': `What is shown of ${view}` });
    this.link = h('a', { class: 'frame', href: '#' }, this.image);
    this.node = h('figure', { class: 'view' }, this.link, h('figcaption', {}, h('strong', {}, view), this.tabs));
  }

  show(forms, hdr, version) {
    Object.assign(this, { forms, hdr, version });
    const chosen = forms.find((form) => form.name === this.chosen) || forms[0];
    const address = filePath(this.job, chosen.name);
    const source = version ? `${address}?as-of=${version}` : address;
    if (this.image.getAttribute('src') !== source) this.image.src = source;
    this.image.alt = `${chosen.words} of the view ${this.view}`;
    this.link.href = hdr ? `#/view/${this.job}/${encodeURIComponent(hdr)}` : address;
    fill(this.tabs, [forms, chosen.name], () => forms.length > 1 && forms.map((form) => h('button', {
      type: 'button', class: 'tab', 'aria-pressed': String(form === chosen), onclick: () => { this.chosen = form.name; this.show(this.forms, this.hdr, this.version); },
    }, form.words)));
  }
}

// version: changes with the pictures of a running job; '' when they are final.
export class Pictures {
  #views = new Map();

  constructor(job) {
    this.job = job;
    this.drawn = false;
    this.views = h('div', { class: 'views' });
    this.others = h('div', { class: 'views' });
    this.node = h('section', { 'aria-labelledby': 'pictures', hidden: true }, h('h2', { id: 'pictures' }, 'Pictures'), this.views, this.others);
  }

  show(names, version) {
    const { views, others } = sort(names, this.drawn);
    this.node.hidden = views.length + others.length === 0;
    for (const one of views) {
      let view = this.#views.get(one.view);
      if (!view) {
        view = new View(this.job, one);
        this.#views.set(one.view, view);
        this.views.append(view.node);
      }
      const hdr = `${one.view}.hdr`;
      view.show(one.forms, names.includes(hdr) ? hdr : null, version);
    }
    fill(this.others, [others, version], () => others.map((name) => {
      const address = filePath(this.job, name);
      return h('figure', { class: 'view' }, h('a', { class: 'frame aside', href: address, target: '_blank', rel: 'noopener' }, h('img', { loading: 'lazy', src: version ? `${address}?as-of=${version}` : address, alt: name.replace('.png', '') })),
        h('figcaption', {}, h('strong', {}, name.replace('.png', ''))));
    }));
  }
}
