// The triangulation drawn by WebGL 2. The corners of the triangles that are to be drawn are sent with each picture, at their places on the
// screen, which are computed in double precision. Changes since the last frame are drawn again in their part of the picture, from the
// triangles that meet it.

import { emptyBox, widen } from '../data/box.js';
import { grown } from '../data/mesh.js';

/** The colour map viridis of matplotlib, as a polynomial that M. Zucker fitted to it (public domain): red, green and blue, from 0 to 1, of
 * each power. */
export const VIRIDIS = [
  [0.2777, 0.0054, 0.3341], [0.1051, 1.4046, 1.3846], [-0.3309, 0.2148, 0.0951], [-4.6342, -5.7991, -19.3324],
  [6.2283, 14.1799, 56.6906], [4.7764, -13.7451, -65.353], [-5.4355, 4.6459, 26.3125],
];

const NUMBERS = 3; // of a vertex: x and y in clip space, and its value
const SQUARE = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]]; // the corners of two triangles

const HEAD = `#version 300 es
precision highp float; precision highp int;`;

const VERTEX = `${HEAD}
in vec3 vertex;
out vec3 corner;
out float value;
void main() {
  gl_Position = vec4(vertex.xy, 0.0, 1.0);
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  value = vertex.z;
}`;

const FRAGMENT = `${HEAD}
in vec3 corner;
in float value;
uniform vec2 range;      // the least value, and 1 / (greatest - least)
uniform vec4 fill, edge;
uniform bool coloured, edged;
uniform bool even;       // the colour of many small triangles, without lines
uniform float bands;     // the step between bands of one colour; 0: colours change steadily
uniform float relief;    // pixels that the ground rises for a unit of the value; 0: no hillshade
out vec4 colour;
const vec3 term[7] = vec3[7](${VIRIDIS.map((term) => `vec3(${term})`)});
vec3 viridis(float t) {
  vec3 sum = term[6];
  for (int i = 5; i >= 0; i--) sum = term[i] + t * sum;
  return clamp(sum, 0.0, 1.0);
}
void main() {
  // Light from the north-west, 45 degrees above the ground [Horn 1981].
  vec3 normal = normalize(vec3(-relief * dFdx(value), -relief * dFdy(value), 1.0));
  float light = relief > 0.0 ? clamp(dot(normal, vec3(-0.5, 0.5, 0.7071)) * 1.4142, 0.25, 1.35) : 1.0;
  vec3 width = fwidth(corner);
  vec3 near = smoothstep(vec3(0.0), 1.2 * width, corner);
  // Lines fade where triangles become lower than 16 pixels: triangles of a few pixels would be nothing but lines.
  float faded = 1.0 - 0.78 * smoothstep(0.06, 0.4, max(width.x, max(width.y, width.z)));
  float line = (edged ? edge.a : 0.0) * (even ? 0.22 : faded * (1.0 - min(near.x, min(near.y, near.z))));
  float level = bands > 0.0 ? (floor(value / bands) + 0.5) * bands : value;
  vec4 ground = coloured && value == value ? vec4(viridis(clamp((level - range.x) * range.y, 0.0, 1.0)) * light, 1.0) : fill;
  colour = vec4(edge.rgb * line + ground.rgb * ground.a * (1.0 - line), line + ground.a * (1.0 - line));
}`;

/** Begins to compile the program; use() waits for it. */
function compile(gl) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, 'vertex');
  gl.linkProgram(program);
  return program;
}

/** Uses a program. Returns a function that returns the place of a uniform. */
function use(gl, program) {
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error([gl.getProgramInfoLog(program), ...gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader))].join('\n'));
  }
  gl.useProgram(program);
  return (name) => gl.getUniformLocation(program, name);
}

export class Scene {
  /** Pictures drawn whole and in part, and triangles of the parts. */
  counts = { whole: 0, part: 0, triangles: 0 };
  style = { coloured: false, edged: true, fill: [0.2, 0.4, 0.6, 0.1], edge: [0.2, 0.4, 0.6, 0.9], range: [0, 1], relief: 0, bands: 0 };
  #gl;
  #mesh = null;
  #squares = null; // of a sample
  #vertices = new Float32Array(0); // that are being sent
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
    this.program = compile(gl);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, NUMBERS, gl.FLOAT, false, 0, 0);
    gl.disable(gl.DEPTH_TEST);
  }

  /** Shows another mesh, and below it the squares of a sample. */
  show(mesh, squares = null) {
    this.#mesh = mesh;
    this.#squares = squares;
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

  /** Something in a box of the plane has changed. */
  update(box) {
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
    this.#drawBox(view.box(), null);
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
    this.counts.triangles += this.#drawBox([...placeOf(x0, y0), ...placeOf(x1, y1)], [x0, y0, x1 - x0, y1 - y0]);
    this.counts.part++;
  }

  /** Pixels of the picture in a pixel of the view. */
  get #ratio() {
    return this.#gl.drawingBufferWidth / this.#view.width;
  }

  /** Draws all that meets a box of the plane into the picture, within the pixels [x, y, width, height] or everywhere. Returns the number
   * of triangles. */
  #drawBox(box, pixels) {
    const gl = this.#gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    if (pixels !== null) gl.scissor(...pixels);
    (pixels === null ? gl.disable : gl.enable).call(gl, gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (this.#squares !== null) this.#drawSquares(this.#squares);
    const { xy, values, triangles } = this.#mesh;
    return this.#drawTriangles(false, triangles, (put) => {
      const corner = (n) => put(xy[2 * n], xy[2 * n + 1], values[n]);
      this.#mesh.eachTriangleIn(box, (a, b, c) => {
        corner(a);
        corner(b);
        corner(c);
      });
    });
  }

  /** {places: x, y, value ..., size: in units of the plane}. */
  #drawSquares({ places, size }) {
    this.#drawTriangles(true, (2 * places.length) / 3, (put) => {
      for (let k = 0; k < places.length; k += 3) {
        for (const [dx, dy] of SQUARE) put(places[k] + dx * size, places[k + 1] + dy * size, places[k + 2]);
      }
    });
  }

  /** Draws triangles and returns their number, which is at most `most`. each(put) calls put(x, y, value) for all their corners. even: in one
   * colour, without lines. */
  #drawTriangles(even, most, each) {
    const gl = this.#gl;
    const { x, y, scale, width, height } = this.#view;
    const [across, up] = [(2 * scale) / width, (2 * scale) / height];
    const vertices = (this.#vertices = grown(this.#vertices, 3 * NUMBERS * most));
    let n = 0;
    each((px, py, value) => {
      vertices[n++] = (px - x) * across;
      vertices[n++] = (py - y) * up;
      vertices[n++] = value;
    });
    this.#setUniforms(even);
    gl.bufferData(gl.ARRAY_BUFFER, vertices.subarray(0, n), gl.STREAM_DRAW);
    gl.drawArrays(gl.TRIANGLES, 0, n / NUMBERS);
    return n / NUMBERS / 3;
  }

  #setUniforms(even) {
    const gl = this.#gl;
    const at = use(gl, this.program);
    const { fill, edge, coloured, edged, range, relief, bands } = this.style;
    gl.uniform4fv(at('fill'), fill);
    gl.uniform4fv(at('edge'), edge);
    gl.uniform2f(at('range'), range[0], 1 / Math.max(range[1] - range[0], Number.MIN_VALUE));
    gl.uniform1f(at('relief'), relief * this.#view.scale * this.#ratio);
    gl.uniform1f(at('bands'), bands);
    gl.uniform1i(at('coloured'), coloured);
    gl.uniform1i(at('edged'), edged);
    gl.uniform1i(at('even'), even);
  }
}
