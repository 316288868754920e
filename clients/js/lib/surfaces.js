// Voronoi cells as polygons of the shape that users of d3 know.
'use strict';

/** Voronoi cells, clipped to `box` [x0, y0, x1, y1]: that of ids[i] has the corners offsets[i] .. offsets[i + 1] of coords (x, y),
 * counterclockwise where y points up. */
class Cells {
  #place;

  constructor(data, box) {
    const rows = [];
    for (let at = 0; at < data.length; at += 8 + 16 * data.readUInt32LE(at + 4)) rows.push(at);
    this.box = box;
    this.ids = Uint32Array.from(rows, (at) => data.readUInt32LE(at));
    this.offsets = new Uint32Array(rows.length + 1);
    rows.forEach((at, i) => {
      this.offsets[i + 1] = this.offsets[i] + data.readUInt32LE(at + 4);
    });
    this.coords = new Float64Array(2 * this.offsets[rows.length]);
    rows.forEach((at, i) => {
      for (let k = 2 * this.offsets[i], from = at + 8; k < 2 * this.offsets[i + 1]; k++, from += 8) {
        this.coords[k] = data.readDoubleLE(from);
      }
    });
  }

  #polygon(i) {
    const polygon = [];
    for (let k = this.offsets[i]; k < this.offsets[i + 1]; k++) polygon.push([this.coords[2 * k], this.coords[2 * k + 1]]);
    if (polygon.length === 0) return null;
    polygon.push([...polygon[0]]);
    return polygon;
  }

  /** The cell of a point as [[x, y], ...], of which the last is the first again; null if there is none in the box. */
  cellPolygon(id) {
    this.#place ??= new Map(Array.from(this.ids, (other, i) => [other, i]));
    const i = this.#place.get(id);
    return i === undefined ? null : this.#polygon(i);
  }

  /** Every cell in the box, with its point's id as `index`. */
  *cellPolygons() {
    for (let i = 0; i < this.ids.length; i++) {
      const polygon = this.#polygon(i);
      if (polygon !== null) yield Object.assign(polygon, { index: this.ids[i] });
    }
  }
}

module.exports = { Cells };
