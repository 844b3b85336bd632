// The scale of false colours, with its numbers.

import { h } from '../dom.js';
import { number } from '../format.js';
import { colorOf, levels, shareOf } from './palette.js';

export function legend(top, decades, unit) {
  const strip = h('canvas', { width: 1, height: 256, class: 'strip', 'aria-hidden': 'true' });
  const context = strip.getContext('2d');
  for (let y = 0; y < 256; y++) {
    context.fillStyle = `rgb(${colorOf(1 - y / 255).join(' ')})`;
    context.fillRect(0, y, 1, 1);
  }
  const marks = levels(top, decades).map((value) => {
    const mark = h('span', {}, number(value, 3));
    mark.style.insetBlockEnd = `${100 * Math.min(1, Math.max(0, shareOf(value, top, decades)))}%`;
    return mark;
  });
  return h('div', { class: 'legend', role: 'img', 'aria-label': `Scale from ${decades > 0 ? number(top / 10 ** decades) : 0} to ${number(top)} ${unit}` },
    h('span', { class: 'unit' }, unit), h('div', { class: 'scale' }, strip, h('div', { class: 'marks' }, marks)));
}
