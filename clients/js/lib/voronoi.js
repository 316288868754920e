// The interface of d3-delaunay's Voronoi. Cells are those of the core: exact places, each coordinate rounded once, clipped to the bounds.
// Cells that share an edge have the same two corners there, so edges are found by comparing corners.
'use strict';

const { withPoints } = require('./core.js');
const { onto } = require('./path.js');

const CLOCKWISE = 1;

/** The edge that two polygons have in common, in opposite directions: the index of the corner of the first one where it begins, -1:
 * there is none. A polygon is {from, to}, indices of corners. */
function findCommonEdge(coords, a, b) {
  for (let i = a.from; i < a.to; i++) {
    const next = i + 1 < a.to ? i + 1 : a.from;
    for (let j = b.from; j < b.to; j++) {
      const before = j > b.from ? j - 1 : b.to - 1;
      if (
        coords[2 * i] === coords[2 * j] &&
        coords[2 * i + 1] === coords[2 * j + 1] &&
        coords[2 * next] === coords[2 * before] &&
        coords[2 * next + 1] === coords[2 * before + 1]
      ) {
        return i;
      }
    }
  }
  return -1;
}

class Voronoi {
  #offsets; // by point: where its corners begin
  #coords; // of all corners
  #circumcenters;

  constructor(delaunay, [xmin, ymin, xmax, ymax] = [0, 0, 960, 500]) {
    if (!((xmax = +xmax) >= (xmin = +xmin)) || !((ymax = +ymax) >= (ymin = +ymin))) throw new Error('invalid bounds');
    Object.assign(this, { delaunay, xmin, ymin, xmax, ymax });
    this.#make();
  }

  update() {
    this.delaunay.update();
    this.#make();
    return this;
  }

  #make() {
    const { xmin, ymin, xmax, ymax } = this;
    const { points } = this.delaunay;
    const isEmpty = xmin === xmax || ymin === ymax;
    this.#circumcenters = null;
    this.#coords = new Float64Array(0);
    this.#offsets = new Uint32Array((points.length >> 1) + 1);
    if (isEmpty) return;
    withPoints(points, (core, set) => {
      core.call('set_cells', set, xmin, ymin, xmax, ymax);
      this.#offsets = core.array(Uint32Array, 0);
      this.#coords = core.array(Float64Array, 1);
    });
  }

  /** By triangle of delaunay.triangles, as its points are when this is first read. */
  get circumcenters() {
    this.#circumcenters ??= withPoints(this.delaunay.points, (core, set) => {
      core.call('set_centres', set, CLOCKWISE);
      return core.array(Float64Array, 0);
    });
    return this.#circumcenters;
  }

  /** By point, the directions of the two rays of its cell if it is on the hull, else zeros. */
  get vectors() {
    const { points, hull } = this.delaunay;
    const vectors = new Float64Array(2 * points.length);
    let before = hull.at(-1);
    for (const p of hull) {
      const x = points[2 * before + 1] - points[2 * p + 1];
      const y = points[2 * p] - points[2 * before];
      vectors.set([x, y], 4 * before + 2);
      vectors.set([x, y], 4 * p);
      before = p;
    }
    return vectors;
  }

  #cell(i) {
    return { from: this.#offsets[i], to: this.#offsets[i + 1] };
  }

  contains(i, x, y) {
    x = +x;
    y = +y;
    return x === x && y === y && this.delaunay._step(i, x, y) === i;
  }

  /** The points whose cells have an edge in common with that of i, within the bounds. */
  *neighbors(i) {
    const cell = this.#cell(i);
    if (!(cell.to > cell.from)) return;
    for (const j of this.delaunay.neighbors(i)) if (findCommonEdge(this.#coords, cell, this.#cell(j)) >= 0) yield j;
  }

  // ---- drawing ----

  /** The edges between cells. */
  render(context) {
    return onto(context, (to) => {
      const coords = this.#coords;
      for (let i = 0; i + 1 < this.#offsets.length; i++) {
        const cell = this.#cell(i);
        if (cell.to === cell.from) continue;
        for (const j of this.delaunay.neighbors(i)) {
          const k = j > i ? findCommonEdge(coords, cell, this.#cell(j)) : -1;
          if (k < 0) continue;
          const next = k + 1 < cell.to ? k + 1 : cell.from;
          to.moveTo(coords[2 * k], coords[2 * k + 1]);
          to.lineTo(coords[2 * next], coords[2 * next + 1]);
        }
      }
    });
  }

  renderBounds(context) {
    const { xmin, ymin, xmax, ymax } = this;
    return onto(context, (to) => to.rect(xmin, ymin, xmax - xmin, ymax - ymin));
  }

  renderCell(i, context) {
    return onto(context, (to) => {
      const { from, to: end } = this.#cell(i);
      if (!(end > from)) return;
      for (let k = from; k < end; k++) to[k === from ? 'moveTo' : 'lineTo'](this.#coords[2 * k], this.#coords[2 * k + 1]);
      to.closePath();
    });
  }

  /** Closed: the last corner repeats the first one; null if the point has no cell in the bounds. */
  cellPolygon(i) {
    const coords = this.#coords;
    const { from, to } = this.#cell(i);
    if (!(to > from)) return null;
    const polygon = new Array(to - from + 1);
    for (let i = 0, k = 2 * from; k < 2 * to; i++, k += 2) polygon[i] = [coords[k], coords[k + 1]];
    polygon[to - from] = [coords[2 * from], coords[2 * from + 1]];
    return polygon;
  }

  *cellPolygons() {
    for (let i = 0; i + 1 < this.#offsets.length; i++) {
      const polygon = this.cellPolygon(i);
      if (polygon === null) continue;
      polygon.index = i;
      yield polygon;
    }
  }
}

module.exports = { Voronoi };
