// A hemisphere as a polar map: the normal in the middle, x to the right, y (up) upwards.

import { h } from '../dom.js';
import { colorOf, shareOf } from '../viewer/palette.js';

const ROWS = 36, TURN = 72;

// Returns the fraction of the light that leaves through a cell.
export function lightOf(values, row, column) {
  const [low, high] = [row, row + 1].map((i) => Math.sin((i * Math.PI) / 2 / ROWS) ** 2);
  return (values[row][column] * (high - low) * Math.PI) / TURN;
}

export class PolarMap {
  // read: called with {theta, phi, value, light} of the cell under the pointer, or null.
  constructor(label, read) {
    this.label = label;
    this.canvas = h('canvas', { role: 'img', 'aria-label': label, onpointermove: (event) => this.#point(event), onpointerleave: () => read(null) });
    this.node = h('div', { class: 'polar' }, this.canvas);
    this.read = read;
    this.observer = new ResizeObserver(() => this.#draw());
    this.observer.observe(this.node);
  }

  close() {
    this.observer.disconnect();
  }

  // mark: {theta, phi} of a marked direction.
  show(values, top, decades, mark, words) {
    Object.assign(this, { values, top, decades, mark });
    this.canvas.setAttribute('aria-label', `${this.label}: ${words}`);
    this.#draw();
  }

  // Converts polar coordinates to canvas coordinates and back.
  #at(theta, phi) {
    const { half, radius } = this, angle = (phi * Math.PI) / 180;
    return [half + (radius * theta * Math.cos(angle)) / 90, half - (radius * theta * Math.sin(angle)) / 90];
  }

  #cell(x, y) {
    const theta = Math.hypot(x - this.half, this.half - y) / this.radius;
    if (theta >= 1) return null;
    const turn = Math.atan2(this.half - y, x - this.half) / (2 * Math.PI);
    return [Math.floor(theta * ROWS), Math.floor((turn < 0 ? turn + 1 : turn) * TURN) % TURN];
  }

  #draw() {
    if (!this.values || !this.node.clientWidth) return;
    const ratio = devicePixelRatio || 1, size = Math.round(this.node.clientWidth * ratio);
    this.half = size / 2;
    this.radius = size / 2 - 22 * ratio;
    this.canvas.width = this.canvas.height = size;
    const context = this.canvas.getContext('2d'), image = context.createImageData(size, size);
    const colors = this.values.map((row) => row.map((value) => colorOf(shareOf(value, this.top, this.decades))));
    for (let y = 0, i = 0; y < size; y++)
      for (let x = 0; x < size; x++, i += 4) {
        const cell = this.#cell(x + 0.5, y + 0.5);
        if (cell) image.data.set([...colors[cell[0]][cell[1]], 255], i);
      }
    context.putImageData(image, 0, 0);
    this.#drawNet(context, ratio);
  }

  #drawNet(context, ratio) {
    const style = getComputedStyle(document.documentElement), { half, radius } = this;
    context.strokeStyle = 'rgb(255 255 255 / 45%)';
    context.lineWidth = ratio;
    for (const theta of [30, 60]) {
      context.beginPath();
      context.arc(half, half, (radius * theta) / 90, 0, 2 * Math.PI);
      context.stroke();
    }
    context.beginPath();
    for (const [from, to] of [[[half - radius, half], [half + radius, half]], [[half, half - radius], [half, half + radius]]]) {
      context.moveTo(...from);
      context.lineTo(...to);
    }
    context.stroke();
    context.strokeStyle = style.getPropertyValue('--line');
    context.beginPath();
    context.arc(half, half, radius, 0, 2 * Math.PI);
    context.stroke();
    context.fillStyle = style.getPropertyValue('--quiet');
    context.font = `${12 * ratio}px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    for (const [words, x, y] of [['up', 0, -1], ['down', 0, 1]]) context.fillText(words, half + x * radius, half + y * (radius + 12 * ratio));
    if (this.mark) this.#drawMark(context, ratio);
  }

  #drawMark(context, ratio) {
    const [x, y] = this.#at(this.mark.theta, this.mark.phi), size = 7 * ratio;
    for (const [color, width] of [['#000', 4], ['#fff', 2]]) {
      context.strokeStyle = color;
      context.lineWidth = width * ratio;
      context.beginPath();
      context.arc(x, y, size, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  #point(event) {
    if (!this.values) return;
    const box = this.canvas.getBoundingClientRect(), scale = this.canvas.width / box.width;
    const cell = this.#cell((event.clientX - box.left) * scale, (event.clientY - box.top) * scale);
    if (!cell) {
      this.read(null);
      return;
    }
    const [row, column] = cell;
    this.read({ theta: [row * 2.5, row * 2.5 + 2.5], phi: [column * 5, column * 5 + 5], value: this.values[row][column], light: lightOf(this.values, row, column) });
  }
}
