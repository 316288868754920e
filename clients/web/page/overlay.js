// The layers over the triangles, drawn by a 2D canvas: hull, Voronoi cells, contours, and the mark under the pointer. The page asks for
// the cells and contours that are on the screen, and again when the set or the view has changed. If the mesh covers only a box, the
// triangles in view that reach out of the box are drawn here, too.

import { placesOf } from './sample.js';

const MOST_CELLS = 20000; // on the screen; more would be nothing but lines
const MOST_HULL = 100000; // points on the hull, for it to be shown

/** Each line: coordinates x, y, ..., and whether it is closed. */
const NO_LINES = { hull: [], cells: [], contours: [], reaching: [] };

export class Overlay {
  layers = { hull: true, cells: false, contours: false };
  colours = { hull: '#c33', cells: '#0a7', contours: '#850', reaching: '#4a7fb5', mark: '#e80' };
  /** {place: [x, y], triangle: [[x, y], ...]} under the pointer. */
  mark = null;
  #canvas;
  #lines = NO_LINES;
  #seen = ''; // what was drawn last: the view and the layers
  #drawnMark = null;
  #drawnLines = null;

  constructor(canvas) {
    this.#canvas = canvas;
  }

  clear() {
    this.mark = null;
    this.#lines = NO_LINES;
  }

  /** Asks for the layers that are shown, and for triangles that reach out of `mesh` if it covers only a box (null otherwise). `points` is
   * the number in view, `hull` the number on the hull. Returns a text of the layers that cannot be shown. */
  async refresh(fetchAll, set, view, { field, points, hull, isLarge, mesh }) {
    const notes = [];
    const box = view.box().join(' ');
    const lines = { ...NO_LINES };
    if (this.layers.hull && hull <= MOST_HULL) lines.hull = hullOf((await fetchAll([`HULL ${set}`]))[0].rows);
    if (this.layers.cells && points > MOST_CELLS) notes.push('zoom in for Voronoi cells');
    else if (this.layers.cells) lines.cells = cellsOf((await fetchAll([`VORONOI ${set} BOX ${box} BINARY`]))[0].data);
    if (this.layers.contours && field !== null && isLarge) {
      notes.push('the set is too large for contours');
    } else if (this.layers.contours && field !== null) {
      const step = niceStep((field.max - field.min) / 20);
      if (step > 0) {
        lines.contours = (await fetchAll([`CONTOUR ${set} ${field.name} EVERY ${step}`]))[0].rows.map(contourOf);
        notes.push(`contours every ${step}`);
      }
    }
    if (mesh !== null) lines.reaching = await reachingOut(fetchAll, set, box, mesh);
    this.#lines = lines;
    return notes.join('; ');
  }

  /** Draws if something has changed. */
  draw(view) {
    const { x, y, scale, width, height } = view;
    const seen = [x, y, scale, width, height, this.#canvas.width, Object.values(this.layers)].join(' ');
    if (seen === this.#seen && this.mark === this.#drawnMark && this.#lines === this.#drawnLines) return;
    [this.#seen, this.#drawnMark, this.#drawnLines] = [seen, this.mark, this.#lines];
    const context = this.#canvas.getContext('2d');
    const ratio = this.#canvas.width / view.width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const layer of ['reaching', 'cells', 'contours', 'hull']) {
      if (this.layers[layer] === false) continue;
      context.strokeStyle = this.colours[layer];
      context.lineWidth = layer === 'hull' ? 1.5 : 1;
      context.beginPath();
      for (const { places, closed } of this.#lines[layer]) trace(context, view, places, closed);
      context.stroke();
    }
    if (this.mark !== null) this.#drawMark(context, view);
  }

  #drawMark(context, view) {
    const { place, triangle } = this.mark;
    context.strokeStyle = context.fillStyle = this.colours.mark;
    context.lineWidth = 2;
    if (triangle !== null) {
      context.beginPath();
      trace(context, view, triangle.flat(), true);
      context.stroke();
    }
    if (place === null) return;
    context.beginPath();
    context.arc(...view.toScreen(...place), 5, 0, 2 * Math.PI);
    context.fill();
  }
}

function trace(context, view, places, closed) {
  for (let k = 0; k + 1 < places.length; k += 2) {
    const [x, y] = view.toScreen(places[k], places[k + 1]);
    if (k === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  if (closed) context.closePath();
}

/** The triangles that meet a box and have a corner that the mesh does not have. */
async function reachingOut(fetchAll, set, box, mesh) {
  const [{ data }] = await fetchAll([`TRIANGLES ${set} WITHIN ${box} BINARY`]);
  const corners = new Uint32Array(data.buffer);
  const reaching = [];
  for (let k = 0; k < corners.length; k += 3) {
    const three = [...corners.subarray(k, k + 3)];
    if (!three.every((id) => mesh.hasPoint(mesh.numberOf(id)))) reaching.push(three);
  }
  if (reaching.length === 0) return [];
  const places = await placesOf(fetchAll, set, new Set(reaching.flat()), null);
  const whole = reaching.filter((three) => three.every((id) => places.has(id)));
  return whole.map((three) => ({ closed: true, places: three.flatMap((id) => places.get(id).slice(0, 2)) }));
}

const hullOf = (rows) => [{ closed: true, places: rows.flatMap((row) => row.split(' ').slice(1).map(Number)) }];

/** A row of CONTOUR: `level closed|open k x1 y1 ...`. */
function contourOf(row) {
  const [, kind, , ...places] = row.split(' ');
  return { closed: kind === 'closed', places: places.map(Number) };
}

/** The binary reply to VORONOI: id, k, k corners. */
function cellsOf(data) {
  const cells = [];
  const view = new DataView(data.buffer);
  for (let at = 0; at < data.length; ) {
    const corners = view.getUint32(at + 4, true);
    const places = new Float64Array(2 * corners);
    at += 8;
    for (let k = 0; k < places.length; k++, at += 8) places[k] = view.getFloat64(at, true);
    cells.push({ closed: true, places });
  }
  return cells;
}

/** The next larger of 1, 2, 5, 10, 20, 50 ... */
function niceStep(step) {
  if (!(step > 0)) return 0;
  const power = Math.floor(Math.log10(step));
  return [1, 2, 5, 10, 20].map((m) => Number(`${m}e${power}`)).find((nice) => nice >= step); // 10 ** -5 is not 1e-5
}
