// Position and zoom of a picture on its canvas: fitted, dragged, zoomed by wheel, pinch or key.

const STEP = 1.25, MOST = 48;

export class Surface extends EventTarget {
  scale = 1;
  offset = [0, 0];
  size = [1, 1];
  #pointers = new Map();
  #fitted = true;
  region = false; // dragging marks a region instead of moving

  constructor(canvas) {
    super();
    this.canvas = canvas;
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.#pointers.delete(event.pointerId));
    this.observer = new ResizeObserver(() => this.#resize());
    this.observer.observe(canvas.parentElement);
  }

  close() {
    this.observer.disconnect();
  }

  get ratio() {
    return devicePixelRatio || 1;
  }

  #resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.canvas.width = Math.max(1, Math.round(clientWidth * this.ratio));
    this.canvas.height = Math.max(1, Math.round(clientHeight * this.ratio));
    if (this.#fitted) this.fit();
    else this.#changed();
  }

  setSize(size) {
    const same = size[0] === this.size[0] && size[1] === this.size[1];
    this.size = size;
    if (!same) this.fit();
  }

  fit() {
    const { width, height } = this.canvas;
    this.#fitted = true;
    this.scale = Math.min(width / this.size[0], height / this.size[1]);
    this.offset = [(width - this.scale * this.size[0]) / 2, (height - this.scale * this.size[1]) / 2];
    this.#changed();
  }

  // Zooms by a factor around a point of the canvas; by default the middle.
  zoom(factor, about = [this.canvas.width / 2, this.canvas.height / 2]) {
    const scale = Math.min(MOST * this.ratio, Math.max(0.05, this.scale * factor));
    this.offset = this.offset.map((value, i) => about[i] - ((about[i] - value) * scale) / this.scale);
    this.scale = scale;
    this.#fitted = false;
    this.#changed();
  }

  zoomTo(scale) {
    this.zoom((scale * this.ratio) / this.scale);
  }

  // Moves the picture so that a pixel is visible.
  show([x, y]) {
    const at = [x + 0.5, y + 0.5].map((value, i) => value * this.scale + this.offset[i]);
    const extent = [this.canvas.width, this.canvas.height];
    at.forEach((value, i) => { if (value < 0 || value > extent[i]) this.offset[i] += extent[i] / 2 - value; });
    this.#changed();
  }

  #changed() {
    this.dispatchEvent(new Event('change'));
  }

  #placeOf(event) {
    const box = this.canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * this.ratio, (event.clientY - box.top) * this.ratio];
  }

  // Returns the picture pixel at that point, or null.
  pixelAt(place) {
    const pixel = place.map((value, i) => Math.floor((value - this.offset[i]) / this.scale));
    return pixel.every((value, i) => value >= 0 && value < this.size[i]) ? pixel : null;
  }

  // Converts picture coordinates to CSS pixels.
  placeOn([x, y]) {
    return [(x * this.scale + this.offset[0]) / this.ratio, (y * this.scale + this.offset[1]) / this.ratio];
  }

  #wheel(event) {
    event.preventDefault();
    this.zoom(event.deltaY < 0 ? STEP : 1 / STEP, this.#placeOf(event));
  }

  #down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, this.#placeOf(event));
    this.start = this.pixelAt(this.#placeOf(event));
  }

  #move(event) {
    const place = this.#placeOf(event), before = this.#pointers.get(event.pointerId);
    const pixel = this.pixelAt(place);
    this.dispatchEvent(Object.assign(new Event('point'), { pixel }));
    if (!before) return;
    this.#pointers.set(event.pointerId, place);
    if (this.region) {
      if (this.start && pixel) this.dispatchEvent(Object.assign(new Event('region'), { from: this.start, to: pixel }));
      return;
    }
    this.#fitted = false;
    if (this.#pointers.size === 2) this.#pinch(event.pointerId, before, place);
    else {
      this.offset = this.offset.map((value, i) => value + place[i] - before[i]);
      this.#changed();
    }
  }

  #pinch(id, before, place) {
    const other = [...this.#pointers].find(([one]) => one !== id)[1];
    const far = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
    if (far(before) > 0) this.zoom(far(place) / far(before), other);
  }
}
