// The page's copy of a set, or of a part of it: points by number, and triangles. An event changes the triangles at a few points. In the
// copy of a whole set the number of a point is its id; a part numbers its points as they come.
import { emptyBox, extend } from './box.js';
import { eachTriangle } from './rings.js';

/** The triangle with its smallest corner first, as text: equal triangles have equal keys. */
function keyOf(a, b, c) {
  if (a < b && a < c) return `${a} ${b} ${c}`;
  return b < c ? `${b} ${c} ${a}` : `${c} ${a} ${b}`;
}

const NO_RING = { inner: false, ring: [] };

/** An array of the same type with the same numbers, and room for more; the array itself if it is long enough. */
export function grown(array, length) {
  if (length <= array.length) return array;
  const larger = new array.constructor(Math.max(length, 2 * array.length, 1024));
  larger.set(array);
  return larger;
}

export class Mesh {
  /** Coordinates x, y by number; NaN where there is no point. */
  xy = new Float64Array(0);
  /** Values of the field that is shown, by number. */
  values = new Float32Array(0);
  /** Three corners of each triangle, and room for more. */
  corners = new Uint32Array(0);
  points = 0;
  triangles = 0;
  ids = 0; // numbers that have been given are smaller
  version = 0;
  #numbers = null; // id -> number, of a part; and the other way round:
  #idOf = [];

  /** From the binary replies to POINTS (with a field or not) and TRIANGLES. The set may be edited between the two: an event with all
   * changes since a version before both makes the copy whole. So a corner may have no place yet. */
  load(points, triangles, withValue) {
    const size = withValue ? 28 : 20;
    const view = new DataView(points.buffer);
    this.#numbers = null;
    const corners = new Uint32Array(triangles.buffer);
    this.points = points.length / size;
    this.ids = this.points === 0 ? 0 : view.getUint32(points.length - size, true) + 1;
    for (let k = 0; k < corners.length; k++) if (corners[k] >= this.ids) this.ids = corners[k] + 1;
    this.xy = new Float64Array(2 * this.ids).fill(NaN);
    this.values = new Float32Array(this.ids).fill(NaN);
    for (let at = 0; at < points.length; at += size) {
      const id = view.getUint32(at, true);
      this.xy[2 * id] = view.getFloat64(at + 4, true);
      this.xy[2 * id + 1] = view.getFloat64(at + 12, true);
      if (withValue) this.values[id] = view.getFloat64(at + 20, true);
    }
    this.#loadCorners(corners);
  }

  /** From an event that has everything, a Gathered; isPart: of a part of the set. */
  loadEvent(gathered, version, isPart = false) {
    this.#numbers = isPart ? new Map() : null;
    this.#idOf = [];
    const { points, rings } = this.#numbered(gathered);
    this.#loadPoints(points);
    const corners = [];
    eachTriangle(rings, (n) => rings.get(n), () => false, (...abc) => abc.every((n) => this.hasPoint(n)) && corners.push(...abc));
    this.#loadCorners(Uint32Array.from(corners));
    this.version = version;
  }

  /** A sample of a set: triangles, three ids each, and Map id -> [x, y, value] of their corners. */
  loadSample(triangles, places, version) {
    this.#numbers = new Map();
    this.#idOf = [];
    const points = new Map();
    for (const [id, place] of places) points.set(this.#number(id), place);
    this.#loadPoints(points);
    this.#loadCorners(Uint32Array.from(triangles, (id) => this.numberOf(id)));
    this.version = version;
  }

  #loadPoints(points) {
    this.points = points.size;
    this.ids = 0;
    for (const n of points.keys()) this.ids = Math.max(this.ids, n + 1);
    this.xy = new Float64Array(2 * this.ids).fill(NaN);
    this.values = new Float32Array(this.ids).fill(NaN);
    for (const [n, [x, y, value]] of points) {
      this.xy[2 * n] = x;
      this.xy[2 * n + 1] = y;
      this.values[n] = value;
    }
  }

  #loadCorners(corners) {
    this.corners = corners;
    this.triangles = corners.length / 3;
  }

  /** The number of an id; undefined if a part has none for it. */
  numberOf(id) {
    return this.#numbers === null ? id : this.#numbers.get(id);
  }

  idOf(number) {
    return this.#numbers === null ? number : this.#idOf[number];
  }

  /** The number of an id, a new one if need be. */
  #number(id) {
    if (this.#numbers === null) return id;
    const known = this.#numbers.get(id);
    if (known !== undefined) return known;
    this.#numbers.set(id, this.#idOf.length);
    return this.#idOf.push(id) - 1;
  }

  /** A Gathered with numbers for ids. */
  #numbered({ points, rings, gone }) {
    if (this.#numbers === null) return { points, rings, gone };
    const number = (id) => this.#number(id);
    return {
      points: new Map([...points].map(([id, place]) => [number(id), place])),
      rings: new Map([...rings].map(([id, { inner, ring }]) => [number(id), { inner, ring: ring.map(number) }])),
      gone: new Set([...gone].map(number)),
    };
  }

  hasPoint(id) {
    return id < this.ids && !Number.isNaN(this.xy[2 * id]);
  }

  /** Counts the points in a box [x0, y0, x1, y1]. */
  countIn([x0, y0, x1, y1]) {
    const { xy } = this;
    let n = 0;
    for (let k = 0; k < 2 * this.ids; k += 2) if (xy[k] >= x0 && xy[k] <= x1 && xy[k + 1] >= y0 && xy[k + 1] <= y1) n++;
    return n;
  }

  /** The box around the points; the unit square if there are none. */
  box() {
    const found = emptyBox();
    for (let k = 0; k < 2 * this.ids; k += 2) extend(found, this.xy[k], this.xy[k + 1]);
    return found[0] <= found[2] ? found : [0, 0, 1, 1];
  }

  /** Calls found(a, b, c) with the corners of each triangle whose box meets a box. Cost: some milliseconds for 1e5 triangles. */
  eachTriangleIn([x0, y0, x1, y1], found) {
    const { corners, triangles, xy } = this;
    for (let k = 0; k < 3 * triangles; k += 3) {
      const a = corners[k], b = corners[k + 1], c = corners[k + 2];
      const ax = xy[2 * a], bx = xy[2 * b], cx = xy[2 * c];
      if ((ax < x0 && bx < x0 && cx < x0) || (ax > x1 && bx > x1 && cx > x1)) continue;
      const ay = xy[2 * a + 1], by = xy[2 * b + 1], cy = xy[2 * c + 1];
      if ((ay < y0 && by < y0 && cy < y0) || (ay > y1 && by > y1 && cy > y1)) continue;
      found(a, b, c);
    }
  }

  /** Applies an event, a Gathered. Returns a box [x0, y0, x1, y1] around all triangles that were removed or added and all points that
   * changed; null if nothing is to be drawn. Cost: linear in all triangles, a millisecond for 1e5. */
  apply(gathered, version) {
    const { points, rings, gone } = this.#numbered(gathered);
    const ids = new Set([...points.keys(), ...rings.keys(), ...gone]);
    const box = emptyBox();
    const around = (id) => extend(box, this.xy[2 * id], this.xy[2 * id + 1]);
    const before = this.#removeAt(ids);
    for (const corners of before.values()) corners.forEach(around);
    for (const id of gone) this.#forget(id, around);
    for (const [id, place] of points) this.#place(id, place, around);
    const ringOf = (id) => (ids.has(id) && !rings.has(id) ? NO_RING : rings.get(id));
    const was = (...corners) => before.has(keyOf(...corners));
    eachTriangle(rings, ringOf, was, (...corners) => {
      if (!corners.every((id) => this.hasPoint(id))) return;
      this.#add(corners);
      corners.forEach(around); // all triangles at these points are drawn again, at the new places of their corners
    });
    this.version = version;
    return box[0] <= box[2] ? box : null;
  }

  /** Removes the triangles at these points. Returns them, key -> corners. */
  #removeAt(ids) {
    const isAt = new Uint8Array(this.ids);
    for (const id of ids) isAt[id] = 1;
    const { corners } = this;
    const removed = new Map();
    let kept = 0;
    for (let k = 0; k < 3 * this.triangles; k += 3) {
      const a = corners[k], b = corners[k + 1], c = corners[k + 2];
      if (isAt[a] || isAt[b] || isAt[c]) {
        removed.set(keyOf(a, b, c), [a, b, c]);
      } else {
        corners[kept++] = a;
        corners[kept++] = b;
        corners[kept++] = c;
      }
    }
    this.triangles = kept / 3;
    return removed;
  }

  #add(corners) {
    this.corners = grown(this.corners, 3 * (this.triangles + 1));
    this.corners.set(corners, 3 * this.triangles++);
  }

  #forget(id, around) {
    if (!this.hasPoint(id)) return;
    around(id);
    this.xy[2 * id] = this.xy[2 * id + 1] = NaN;
    this.points--;
  }

  #place(id, [x, y, value], around) {
    this.xy = grown(this.xy, 2 * (id + 1));
    this.values = grown(this.values, id + 1);
    for (; this.ids <= id; this.ids++) this.xy[2 * this.ids] = this.xy[2 * this.ids + 1] = this.values[this.ids] = NaN;
    if (this.hasPoint(id)) around(id);
    else this.points++;
    this.xy[2 * id] = x;
    this.xy[2 * id + 1] = y;
    this.values[id] = value;
    around(id);
  }
}
