// A picture as SVG: a context that what draws on a 2D canvas can draw on, too.
import { trace } from './overlay.js';
import { VIRIDIS } from './scene.js';

const escape = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');
const round = (v) => Math.round(v * 10) / 10;

/** Has of CanvasRenderingContext2D what the overlay uses. */
export class SvgContext {
  strokeStyle = '#000';
  fillStyle = '#000';
  lineWidth = 1;
  font = '';
  textAlign = 'start';
  #measure; // a context of a canvas
  #path = [];
  #parts = [];

  constructor({ width, height }, ground) {
    Object.assign(this, { width, height });
    this.#measure = new OffscreenCanvas(1, 1).getContext('2d');
    this.#parts.push(`<rect width="${width}" height="${height}" fill="${ground}"/>`);
  }

  beginPath() {
    this.#path = [];
  }

  moveTo(x, y) {
    this.#path.push(`M${round(x)} ${round(y)}`);
  }

  lineTo(x, y) {
    this.#path.push(`L${round(x)} ${round(y)}`);
  }

  /** A whole circle. */
  arc(x, y, r) {
    this.#path.push(`M${round(x - r)} ${round(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`);
  }

  closePath() {
    this.#path.push('z');
  }

  #add(paint) {
    if (this.#path.length > 0) this.#parts.push(`<path ${paint} d="${this.#path.join('')}"/>`);
  }

  fill() {
    this.#add(`fill="${this.fillStyle}"`);
  }

  stroke() {
    this.#add(`fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`);
  }

  fillRect(x, y, width, height) {
    this.#parts.push(`<rect x="${round(x)}" y="${round(y)}" width="${width}" height="${height}" fill="${this.fillStyle}"/>`);
  }

  measureText(text) {
    this.#measure.font = this.font;
    return this.#measure.measureText(text);
  }

  #text(text, x, y, paint) {
    const baseline = this.textBaseline === 'middle' ? ' dominant-baseline="middle"' : '';
    const anchor = this.textAlign === 'center' ? ' text-anchor="middle"' : '';
    this.#parts.push(`<text x="${round(x)}" y="${round(y)}" style="font:${this.font}"${baseline}${anchor} ${paint}>${escape(text)}</text>`);
  }

  fillText(text, x, y) {
    this.#text(text, x, y, `fill="${this.fillStyle}"`);
  }

  strokeText(text, x, y) {
    this.#text(text, x, y, `fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`);
  }

  toString() {
    const size = `width="${this.width}" height="${this.height}"`;
    return `<svg xmlns="http://www.w3.org/2000/svg" ${size} viewBox="0 0 ${this.width} ${this.height}">\n${this.#parts.join('\n')}\n</svg>\n`;
  }
}

/** Draws the triangles of a mesh that are in view, each in one colour, in the style of a Scene. */
export function drawTriangles(context, view, mesh, { coloured, edged, edge, range, relief, bands }) {
  const seen = [];
  mesh.eachTriangleIn(view.box(), (...corners) => {
    const places = corners.flatMap((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]);
    const heights = corners.map((n) => mesh.values[n]);
    seen.push(places);
    const value = (heights[0] + heights[1] + heights[2]) / 3;
    if (!coloured || Number.isNaN(value)) return;
    const level = bands > 0 ? (Math.floor(value / bands) + 0.5) * bands : value;
    context.fillStyle = viridis((level - range[0]) / (range[1] - range[0] || 1), lightOf(relief, places, heights));
    context.beginPath();
    trace(context, view, places, true);
    context.fill();
  });
  if (!edged) return;
  const [red, green, blue] = edge.map((v) => Math.round(255 * v));
  context.strokeStyle = `rgb(${red} ${green} ${blue} / ${edge[3] / 2})`;
  context.lineWidth = 0.7;
  context.beginPath();
  for (const places of seen) trace(context, view, places, true);
  context.stroke();
}

/** The brightness of a triangle beside level ground, as in scene.js. */
function lightOf(relief, [ax, ay, bx, by, cx, cy], [a, b, c]) {
  const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  const east = (relief * ((b - a) * (cy - ay) - (c - a) * (by - ay))) / area; // the slopes
  const north = (relief * ((c - a) * (bx - ax) - (b - a) * (cx - ax))) / area;
  return Math.max(0.25, Math.min(1.35, (1 + (east - north) * Math.SQRT1_2) / Math.hypot(east, north, 1)));
}

/** The colour of a share from 0 to 1, in some light. */
function viridis(share, light) {
  const t = Math.max(0, Math.min(1, share));
  const rgb = [0, 1, 2].map((k) => VIRIDIS.reduceRight((sum, term) => term[k] + t * sum, 0));
  return `rgb(${rgb.map((v) => Math.round(255 * Math.min(1, light * Math.max(0, v)))).join(' ')})`;
}
