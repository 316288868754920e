// The layers over the triangles, drawn by a 2D canvas: hull, Voronoi cells, contours, points and their names, a scale bar, and the mark
// under the pointer. The page asks for the cells and contours that are on the screen, and again when the set or the view has changed. If the mesh covers only a box, the
// triangles in view that reach out of the box are drawn here, too.

import { writeLabels } from './labels.js';
import { placesOf } from './sample.js';

const MOST_CELLS = 20000; // on the screen; more would be nothing but lines
const MOST_HULL = 100000; // points on the hull, for it to be shown
const MOST_COLOURED = 3000; // cells on the screen that get colours of their own
const LEAST_SPACING = 14; // pixels between points, about, from which on they are drawn
const MOST_ROUND = 700; // points on the screen that are drawn as circles
const MOST_SCANNED = 500000; // points of a mesh of which those in view are looked for
const SCALE_BAR = 120; // pixels, at most

/** Each line: coordinates x, y, ..., and whether it is closed. */
const NO_LINES = { hull: [], cells: [], contours: [], reaching: [] };
const BOLD = 2.5; // pixels of a constraint

const COMMON = { hull: '#c33', contours: '#850', reaching: '#4a7fb5', mark: '#e80' };
export const THEMES = {
  light: { ...COMMON, cells: '#fffb', soft: '55% 78%', points: '#223', text: '#112', halo: '#fffd' },
  dark: { ...COMMON, cells: '#0009', contours: '#da6', soft: '32% 40%', points: '#dde', text: '#eef', halo: '#111d' },
};

export class Overlay {
  layers = { hull: true, cells: false, contours: false, points: true, names: true };
  colours = THEMES.light;
  names = new Map(); // id -> name
  unit = ''; // of the plane, for the scale bar
  pointers = new Map(); // number -> [x, y] of other people's pointers
  labels = []; // boxes of the names on the screen
  /** {place: [x, y], triangle: [[x, y], ...]} under the pointer. */
  mark = null;
  #canvas;
  #lines = NO_LINES;
  #constraints = []; // pairs of ids
  #seen = null; // what was drawn last: the view and the layers
  #turn = 0; // how often it was cleared: layers that come later are not those of the set
  #drawnMark = null;
  #drawnLines = null;

  constructor(canvas) {
    this.#canvas = canvas;
  }

  clear() {
    this.mark = null;
    this.#lines = NO_LINES;
    this.#constraints = [];
    this.#turn++;
    this.stale();
  }

  /** Something else than the view, the lines and the mark has changed. */
  stale() {
    this.#seen = null;
  }

  /** Asks for the layers that are shown, and for triangles that reach out of `mesh` if it covers only a box (null otherwise). `points` is
   * the number in view, `hull` the number on the hull. Returns a text of the layers that cannot be shown. */
  async refresh(fetchAll, set, view, { field, points, hull, isLarge, mesh }) {
    const notes = [];
    const turn = this.#turn;
    const box = view.box().join(' ');
    const lines = { ...NO_LINES };
    let constraints = [];
    if (this.layers.hull && hull <= MOST_HULL) {
      const [around, edges] = await fetchAll([`HULL ${set}`, ...(isLarge ? [] : [`EDGES ${set} CONSTRAINED`])]);
      lines.hull = hullOf(around.rows);
      constraints = edges?.rows.map((row) => row.split(' ').map(Number)) ?? [];
    }
    if (this.layers.cells && points > MOST_CELLS) notes.push('zoom in for Voronoi cells');
    else if (this.layers.cells) lines.cells = cellsOf((await fetchAll([`VORONOI ${set} BOX ${box} BINARY`]))[0].data);
    if (this.layers.contours && field !== null && isLarge) {
      notes.push('the set is too large for contours');
    } else if (this.layers.contours && field !== null) {
      const step = stepOf(field);
      if (step > 0) {
        lines.contours = (await fetchAll([`CONTOUR ${set} ${field.name} EVERY ${step}`]))[0].rows.map(contourOf);
        notes.push(`contours every ${step}`);
      }
    }
    if (mesh !== null) lines.reaching = await reachingOut(fetchAll, set, box, mesh);
    if (turn !== this.#turn) return '';
    this.#lines = lines;
    this.#constraints = constraints;
    return notes.join('; ');
  }

  /** Draws if something has changed; mesh: the points on the screen, null if there is no set. */
  draw(view, mesh) {
    const { x, y, scale, width, height } = view;
    const seen = [x, y, scale, width, height, this.#canvas.width, mesh?.version, Object.values(this.layers)].join(' ');
    if (seen === this.#seen && this.mark === this.#drawnMark && this.#lines === this.#drawnLines) return;
    [this.#seen, this.#drawnMark, this.#drawnLines] = [seen, this.mark, this.#lines];
    const context = this.#canvas.getContext('2d');
    const ratio = this.#canvas.width / view.width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (mesh !== null) this.paint(context, view, mesh);
  }

  /** Draws all layers on a context of pixels of the screen. */
  paint(context, view, mesh) {
    if (this.layers.cells) this.#fillCells(context, view);
    for (const layer of ['reaching', 'cells', 'contours', 'hull']) {
      if (this.layers[layer] === false) continue;
      context.strokeStyle = this.colours[layer];
      context.lineWidth = layer === 'hull' ? 1.5 : 1;
      context.beginPath();
      for (const { places, closed } of this.#lines[layer]) trace(context, view, places, closed);
      context.stroke();
    }
    if (this.layers.hull) this.#drawConstraints(context, view, mesh);
    if (this.layers.points) this.#drawPoints(context, view, mesh);
    this.labels = this.layers.names ? writeLabels(context, view, mesh, this.names, this.colours) : [];
    if (this.mark !== null) this.#drawMark(context, view);
    this.#drawScale(context, view);
    this.#drawPointers(context, view);
  }

  #fillCells(context, view) {
    const { cells } = this.#lines;
    if (cells.length > MOST_COLOURED) return;
    for (const { id, places } of cells) {
      context.fillStyle = `hsl(${(id * 137.508) % 360} ${this.colours.soft} / 0.5)`; // hues a golden angle apart
      context.beginPath();
      trace(context, view, places, true);
      context.fill();
    }
  }

  /** Constraints are drawn between the present places of their ends. */
  #drawConstraints(context, view, mesh) {
    context.strokeStyle = this.colours.text;
    context.lineWidth = BOLD;
    context.beginPath();
    for (const ids of this.#constraints) {
      const ends = ids.map((id) => mesh.numberOf(id));
      if (ends.every((n) => n !== undefined && mesh.hasPoint(n))) trace(context, view, ends.flatMap((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]), false);
    }
    context.stroke();
  }

  #drawPoints(context, view, { xy, ids }) {
    if (ids > MOST_SCANNED) return;
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

  #drawPointers(context, view) {
    for (const [number, place] of this.pointers) {
      const [x, y] = view.toScreen(...place);
      context.fillStyle = `hsl(${(number * 137.508) % 360} 80% 45%)`;
      context.strokeStyle = this.colours.halo;
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 5, y + 15);
      context.lineTo(x + 12, y + 9);
      context.closePath();
      context.fill();
      context.stroke();
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
    const id = view.getUint32(at, true);
    const corners = view.getUint32(at + 4, true);
    const places = new Float64Array(2 * corners);
    at += 8;
    for (let k = 0; k < places.length; k++, at += 8) places[k] = view.getFloat64(at, true);
    cells.push({ id, closed: true, places });
  }
  return cells;
}

/** Returns the step between levels of a field. */
export const stepOf = ({ min, max }) => niceStep((max - min) / 20);

/** The next larger of 1, 2, 5, 10, 20, 50 ... */
function niceStep(step) {
  if (!(step > 0)) return 0;
  const power = Math.floor(Math.log10(step));
  return [1, 2, 5, 10, 20].map((m) => Number(`${m}e${power}`)).find((nice) => nice >= step); // 10 ** -5 is not 1e-5
}
