// Surfaces in the shapes that users of d3 know: Voronoi cells as polygons, contours as GeoJSON.
'use strict';

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
  const word = (level) => String(level).replace('Infinity', 'inf');
  return levels ? [...levels].map(word).join(' ') : `EVERY ${every} BASE ${base}`;
}

/** A level of a row, which may be infinite. */
const levelOf = (word) => Number(word.replace('inf', 'Infinity'));

/** The GeoJSON Polygons of the rows of CONTOUR ... BANDS; rings end where they begin. */
function bandsOf(rows) {
  const bands = [];
  for (const row of rows) {
    const [low, high, number, , , ...xy] = row.split(' ');
    if (Number(number) === bands.length) bands.push({ type: 'Polygon', low: levelOf(low), high: levelOf(high), coordinates: [] });
    const ring = ringOf(xy.map(Number));
    bands.at(-1).coordinates.push([...ring, ring[0]]);
  }
  return bands;
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

/** Of the gaps between the first and the second of some numbers, the third and the fourth, ...: the widest, [its width, its middle]. */
function widest(numbers) {
  numbers.sort((a, b) => a - b);
  let best = [0, NaN];
  for (let i = 1; i < numbers.length; i += 2) {
    const width = numbers[i] - numbers[i - 1];
    if (width > best[0]) best = [width, numbers[i - 1] + width / 2];
  }
  return best;
}

/** A place strictly inside a ring: in the middle between two of its sides, halfway between the heights of two of its corners. Of a few of
 * the higher bands between corners the one is taken where the ring is widest: in others it may only go there and back. */
function placeIn(ring) {
  const heights = ring.map(([, y]) => y).sort((a, b) => a - b);
  const bands = heights.slice(1).map((y, i) => [y - heights[i], heights[i] + (y - heights[i]) / 2]);
  let best = [0, NaN, NaN];
  for (const [height, y] of bands.sort((a, b) => b[0] - a[0]).slice(0, 32)) {
    const sides = [];
    for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
      const [[xi, yi], [xj, yj]] = [ring[i], ring[j]];
      if (yi > y !== yj > y) sides.push(xi + ((xj - xi) * (y - yi)) / (yj - yi));
    }
    const [width, x] = widest(sides);
    if (width * height > best[0]) best = [width * height, x, y];
  }
  return best.slice(1);
}

const between = (a, b, share) => Math.min(Math.max(a + (b - a) * share, Math.min(a, b)), Math.max(a, b));

/** The place of the level on an edge, as the server rounds it. */
function placeOn(a, b, level) {
  const [high, low] = a[2] >= level ? [a, b] : [b, a];
  const fall = high[2] - low[2];
  const share = Number.isFinite(fall) ? (high[2] - level) / fall : (high[2] / 2 - level / 2) / (high[2] / 2 - low[2] / 2);
  return [between(high[0], low[0], share), between(high[1], low[1], share)];
}

const direction = ([x, y], [nx, ny]) => Math.atan2(ny - y, nx - x);
const turn = (from, to) => (to - from + 2 * Math.PI) % (2 * Math.PI);

/** The places at which a border crosses the level: {edge, start, point, border, along}. A line starts if the ground falls below the
 * level along the border. along: the direction of the edge from its higher end. */
function crossings(border, level) {
  const found = [];
  border.forEach((corner, edge) => {
    const next = border[(edge + 1) % border.length];
    const start = corner[2] >= level;
    if (start === next[2] >= level) return;
    const along = start ? direction(corner, next) : direction(next, corner);
    found.push({ edge, start, point: placeOn(corner, next, level), border, along });
  });
  return found;
}

/** Takes the crossing at which a line begins that leaves a place towards another one, or ends that comes from the other one. A place has
 * several if the border passes it more than once: the line is in the triangles beside its edge. */
function takeCrossing(all, place, beyond) {
  const way = direction(place, beyond);
  const aside = (c) => (c.start ? turn(c.along, way) : turn(way, c.along));
  const best = all.reduce((c, d) => (aside(d) < aside(c) ? d : c));
  all.splice(all.indexOf(best), 1);
  return best;
}

/** Joins open lines along the borders, which have the surface on their left: higher ground is on the left of both. */
function joinAlong(borders, lines, level) {
  const found = borders.map((border) => crossings(border, level));
  const free = new Map(); // crossings by kind and place
  const keyOf = (start, point) => `${start} ${point}`;
  for (const c of found.flat()) free.set(keyOf(c.start, c.point), [...(free.get(keyOf(c.start, c.point)) ?? []), c]);
  const lineAt = new Map(); // by the crossing where it starts
  const used = new Set();
  for (const ring of lines) {
    const from = takeCrossing(free.get(keyOf(true, ring[0])), ring[0], ring[1]);
    const to = takeCrossing(free.get(keyOf(false, ring.at(-1))), ring.at(-1), ring.at(-2));
    lineAt.set(from, { ring, to });
    used.add(from).add(to);
  }
  const following = new Map();
  const rings = [];
  found.forEach((all, k) => {
    const mine = all.filter((c) => used.has(c)); // lines of one place are left out
    mine.forEach((c, i) => following.set(c, mine[(i + 1) % mine.length]));
    const isHigh = ([, , z], i) => z >= level && borders[k].at(i - 1)[2] >= level;
    if (mine.length === 0 && borders[k].some(isHigh)) rings.push(borders[k].map(([x, y]) => [x, y]));
  });
  while (lineAt.size > 0) {
    const ring = [];
    for (let from = lineAt.keys().next().value; lineAt.has(from); ) {
      const line = lineAt.get(from);
      lineAt.delete(from);
      ring.push(...line.ring);
      from = following.get(line.to); // there the next line starts
      const { border } = line.to;
      for (let i = line.to.edge; i !== from.edge; i = (i + 1) % border.length) ring.push(border[(i + 1) % border.length].slice(0, 2));
    }
    rings.push(ring);
  }
  return rings;
}

/** The ground at or above a level as a GeoJSON MultiPolygon with the property `value`, as d3-contour's. Rings end at their first place,
 * outer ones counterclockwise. borders: closed, [[x, y, z], ...], with the surface on their left. */
function multiPolygon(contours, borders, level) {
  const ringsOf = (closed) => contours.filter((c) => c.closed === closed).map((c) => ringOf(c.coords));
  const rings = [...ringsOf(true), ...joinAlong(borders, ringsOf(false), level)];
  const polygons = [];
  const holes = [];
  for (const ring of rings) {
    const size = area(ring);
    if (size > 0) polygons.push({ size, rings: [ring] });
    else if (size < 0) holes.push({ size: -size, ring });
  }
  polygons.sort((a, b) => a.size - b.size); // a hole is in the smallest that contains it; what is in the hole is smaller
  for (const { size, ring } of holes) {
    const place = placeIn(ring);
    polygons.find((p) => p.size >= size * (1 - 1e-9) && contains(p.rings[0], place))?.rings.push(ring); // it may be all hole
  }
  for (const polygon of polygons) for (const ring of polygon.rings) ring.push([...ring[0]]);
  return { type: 'MultiPolygon', value: level, coordinates: polygons.map((p) => p.rings) };
}

/** The borders of the surface that triangles have whose corners have values: closed, [[x, y, z], ...], with the surface on their left.
 * triangles: ids, three each; ids: of the points, coords and z theirs. */
function bordersOf(triangles, ids, coords, z) {
  const rowOf = new Map(Array.from(ids, (id, row) => [id, row]));
  const edges = new Map(); // of the border so far, by both rows
  const key = (a, b) => a * ids.length + b;
  for (let i = 0; i < triangles.length; i += 3) {
    const rows = [0, 1, 2].map((k) => rowOf.get(triangles[i + k]));
    if (rows.some((row) => Number.isNaN(z[row]))) continue;
    rows.forEach((a, k) => {
      const b = rows[(k + 1) % 3];
      if (!edges.delete(key(b, a))) edges.set(key(a, b), [a, b]);
    });
  }
  const from = new Map();
  for (const [a, b] of edges.values()) from.set(a, [...(from.get(a) ?? []), b]);
  const corner = (row) => [coords[2 * row], coords[2 * row + 1], z[row]];
  /** Takes the next edge of the border that arrives at b from a: the first one clockwise from the way back. */
  const take = (a, b) => {
    const all = from.get(b);
    const aside = (c) => turn(direction(corner(b), corner(c)), direction(corner(b), corner(a)));
    const next = all.reduce((c, d) => (aside(d) < aside(c) ? d : c));
    all.splice(all.indexOf(next), 1);
    edges.delete(key(b, next));
    return next;
  };
  const borders = [];
  while (edges.size > 0) {
    const [first, second] = edges.values().next().value;
    const border = [];
    for (let [a, b] = [first, second]; edges.has(key(first, second)); [a, b] = [b, take(a, b)]) {
      border.push(corner(a));
    }
    borders.push(border);
  }
  return borders;
}

module.exports = { Cells, bandsOf, bordersOf, contourOf, levelWords, multiPolygon };
