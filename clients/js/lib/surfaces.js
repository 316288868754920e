// Surfaces in the shapes that users of d3 know: Voronoi cells as polygons, contours as GeoJSON.
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

const ringOf = (coords) => Array.from({ length: coords.length / 2 }, (_, i) => [coords[2 * i], coords[2 * i + 1]]);

/** Twice the area, positive if it is counterclockwise. */
function area(ring) {
  let sum = 0;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    sum += (ring[j][0] - ring[0][0]) * (ring[i][1] - ring[0][1]) - (ring[i][0] - ring[0][0]) * (ring[j][1] - ring[0][1]);
  }
  return sum;
}

function contains(ring, [x, y]) {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi] = ring[i];
    const [xj, yj] = ring[j];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

/** The places where the hull crosses the level: {edge, start, point}; a line starts where the ground falls below the level along the hull. */
function crossings(hull, level) {
  const found = [];
  hull.forEach(([x, y, z], i) => {
    const [nx, ny, nz] = hull[(i + 1) % hull.length];
    if (z >= level === nz >= level) return;
    const t = (level - z) / (nz - z);
    found.push({ edge: i, start: z >= level, point: [x + t * (nx - x), y + t * (ny - y)] });
  });
  return found;
}

/** Takes the crossing of that kind that is nearest to a place. */
function takeNearest(free, start, [x, y]) {
  let best = -1;
  let least = Infinity;
  free.forEach((c, i) => {
    const d = c.start === start ? Math.hypot(c.point[0] - x, c.point[1] - y) : Infinity;
    if (d < least) [best, least] = [i, d];
  });
  return best < 0 ? null : free.splice(best, 1)[0];
}

/** Joins open lines along the hull, counterclockwise: higher ground is on the left of both. */
function joinAlongHull(lines, hull, level) {
  const all = crossings(hull, level);
  const free = [...all];
  const ends = new Map(); // crossing where a line ends -> nothing; where one starts -> the line
  for (const ring of lines) {
    const from = takeNearest(free, true, ring[0]);
    const to = takeNearest(free, false, ring[ring.length - 1]);
    if (from !== null && to !== null) ends.set(from, { ring, to });
  }
  const rings = [];
  while (ends.size > 0) {
    const ring = [];
    let from = ends.keys().next().value;
    while (from !== undefined && ends.has(from)) {
      const line = ends.get(from);
      ends.delete(from);
      ring.push(...line.ring);
      // The next crossing along the hull is one where a line starts.
      const at = all.indexOf(line.to);
      const next = all[(at + 1) % all.length];
      for (let i = line.to.edge; i !== next.edge; i = (i + 1) % hull.length) ring.push(hull[(i + 1) % hull.length].slice(0, 2));
      from = next;
    }
    rings.push(ring);
  }
  return rings;
}

/** The ground at or above a level as a GeoJSON MultiPolygon with the property `value`, as d3-contour's; rings end where they begin, outer
 * ones counterclockwise. hull: [[x, y, z], ...], counterclockwise. */
function multiPolygon(contours, hull, level) {
  const open = contours.filter((c) => !c.closed).map((c) => ringOf(c.coords));
  const rings = contours.filter((c) => c.closed).map((c) => ringOf(c.coords));
  rings.push(...joinAlongHull(open, hull, level));
  if (hull.length > 2 && hull.every(([, , z]) => z >= level)) rings.push(hull.map(([x, y]) => [x, y]));
  const polygons = [];
  const holes = [];
  for (const ring of rings) {
    if (area(ring) > 0) polygons.push([ring]);
    else if (area(ring) < 0) holes.push(ring);
  }
  polygons.sort((a, b) => area(a[0]) - area(b[0])); // a hole is in the smallest that contains it
  for (const hole of holes) polygons.find(([outer]) => hole.some((p) => contains(outer, p)))?.push(hole);
  for (const polygon of polygons) for (const ring of polygon) ring.push([...ring[0]]);
  return { type: 'MultiPolygon', value: level, coordinates: polygons };
}

module.exports = { Cells, contourOf, multiPolygon };
