// Draws HDR pictures with WebGL 2: with an exposure, in false colours, as errors, or tone mapped for the
// human eye; two pictures side by side with a wipe; at any zoom.

import { EFFICACY, LUMA } from './hdr.js';
import { texels } from './palette.js';

const VERTEX = `#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D first, second, eye, palette;
uniform vec2 size, otherSize, offset, canvas;
uniform float scale, exposure, top, decades, bands, wipe, cover;
uniform int mode;
out vec4 shown;
const vec3 weights = vec3(${LUMA.join(', ')});

// A pixel, or the mean of the pixels under one canvas pixel.
vec4 look(sampler2D from, vec2 at, vec2 extent, vec2 step) {
  ivec2 most = ivec2(extent) - 1;
  ivec2 count = clamp(ivec2(ceil(step - 0.01)), 1, 8);
  vec4 sum = vec4(0.0);
  for (int y = 0; y < count.y; y++)
    for (int x = 0; x < count.x; x++) {
      vec2 part = (vec2(x, y) + 0.5) / vec2(count) - 0.5;
      sum += texelFetch(from, clamp(ivec2(floor(at + part * step)), ivec2(0), most), 0);
    }
  return sum / float(count.x * count.y);
}
vec4 pixel(vec2 at, bool other) {
  vec2 step = vec2(max(1.0 / scale, 1.0));
  if (!other) return look(first, at, size, scale < 1.0 ? step : vec2(1.0));
  vec2 ratio = otherSize / size;
  return look(second, at * ratio, otherSize, scale < 1.0 ? step * ratio : ratio);
}
float light(vec4 found) { return dot(found.rgb, weights); }
// The quantity for false colours: luminance, or its relative error.
float value(vec4 found) {
  return mode == 2 ? (light(found) > 0.0 ? found.a / light(found) : 0.0) : light(found) * ${EFFICACY}.0;
}
float share(float value) {
  if (decades <= 0.0) return value / top;
  return value > top * pow(10.0, -decades) ? 1.0 + log(value / top) / log(10.0) / decades : 0.0;
}
vec3 display(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
vec3 shade(float part) { return texelFetch(palette, ivec2(clamp(part, 0.0, 1.0) * 255.0 + 0.5, 0), 0).rgb; }
// Isolines of means over nine pixels: single pixels are too noisy.
float band(vec2 at, bool other) {
  float sum = 0.0;
  for (int i = 0; i < 9; i++) sum += value(pixel(clamp(at + vec2(i % 3 - 1, i / 3 - 1), vec2(0.0), size - 1.0), other));
  return floor(clamp(share(sum / 9.0), 0.0, 1.0) * bands + 1e-4);
}
void main() {
  vec2 at = (vec2(gl_FragCoord.x, canvas.y - gl_FragCoord.y) - offset) / scale;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size))) discard;
  bool other = at.x >= wipe;
  vec4 found = pixel(at, other);
  vec3 color;
  if (mode == 0) color = display(found.rgb * exposure);
  else if (mode == 3 && !other) color = look(eye, at, size, vec2(max(1.0 / scale, 1.0))).rgb;
  else if (mode == 3) color = display(found.rgb * exposure);
  else color = shade(share(value(found)));
  if (mode == 2) color = mix(display(vec3(light(found) * exposure)), color, cover);
  if (bands > 0.0) {
    float hair = 1.0 / scale, here = band(at, other), right = band(at + vec2(hair, 0.0), other), below = band(at + vec2(0.0, hair), other);
    if (here != right || here != below) color = mode == 1 ? vec3(1.0) : shade(max(here, max(right, below)) / bands);
  }
  shown = vec4(color, 1.0);
}`;

function compile(gl, kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

export class Painter {
  #uniforms = {};
  #textures = {};

  constructor(canvas) {
    const gl = canvas.getContext('webgl2', { alpha: true, antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error('The viewer needs WebGL 2, which this browser does not support.');
    this.gl = gl;
    const program = gl.createProgram();
    gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    const names = ['first', 'second', 'eye', 'palette'];
    for (const name of [...names, 'size', 'otherSize', 'offset', 'canvas', 'scale', 'exposure', 'top', 'decades', 'bands', 'wipe', 'cover', 'mode'])
      this.#uniforms[name] = gl.getUniformLocation(program, name);
    names.forEach((name, unit) => {
      this.#textures[name] = gl.createTexture();
      gl.uniform1i(this.#uniforms[name], unit);
      this.#fill(name, gl.RGBA8, 1, 1, gl.UNSIGNED_BYTE, new Uint8Array(4));
    });
    this.#fill('palette', gl.RGBA8, 256, 1, gl.UNSIGNED_BYTE, texels());
  }

  #fill(name, format, width, height, type, data) {
    const { gl } = this;
    const names = Object.keys(this.#textures);
    gl.activeTexture(gl.TEXTURE0 + names.indexOf(name));
    gl.bindTexture(gl.TEXTURE_2D, this.#textures[name]);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    if (data instanceof ImageBitmap) gl.texImage2D(gl.TEXTURE_2D, 0, format, gl.RGBA, type, data);
    else gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, gl.RGBA, type, data);
  }

  // name: 'first' or 'second'; picture: decoded.
  take(name, { width, height, pixels }) {
    const { gl } = this;
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (width > most || height > most) throw new Error(`This browser shows pictures up to ${most} pixels wide and high.`);
    this.#fill(name, gl.RGBA32F, width, height, gl.FLOAT, pixels);
  }

  takeEye(bitmap) {
    this.#fill('eye', this.gl.RGBA8, 0, 0, this.gl.UNSIGNED_BYTE, bitmap);
  }

  // All in picture pixels, except scale and offset, which are in canvas pixels.
  draw({ size, otherSize, scale, offset, mode, exposure, top, decades, bands, wipe, cover }) {
    const { gl } = this, at = this.#uniforms;
    const { width, height } = gl.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform2f(at.size, ...size);
    gl.uniform2f(at.otherSize, ...otherSize);
    gl.uniform2f(at.offset, ...offset);
    gl.uniform2f(at.canvas, width, height);
    for (const [name, value] of Object.entries({ scale, exposure, top, decades, bands, wipe, cover })) gl.uniform1f(at[name], value);
    gl.uniform1i(at.mode, mode);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
