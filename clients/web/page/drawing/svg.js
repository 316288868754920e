// A picture as SVG: a context that what draws on a 2D canvas can draw on, too.
import { trace } from './overlay.js';

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

/** Draws the triangles of a mesh that are in view; colourOf(value) is a colour or null, edge the colour of lines or null. */
export function drawTriangles(context, view, mesh, colourOf, edge) {
  const { xy, values } = mesh;
  const seen = [];
  mesh.eachTriangleIn(view.box(), (a, b, c) => {
    const places = [a, b, c].flatMap((n) => [xy[2 * n], xy[2 * n + 1]]);
    seen.push(places);
    const colour = colourOf((values[a] + values[b] + values[c]) / 3);
    if (colour === null) return;
    context.fillStyle = colour;
    context.beginPath();
    trace(context, view, places, true);
    context.fill();
  });
  if (edge === null) return;
  context.strokeStyle = edge;
  context.lineWidth = 0.7;
  context.beginPath();
  for (const places of seen) trace(context, view, places, true);
  context.stroke();
}

const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]; // of matplotlib, at quarters

/** The colour of a share from 0 to 1. */
export function viridis(t) {
  const at = Math.max(0, Math.min(1, t)) * (VIRIDIS.length - 1);
  const k = Math.min(VIRIDIS.length - 2, Math.floor(at));
  return `rgb(${VIRIDIS[k].map((v, i) => Math.round(v + (at - k) * (VIRIDIS[k + 1][i] - v))).join(' ')})`;
}
