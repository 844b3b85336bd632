// The scene's floor plan, with the sensors and the view that the form asks for.

import { client } from '../api.js';
import { NotFound } from '../oriel.js';
import { fill, h, setText, svg } from '../dom.js';
import { number } from '../format.js';

const DOTS = 4000; // more sensors are drawn as an area
const WAIT_MS = 250;

const three = (view, option) => new RegExp(`${option}\\s+(\\S+)\\s+(\\S+)\\s+(\\S+)`).exec(view)?.slice(1).map(Number);

// Returns {at, to, half} of Radiance view options (half: half the horizontal angle, radians), or null.
function eyeOf(view) {
  const at = three(view, '-vp'), to = three(view, '-vd');
  if (!at || !to || ![...at, ...to].every(Number.isFinite)) return null;
  const across = Number(/-vh\s+(\S+)/.exec(view)?.[1] ?? 45);
  return { at, to, half: (Math.min(360, across) * Math.PI) / 360 };
}

export class Outline {
  tool = 'eye';

  // moved: called with {view} after dragging the eye, with {area: [x0, y0, x1, y1]} after dragging the
  // area of the sensors.
  constructor(scene, moved) {
    this.scene = scene;
    this.moved = moved;
    this.walls = svg('path', { class: 'walls' });
    this.asked = svg('g', {});
    this.drawing = svg('svg', { role: 'img', 'aria-label': 'Floor plan', preserveAspectRatio: 'xMidYMid meet' }, this.walls, this.asked);
    this.caption = h('figcaption', { class: 'quiet' }, 'Computing the section\u2026');
    const tool = (value, words) => h('label', {}, h('input', { type: 'radio', name: 'tool', value, checked: value === this.tool, onchange: () => { this.tool = value; } }), h('span', {}, words));
    this.tools = h('fieldset', { class: 'modes across' }, h('legend', { class: 'unseen' }, 'What dragging in the plan places'), tool('eye', 'Drag the eye'), tool('area', 'Drag the sensors\u2019 area'));
    this.node = h('figure', { class: 'outline' }, this.drawing, h('div', { class: 'under-plan' }, this.caption, this.tools));
    this.drawing.addEventListener('pointerdown', (event) => this.#press(event));
    this.drawing.addEventListener('pointermove', (event) => this.start && this.#turn(event));
    for (const end of ['pointerup', 'pointercancel']) this.drawing.addEventListener(end, () => { this.start = null; });
    const { min, max } = scene.summary.bounds;
    this.#frame([...min.slice(0, 2), ...max.slice(0, 2)]);
  }

  // First section. The plan shows the area of its lines, without the ground around them.
  async begin(height) {
    const { min, max } = this.scene.summary.bounds;
    const lines = (await this.#cut(height)) || [];
    if (lines.length === 0) return [...min.slice(0, 2), ...max.slice(0, 2)];
    const area = [Infinity, Infinity, -Infinity, -Infinity];
    for (const [x, y, u, v] of lines) {
      area[0] = Math.min(area[0], x, u);
      area[1] = Math.min(area[1], y, v);
      area[2] = Math.max(area[2], x, u);
      area[3] = Math.max(area[3], y, v);
    }
    this.#frame(area);
    return area;
  }

  #frame([left, low, right, high]) {
    const min = [left, low], max = [right, high];
    const size = Math.max(max[0] - min[0], max[1] - min[1]) || 1;
    this.unit = size / 100;
    const edge = 4 * this.unit;
    this.drawing.setAttribute('viewBox', [min[0] - edge, -max[1] - edge, max[0] - min[0] + 2 * edge, max[1] - min[1] + 2 * edge].join(' '));
  }

  // form: {sensors: rows or null, height, view}. A new height is cut after it has not changed for a while.
  show({ sensors, height, view }) {
    this.view = view;
    fill(this.asked, [sensors, view], () => [this.#sensors(sensors || []), this.#eye(view)]);
    if (height === this.height) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.#cut(height), WAIT_MS);
  }

  async #cut(height) {
    this.height = height;
    try {
      const { lines, more } = await client.get(`/v1/scenes/${this.scene.id}/outline?height=${height}`, { cache: 'default' });
      if (height !== this.height) return null;
      this.walls.setAttribute('d', lines.map(([x, y, u, v]) => `M${x} ${-y}L${u} ${-v}`).join(''));
      setText(this.caption, `${lines.length === 0 ? 'Empty section' : 'Section'} at height ${number(height)}${more ? ', only the longest lines' : ''}.`);
      return lines;
    } catch (error) {
      setText(this.caption, error instanceof NotFound ? '' : 'The floor plan could not be drawn.');
      this.drawing.classList.toggle('none', true);
      this.tools.hidden = true;
      return null;
    }
  }

  #sensors(rows) {
    if (rows.length === 0) return [];
    if (rows.length <= DOTS) return rows.filter((row) => row.slice(0, 2).every(Number.isFinite)).map(([x, y]) => svg('circle', { class: 'sensor', cx: x, cy: -y, r: 0.6 * this.unit }));
    const [xs, ys] = [0, 1].map((axis) => rows.map((row) => row[axis]));
    const low = [xs, ys].map((all) => all.reduce((a, b) => Math.min(a, b))), high = [xs, ys].map((all) => all.reduce((a, b) => Math.max(a, b)));
    return svg('rect', { class: 'sensor', x: low[0], y: -high[1], width: high[0] - low[0], height: high[1] - low[1] });
  }

  #eye(view) {
    const eye = view && eyeOf(view);
    if (!eye) return [];
    const [x, y] = [eye.at[0], -eye.at[1]], ahead = Math.atan2(-eye.to[1], eye.to[0]), far = 12 * this.unit;
    const level = Math.hypot(eye.to[0], eye.to[1]) > 1e-6;
    const tip = (angle) => `${x + far * Math.cos(angle)} ${y + far * Math.sin(angle)}`;
    const wide = eye.half >= Math.PI - 1e-6;
    const cone = !level ? [] : svg('path', { class: 'cone', d: wide ? `M${x - far} ${y}a${far} ${far} 0 1 0 ${2 * far} 0a${far} ${far} 0 1 0 ${-2 * far} 0` : `M${x} ${y}L${tip(ahead - eye.half)}A${far} ${far} 0 ${eye.half > Math.PI / 2 ? 1 : 0} 1 ${tip(ahead + eye.half)}Z` });
    return [cone, svg('circle', { class: 'eye', cx: x, cy: y, r: 1.2 * this.unit })].flat();
  }

  // ---- Dragging --------------------------------------------------------------------------------

  #place(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.drawing.getScreenCTM().inverse());
    return [point.x, -point.y].map((value) => Number(value.toFixed(3)));
  }

  #press(event) {
    if (event.button !== 0 || (this.tool === 'eye' && !(this.view && eyeOf(this.view)))) return;
    this.drawing.setPointerCapture(event.pointerId);
    this.start = this.#place(event);
    if (this.tool === 'eye') this.moved({ view: this.view.replace(/-vp\s+\S+\s+\S+/, `-vp ${this.start.join(' ')}`) });
  }

  #turn(event) {
    const here = this.#place(event), to = here.map((value, i) => value - this.start[i]), far = Math.hypot(...to);
    if (far < 2 * this.unit) return;
    if (this.tool === 'area') this.moved({ area: [...here.map((value, i) => Math.min(value, this.start[i])), ...here.map((value, i) => Math.max(value, this.start[i]))] });
    else this.moved({ view: this.view.replace(/-vd\s+\S+\s+\S+/, `-vd ${to.map((value) => Number((value / far).toFixed(3))).join(' ')}`) });
  }
}
