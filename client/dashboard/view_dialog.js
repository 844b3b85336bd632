// Dialog for another viewpoint of a job: Radiance view options, initially those of its first view.

import { h } from './dom.js';

// Resolves to {name, view}, or null if it was cancelled.
export function askForView(first) {
  return new Promise((resolve) => {
    const name = h('input', { id: 'another-name', type: 'text', required: true, pattern: '[A-Za-z0-9_\\-][A-Za-z0-9._\\-]*', value: `${first.name}-2` });
    const view = h('textarea', { id: 'another-view', rows: 3, required: true });
    view.value = first.view || '-vtv -vp 0 0 1.5 -vd 0 1 0';
    const dialog = h('dialog', { 'aria-labelledby': 'another' }, h('form', { method: 'dialog' },
      h('h2', { id: 'another' }, 'The same scene from another viewpoint'),
      h('label', { for: 'another-name' }, 'Name'), name, h('label', { for: 'another-view' }, 'Radiance view'), view,
      h('div', { class: 'controls send' }, h('button', { class: 'main', value: 'go' }, 'Submit'), h('button', { value: '', formnovalidate: true }, 'Close'))));
    dialog.addEventListener('close', () => {
      dialog.remove();
      resolve(dialog.returnValue === 'go' ? { name: name.value, view: view.value.trim().replace(/\s+/g, ' ') } : null);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
