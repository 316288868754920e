// The triangulation drawn by WebGL 2. Coordinates are in a texture with a texel for each id; a vertex is the id of a corner, as the
// binary reply to TRIANGLES has it. So a point that moves is one texel, and a triangle that changes is twelve bytes.
//
// Changes since the last frame are drawn again in their part of the picture, from the tiles of triangles that meet them.

import { emptyBox, meets, widen } from '../data/box.js';
import { Tiles } from './tiles.js';

const ROW = 4096; // texels in a row of the texture of points

const HEAD = `#version 300 es
precision highp float; precision highp int; precision highp sampler2D;`;

/** The place of a corner, and its value. */
const PLACE = `
in uint id;
uniform sampler2D points, values;
uniform vec4 centre;   // of the view: x, y, and what single precision leaves of them
uniform vec2 scale;    // from units to clip space
vec4 place(ivec2 at) {
  vec4 p = texelFetch(points, at, 0);
  return vec4(((p.xy - centre.xy) + (p.zw - centre.zw)) * scale, 0.0, 1.0);
}
ivec2 texel() { return ivec2(int(id) % ${ROW}, int(id) / ${ROW}); }`;

/** The colour of the ground, mixed with the share `line` of a line on it. */
const PAINT = `
uniform vec2 range;      // the least value, and 1 / (greatest - least)
uniform vec4 fill, edge;
uniform bool coloured, edged;
uniform float bands;     // the step between bands of one colour; 0: colours change steadily
// The colour map viridis of matplotlib, as a polynomial that M. Zucker fitted to it (public domain).
const vec3 term[7] = vec3[7](vec3(0.2777, 0.0054, 0.3341), vec3(0.1051, 1.4046, 1.3846), vec3(-0.3309, 0.2148, 0.0951),
  vec3(-4.6342, -5.7991, -19.3324), vec3(6.2283, 14.1799, 56.6906), vec3(4.7764, -13.7451, -65.3530), vec3(-5.4355, 4.6459, 26.3125));
vec3 viridis(float t) {
  vec3 sum = term[6];
  for (int i = 5; i >= 0; i--) sum = term[i] + t * sum;
  return clamp(sum, 0.0, 1.0);
}
/** light: how bright the slope of the ground is, beside level ground. */
vec4 paint(float value, float line, float light) {
  line *= edged ? edge.a : 0.0;
  float level = bands > 0.0 ? (floor(value / bands) + 0.5) * bands : value;
  vec4 ground = coloured && value == value ? vec4(viridis(clamp((level - range.x) * range.y, 0.0, 1.0)) * light, 1.0) : fill;
  return vec4(edge.rgb * line + ground.rgb * ground.a * (1.0 - line), line + ground.a * (1.0 - line));
}`;

const MESH_VERTEX = `${HEAD}${PLACE}
out vec3 corner;
out float value;
void main() {
  gl_Position = place(texel());
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  value = texelFetch(values, texel(), 0).r;
}`;

const MESH_FRAGMENT = `${HEAD}${PAINT}
in vec3 corner;
in float value;
uniform float relief;    // pixels that the ground rises for a unit of the value; 0: no hillshade
out vec4 colour;
void main() {
  // Light from the north-west, 45 degrees above the ground [Horn 1981].
  vec3 normal = normalize(vec3(-relief * dFdx(value), -relief * dFdy(value), 1.0));
  float light = relief > 0.0 ? clamp(dot(normal, vec3(-0.5, 0.5, 0.7071)) * 1.4142, 0.25, 1.35) : 1.0;
  vec3 width = fwidth(corner);
  vec3 near = smoothstep(vec3(0.0), 1.2 * width, corner);
  float line = 1.0 - min(near.x, min(near.y, near.z));
  // Lines fade where triangles become lower than 16 pixels: triangles of a few pixels would be nothing but lines.
  colour = paint(value, line * (1.0 - 0.78 * smoothstep(0.06, 0.4, max(width.x, max(width.y, width.z)))), light);
}`;

/** Dots stand for the small triangles of a sample. */
const DOT_VERTEX = `${HEAD}${PLACE}${PAINT}
uniform float size;
flat out vec4 dot_colour;
void main() {
  gl_PointSize = size;
  gl_Position = place(texel());
  dot_colour = paint(texelFetch(values, texel(), 0).r, 0.22, 1.0);
}`;

const DOT_FRAGMENT = `${HEAD}
flat in vec4 dot_colour;
out vec4 colour;
void main() { colour = dot_colour; }`;

/** Begins to compile a program; use() waits for it. */
function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, 'id');
  gl.linkProgram(program);
  return program;
}

/** Uses a program. Returns a function that returns the place of a uniform; null: the program does not have it. */
function use(gl, program) {
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error([gl.getProgramInfoLog(program), ...gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader))].join('\n'));
  }
  gl.useProgram(program);
  return (name) => gl.getUniformLocation(program, name);
}

export class Scene {
  /** Bytes that events have sent to the graphics memory, and pictures drawn whole and in part. */
  counts = { bytes: 0, whole: 0, part: 0 };
  style = { coloured: false, edged: true, fill: [0.2, 0.4, 0.6, 0.1], edge: [0.2, 0.4, 0.6, 0.9], range: [0, 1], relief: 0, bands: 0 };
  #gl;
  #mesh = null;
  #tiles = null;
  #dots = null;
  #rows = 0; // of the texture of points
  #room = 0; // slots in the buffer of corners
  #view = null; // that the picture shows; null: there is no picture
  #changed = emptyBox(); // of the plane: what events have changed since the last frame

  /** onStale() is called when the picture should be drawn again. */
  constructor(canvas, onStale) {
    this.#gl = canvas.getContext('webgl2', { alpha: true, antialias: false, preserveDrawingBuffer: true });
    if (this.#gl === null) throw new Error('this browser has no WebGL 2');
    this.onStale = onStale;
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault()); // so that there will be another one
    canvas.addEventListener('webglcontextrestored', () => {
      this.#begin();
      if (this.#mesh !== null) this.#sendAll();
      this.stale();
    });
    if (!this.isLost) this.#begin();
  }

  /** The graphics memory has been lost, for instance since its process has ended; the browser is about to start another one. */
  get isLost() {
    return this.#gl.isContextLost();
  }

  /** The context is a new one: nothing is in the graphics memory. */
  #begin() {
    const gl = this.#gl;
    this.#view = null;
    this.meshProgram = compile(gl, MESH_VERTEX, MESH_FRAGMENT);
    this.dotProgram = null;
    this.points = this.#texture();
    this.values = this.#texture();
    this.corners = gl.createBuffer();
    this.dots = gl.createBuffer();
    gl.enableVertexAttribArray(0);
    gl.disable(gl.DEPTH_TEST);
  }

  #texture() {
    const gl = this.#gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    return texture;
  }

  /** Shows another mesh, whose slots it reorders, with all points in the box; below it dots of some size at some of its points. */
  show(mesh, box, dots = null) {
    this.#mesh = mesh;
    this.#dots = dots;
    this.#tiles = new Tiles(mesh, box);
    mesh.reorder(this.#tiles.corners);
    this.#sendAll();
    this.stale();
  }

  /** Shows nothing. */
  clear() {
    const gl = this.#gl;
    this.#mesh = null;
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }

  /** Everything is to be drawn again, in other colours for instance. */
  stale() {
    this.#view = null;
    this.onStale();
  }

  get isStale() {
    return this.#view === null;
  }

  #sendAll() {
    const gl = this.#gl;
    const { xy, values, corners, ids } = this.#mesh;
    this.#rows = Math.max(1, Math.ceil((ids * 1.25 + 1024) / ROW));
    const used = Math.ceil(ids / ROW); // rows
    const texels = new Float32Array(4 * ROW * used);
    for (let id = 0; id < ids; id++) this.#texel(xy, id, texels, 4 * id);
    const heights = new Float32Array(ROW * used);
    heights.set(values.subarray(0, ids));
    for (const [texture, inner, outer, numbers] of [
      [this.points, gl.RGBA32F, gl.RGBA, texels],
      [this.values, gl.R32F, gl.RED, heights],
    ]) {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, inner, ROW, this.#rows, 0, outer, gl.FLOAT, null);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, used, outer, gl.FLOAT, numbers);
    }
    this.#room = Math.max(corners.length / 3, Math.ceil(this.#mesh.slots * 1.1) + 1024);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.bufferData(gl.ARRAY_BUFFER, 12 * this.#room, gl.DYNAMIC_DRAW);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, corners);
  }

  /** The coordinates of a point as sums of two single-precision numbers. */
  #texel(xy, id, to, at) {
    for (let k = 0; k < 2; k++) {
      const high = Math.fround(xy[2 * id + k]);
      to[at + k] = high;
      to[at + 2 + k] = xy[2 * id + k] - high;
    }
  }

  /** Sends what an event has changed (the result of Mesh.apply), and draws that part of the picture again. */
  update({ points, slots, box }) {
    if (box !== null) this.#tiles.change(slots, box);
    if (this.isLost) return; // everything will be sent again
    const gl = this.#gl;
    const mesh = this.#mesh;
    if (mesh.ids > ROW * this.#rows || mesh.slots > this.#room) {
      this.#sendAll();
      this.stale();
      return;
    }
    gl.bindTexture(gl.TEXTURE_2D, this.points);
    const texel = new Float32Array(4);
    for (const id of points) {
      this.#texel(mesh.xy, id, texel, 0);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, id % ROW, Math.floor(id / ROW), 1, 1, gl.RGBA, gl.FLOAT, texel);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.values);
    for (const id of points) {
      const value = mesh.values.subarray(id, id + 1);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, id % ROW, Math.floor(id / ROW), 1, 1, gl.RED, gl.FLOAT, value);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    for (const slot of slots) gl.bufferSubData(gl.ARRAY_BUFFER, 12 * slot, mesh.corners, 3 * slot, 3);
    this.counts.bytes += 20 * points.length + 12 * slots.length;
    if (box === null) return;
    widen(this.#changed, box);
    this.onStale();
  }

  /** Draws the picture of a view, which must not change; if it is the view of the last picture, only what has changed. */
  draw(view) {
    if (this.#mesh === null || this.isLost) return;
    const changed = this.#changed;
    this.#changed = emptyBox();
    if (view !== this.#view) this.#drawWhole(view);
    else this.#drawPart(changed);
  }

  #drawWhole(view) {
    const gl = this.#gl;
    this.#view = view;
    this.#drawTiles(view.box(), null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits until it is drawn
    this.counts.whole++;
  }

  /** Draws the part of the picture again that shows a box of the plane. */
  #drawPart(box) {
    const view = this.#view;
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.#gl;
    const [left, bottom] = view.toScreen(box[0], box[1]);
    const [right, top] = view.toScreen(box[2], box[3]);
    const x0 = Math.max(0, Math.floor(left * this.#ratio) - 2);
    const y0 = Math.max(0, Math.floor(height - bottom * this.#ratio) - 2);
    const x1 = Math.min(width, Math.ceil(right * this.#ratio) + 2);
    const y1 = Math.min(height, Math.ceil(height - top * this.#ratio) + 2);
    if (x0 >= x1 || y0 >= y1) return;
    const placeOf = (px, py) => view.toPlane(px / this.#ratio, (height - py) / this.#ratio);
    this.#drawTiles([...placeOf(x0, y0), ...placeOf(x1, y1)], [x0, y0, x1 - x0, y1 - y0]);
    this.counts.part++;
  }

  /** Pixels of the picture in a pixel of the view. */
  get #ratio() {
    return this.#gl.drawingBufferWidth / this.#view.width;
  }

  /** Draws all tiles that meet a box of the plane into the picture, within the pixels [x, y, width, height] or everywhere. */
  #drawTiles(box, pixels) {
    const gl = this.#gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    if (pixels !== null) gl.scissor(...pixels);
    (pixels === null ? gl.disable : gl.enable).call(gl, gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.values);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.points);
    if (this.#dots !== null) this.#drawDots(this.#dots);
    this.#setUniforms(this.meshProgram);
    this.#bind(this.corners);
    let [from, to] = [0, 0]; // slots of tiles one behind the other
    for (const { first, count, box: around } of this.#tiles.list) {
      if (!meets(around, box)) continue;
      if (first !== to) {
        gl.drawArrays(gl.TRIANGLES, 3 * from, 3 * (to - from));
        from = first;
      }
      to = first + count;
    }
    gl.drawArrays(gl.TRIANGLES, 3 * from, 3 * (to - from));
  }

  /** Uses a program, and returns a function as use() does. */
  #setUniforms(program) {
    const gl = this.#gl;
    const at = use(gl, program);
    const view = this.#view;
    const { fill, edge, coloured, edged, range, relief, bands } = this.style;
    const [x, y] = [Math.fround(view.x), Math.fround(view.y)];
    gl.uniform4f(at('centre'), x, y, view.x - x, view.y - y);
    gl.uniform2f(at('scale'), (2 * view.scale) / view.width, (2 * view.scale) / view.height);
    gl.uniform4fv(at('fill'), fill);
    gl.uniform4fv(at('edge'), edge);
    gl.uniform2f(at('range'), range[0], 1 / Math.max(range[1] - range[0], Number.MIN_VALUE));
    gl.uniform1f(at('relief'), relief * view.scale * this.#ratio);
    gl.uniform1f(at('bands'), bands);
    gl.uniform1i(at('coloured'), coloured);
    gl.uniform1i(at('edged'), edged);
    gl.uniform1i(at('points'), 0);
    gl.uniform1i(at('values'), 1);
    return at;
  }

  #drawDots({ points, size }) {
    const gl = this.#gl;
    this.dotProgram ??= compile(gl, DOT_VERTEX, DOT_FRAGMENT);
    const at = this.#setUniforms(this.dotProgram);
    gl.uniform1f(at('size'), size * this.#ratio);
    this.#bind(this.dots);
    gl.bufferData(gl.ARRAY_BUFFER, points, gl.STREAM_DRAW);
    gl.drawArrays(gl.POINTS, 0, points.length);
  }

  /** Vertices are the ids in a buffer. */
  #bind(buffer) {
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 0);
  }
}
