// Surfaces in the shapes that users of d3 know: Voronoi cells as polygons, contours as GeoJSON.
'use strict';

const { numberOf } = require('./framing.js');
const { list, real } = require('./values.js');

/** Voronoi cells, clipped to `box` [x0, y0, x1, y1]. The cell of ids[i] has the corners offsets[i] .. offsets[i + 1] of coords (x, y),
 * counterclockwise if y points up. */
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

  /** The cell of a point as [[x, y], ...], closed: the last corner repeats the first; null if there is none in the box. */
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

/** {level, closed, coords} of a row of CONTOUR. */
function contourOf(row) {
  const [level, kind, , ...xy] = row.split(' ');
  return { level: Number(level), closed: kind === 'closed', coords: Float64Array.from(xy, Number) };
}

/** Names the levels of CONTOUR. */
function levelWords(levels, every, base) {
  if ((levels === undefined) === (every === undefined)) throw new TypeError('either levels or every');
  if (levels !== undefined && base !== undefined) throw new TypeError('a base needs every');
  return levels === undefined ? ['EVERY', real(every), 'BASE', real(base ?? 0)] : list(levels, real);
}

/** The GeoJSON Polygons of the rows of CONTOUR ... BANDS; rings end where they begin. */
function bandsOf(rows) {
  const bands = [];
  for (const row of rows) {
    const [low, high, number, , , ...xy] = row.split(' ');
    if (Number(number) === bands.length) bands.push({ type: 'Polygon', low: numberOf(low), high: numberOf(high), coordinates: [] });
    const ring = ringOf(xy.map(Number));
    bands.at(-1).coordinates.push([...ring, ring[0]]);
  }
  return bands;
}

const ringOf = (coords) => Array.from({ length: coords.length / 2 }, (_, i) => [coords[2 * i], coords[2 * i + 1]]);

/** Polygons of bands from a level up as a GeoJSON MultiPolygon with the property `value`, as d3-contour's. */
function multiPolygon(bands, level) {
  return { type: 'MultiPolygon', value: level, coordinates: bands.map(({ coordinates }) => coordinates) };
}

module.exports = { Cells, bandsOf, contourOf, levelWords, multiPolygon };
