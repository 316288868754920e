// What lies over the triangles, drawn by a 2D canvas: hull, Voronoi cells, contours, and what is under the pointer. Cells and contours
// are asked for as far as they are on the screen, and again when the set or the view has changed.

const MOST_CELLS = 20000; // on the screen; more would be nothing but lines

export class Overlay {
  layers = { hull: true, cells: false, contours: false };
  colours = { hull: '#c33', cells: '#0a7', contours: '#850', mark: '#e80' };
  /** {place: [x, y], triangle: [[x, y], ...]} under the pointer. */
  mark = null;
  #canvas;
  #lines = { hull: [], cells: [], contours: [] }; // each line: coordinates x, y, ..., and whether it is closed

  constructor(canvas) {
    this.#canvas = canvas;
  }

  clear() {
    this.mark = null;
    this.#lines = { hull: [], cells: [], contours: [] };
  }

  /** Asks for the layers that are shown. Returns what cannot be shown, as text. */
  async refresh(connection, set, view, { field, points, box }) {
    const notes = [];
    const [x0, y0, x1, y1] = view.box();
    const shown = points * part([x0, y0, x1, y1], box);
    if (this.layers.hull) this.#lines.hull = hullOf((await connection.request(`HULL ${set}`)).rows);
    if (this.layers.cells && shown > MOST_CELLS) {
      this.#lines.cells = [];
      notes.push('zoom in for Voronoi cells');
    } else if (this.layers.cells) {
      this.#lines.cells = cellsOf((await connection.request(`VORONOI ${set} BOX ${x0} ${y0} ${x1} ${y1} BINARY`)).data);
    }
    if (this.layers.contours && field !== null) {
      const step = niceStep((field.max - field.min) / 20);
      const { rows } = step > 0 ? await connection.request(`CONTOUR ${set} ${field.name} EVERY ${step}`) : { rows: [] };
      this.#lines.contours = rows.map(contourOf);
      if (step > 0) notes.push(`contours every ${step}`);
    }
    return notes.join('; ');
  }

  draw(view) {
    const context = this.#canvas.getContext('2d');
    const ratio = this.#canvas.width / view.width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const layer of ['cells', 'contours', 'hull']) {
      if (!this.layers[layer]) continue;
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

/** How much of the box is in the view. */
function part(view, box) {
  const along = (i) => {
    const length = box[i + 2] - box[i];
    const common = Math.min(view[i + 2], box[i + 2]) - Math.max(view[i], box[i]);
    return length > 0 ? Math.max(0, common / length) : 1;
  };
  return along(0) * along(1);
}

function trace(context, view, places, closed) {
  for (let k = 0; k + 1 < places.length; k += 2) {
    const [x, y] = view.toScreen(places[k], places[k + 1]);
    if (k === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  if (closed) context.closePath();
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
  const power = 10 ** Math.floor(Math.log10(step));
  return [1, 2, 5, 10].find((m) => m * power >= step) * power;
}
