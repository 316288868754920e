// The layers over the triangles, drawn by a 2D canvas: hull, constraints, Voronoi cells, contours, points and their names, and a scale
// bar. If the mesh covers only a box, the triangles in view that reach out of the box are drawn here, too.

import { meets } from '../data/box.js';
import { writeLabels } from './labels.js';
import { Lines } from './lines.js';
import { niceStep } from './steps.js';

const MOST_COLOURED = 3000; // cells on the screen that get colours of their own
const LEAST_SPACING = 14; // pixels between points, about, from which on they are drawn
const MOST_ROUND = 700; // points on the screen that are drawn as circles
const MOST_THIN = 60000; // triangles of a mesh of which thin ones are looked for
const THIN = 4; // pixels of height, below which a triangle is thin
const LONG = 12; // pixels of length, from which on that is seen
const SCALE_BAR = 120; // pixels, at most
const BOLD = 2.5; // pixels of a constraint

const COMMON = { hull: '#c33', contours: '#850', reaching: '#4a7fb5', thin: '#4a7fb580' };
export const THEMES = {
  light: { ...COMMON, cells: '#fffb', soft: '55% 78%', points: '#223', text: '#112', halo: '#fffd' },
  dark: { ...COMMON, cells: '#0009', contours: '#da6', soft: '32% 40%', points: '#dde', text: '#eef', halo: '#111d' },
};

export class Overlay {
  layers = { triangles: true, hull: true, cells: false, contours: false, points: true, names: true };
  colours = THEMES.light;
  names = new Map(); // id -> name
  unit = ''; // of the plane, for the scale bar
  labels = []; // boxes of the names on the screen
  lines = new Lines();
  #canvas;
  #view = null; // that is drawn; null: something else has changed

  constructor(canvas) {
    this.#canvas = canvas;
  }

  /** Nothing is left of a set. */
  clear() {
    this.lines.clear();
    this.stale();
  }

  /** Something else than the view has changed. */
  stale() {
    this.#view = null;
  }

  /** Draws the layers for a view, which must not change, unless they are drawn; mesh: the points on the screen, null if there is no set. */
  draw(view, mesh) {
    if (view === this.#view) return;
    this.#view = view;
    // Drawn by the processor: without a graphics card, a graphics process takes far longer for paths and text.
    const context = this.#canvas.getContext('2d', { willReadFrequently: true });
    const ratio = this.#canvas.width / view.width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (mesh !== null) this.paint(context, view, mesh);
  }

  /** Draws all layers on a context of pixels of the screen. */
  paint(context, view, mesh) {
    const box = view.box();
    const cells = this.lines.cells.filter((cell) => meets(cell.box, box));
    if (this.layers.cells) this.#fillCells(context, view, cells);
    for (const layer of ['reaching', 'cells', 'contours', 'hull']) {
      const isEdge = layer === 'hull' && !this.layers.hull && this.layers.triangles; // triangles draw only their half of a line there
      if (this.layers[layer] === false && !isEdge) continue;
      context.strokeStyle = this.colours[isEdge ? 'reaching' : layer];
      context.lineWidth = layer === 'hull' && !isEdge ? 1.5 : 1;
      context.beginPath();
      for (const { places, closed } of layer === 'cells' ? cells : this.lines[layer]) trace(context, view, places, closed);
      context.stroke();
    }
    if (this.layers.triangles) this.#drawThin(context, view, mesh);
    if (this.layers.hull || this.layers.triangles) this.#drawConstraints(context, view, mesh);
    if (this.layers.points) this.#drawPoints(context, view, mesh);
    this.labels = this.layers.names ? writeLabels(context, view, mesh, this.names, this.colours) : [];
    this.#drawScale(context, view);
  }

  #fillCells(context, view, cells) {
    if (cells.length > MOST_COLOURED) return;
    for (const { id, places } of cells) {
      context.fillStyle = `hsl(${(id * 137.508) % 360} ${this.colours.soft} / 0.5)`; // hues a golden angle apart
      context.beginPath();
      trace(context, view, places, true);
      context.fill();
    }
  }

  /** The edges of triangles too thin for the lines of WebGL, which would be dashed. */
  #drawThin(context, view, mesh) {
    if (mesh.triangles > MOST_THIN) return;
    const { xy } = mesh;
    context.strokeStyle = this.colours.thin;
    context.lineWidth = 1;
    context.beginPath();
    mesh.eachTriangleIn(view.box(), (...corners) => {
      const [ax, ay, bx, by, cx, cy] = corners.flatMap((n) => [xy[2 * n], xy[2 * n + 1]]);
      const longest = view.scale * Math.max(Math.hypot(bx - ax, by - ay), Math.hypot(cx - ax, cy - ay), Math.hypot(cx - bx, cy - by));
      const height = (view.scale ** 2 * Math.abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))) / longest;
      if (height < THIN && longest > LONG) trace(context, view, [ax, ay, bx, by, cx, cy], true);
    });
    context.stroke();
  }

  /** Constraints are drawn between the present places of their ends. */
  #drawConstraints(context, view, mesh) {
    context.strokeStyle = this.colours.text;
    context.lineWidth = BOLD;
    context.beginPath();
    for (const ids of this.lines.constraints) {
      const ends = ids.map((id) => mesh.numberOf(id));
      if (ends.every((n) => n !== undefined && mesh.hasPoint(n))) trace(context, view, ends.flatMap((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]), false);
    }
    context.stroke();
  }

  #drawPoints(context, view, { xy, ids }) {
    const [x0, y0, x1, y1] = view.box();
    const most = (view.width * view.height) / LEAST_SPACING ** 2;
    const seen = [];
    for (let k = 0; k < 2 * ids; k += 2) {
      if (!(xy[k] >= x0 && xy[k] <= x1 && xy[k + 1] >= y0 && xy[k + 1] <= y1)) continue;
      if (seen.push(view.toScreen(xy[k], xy[k + 1])) > most) return;
    }
    context.fillStyle = this.colours.points;
    // Thousands of circles would keep a graphics process without a graphics card busy for seconds; squares do not.
    for (const [x, y] of seen) {
      if (seen.length > MOST_ROUND) {
        context.fillRect(x - 1.5, y - 1.5, 3, 3);
      } else {
        context.beginPath();
        context.arc(x, y, 2.2, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }

  #drawScale(context, view) {
    const length = niceStep(SCALE_BAR / 2.5 / view.scale);
    const [x1, y] = [view.width - 14, view.height - 14];
    const x0 = x1 - length * view.scale;
    context.strokeStyle = context.fillStyle = this.colours.text;
    context.lineWidth = 1.5;
    context.beginPath();
    for (const [i, [px, py]] of [[x0, y - 5], [x0, y], [x1, y], [x1, y - 5]].entries()) {
      if (i === 0) context.moveTo(px, py);
      else context.lineTo(px, py);
    }
    context.stroke();
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'alphabetic';
    context.fillText(`${length} ${this.unit}`.trim(), (x0 + x1) / 2, y - 5);
    context.textAlign = 'start';
  }
}

/** Adds a line through places x, y, ... to the path of a context. */
export function trace(context, view, places, closed) {
  for (let k = 0; k + 1 < places.length; k += 2) {
    const [x, y] = view.toScreen(places[k], places[k + 1]);
    if (k === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  if (closed) context.closePath();
}
