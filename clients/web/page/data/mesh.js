// The page's copy of a set, or of a part of it: points by number, and triangles in numbered slots, as the graphics memory holds them. An
// event changes the slots of a few triangles, so that little has to be sent to the graphics memory. In the copy of a whole set the
// number of a point is its id; a part numbers its points as they come.
import { emptyBox, extend } from './box.js';
import { eachTriangle } from './rings.js';

/** The triangle with its smallest corner first, as text: equal triangles have equal keys. */
function keyOf(a, b, c) {
  if (a < b && a < c) return `${a} ${b} ${c}`;
  return b < c ? `${b} ${c} ${a}` : `${c} ${a} ${b}`;
}

const NO_RING = { inner: false, ring: [] };

function grown(array, length) {
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
  /** Three corners of each slot; three times 0 if there is no triangle in it. */
  corners = new Uint32Array(0);
  slots = 0;
  points = 0;
  triangles = 0;
  ids = 0; // numbers that have been given are smaller
  version = 0;
  #numbers = null; // id -> number, of a part; and the other way round:
  #idOf = [];
  #free = []; // slots without a triangle
  #starts = null; // slots of a point's triangles when they were loaded: #incident[#starts[id] .. #starts[id + 1]]
  #incident = null;
  #changed = new Map(); // number -> its slots, of points whose triangles have changed since

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
    this.slots = corners.length / 3;
    this.triangles = this.slots;
    this.#forgetSlots();
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

  /** The slots have other triangles than before. */
  #forgetSlots() {
    this.#free = [];
    this.#starts = null;
    this.#changed.clear();
  }

  /** Takes the corners of the same triangles in another order of slots. */
  reorder(corners) {
    this.corners = corners;
    this.slots = corners.length / 3;
    this.#forgetSlots();
  }

  #index() {
    const starts = new Uint32Array(this.ids + 1);
    for (let k = 0; k < 3 * this.slots; k++) if (this.#isUsed((k / 3) | 0)) starts[this.corners[k] + 1]++;
    for (let id = 0; id < this.ids; id++) starts[id + 1] += starts[id];
    const next = starts.slice(0, this.ids);
    const incident = new Uint32Array(starts[this.ids]);
    for (let k = 0; k < 3 * this.slots; k++) if (this.#isUsed((k / 3) | 0)) incident[next[this.corners[k]]++] = (k / 3) | 0;
    this.#starts = starts;
    this.#incident = incident;
  }

  #isUsed(slot) {
    return this.corners[3 * slot] !== this.corners[3 * slot + 1];
  }

  /** The slots of the triangles at a point. */
  slotsOf(id) {
    if (this.#starts === null) this.#index();
    const changed = this.#changed.get(id);
    if (changed !== undefined) return changed;
    return id + 1 < this.#starts.length ? this.#incident.subarray(this.#starts[id], this.#starts[id + 1]) : [];
  }

  /** Applies an event, a Gathered. Returns {points, slots, box}: points and slots that have changed, and a box [x0, y0, x1, y1]. The box
   * is around all triangles that were removed or added and all points that changed; null if nothing is to be drawn. */
  apply(gathered, version) {
    const { points, rings, gone } = this.#numbered(gathered);
    const ids = new Set([...points.keys(), ...rings.keys(), ...gone]);
    const box = emptyBox();
    const around = (id) => extend(box, this.xy[2 * id], this.xy[2 * id + 1]);
    const before = this.#trianglesAt(ids);
    for (const { corners } of before.values()) corners.forEach(around);
    for (const id of gone) this.#forget(id, around);
    for (const [id, place] of points) this.#place(id, place, around);
    const after = new Map();
    const ringOf = (id) => (ids.has(id) && !rings.has(id) ? NO_RING : rings.get(id));
    const was = (...corners) => before.has(keyOf(...corners));
    eachTriangle(rings, ringOf, was, (...corners) => corners.every((n) => this.hasPoint(n)) && after.set(keyOf(...corners), corners));
    // All triangles at these points are drawn again, at the new places of their corners.
    for (const corners of after.values()) corners.forEach(around);
    const slots = this.#replace(before, after, ids);
    this.version = version;
    return { points: [...points.keys()], slots, box: box[0] <= box[2] ? box : null };
  }

  /** key -> {slot, corners} of the triangles at these points. */
  #trianglesAt(ids) {
    const found = new Map();
    for (const id of ids) {
      for (const slot of this.slotsOf(id)) {
        const corners = [...this.corners.subarray(3 * slot, 3 * slot + 3)];
        found.set(keyOf(...corners), { slot, corners });
      }
    }
    return found;
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

  /** Gives the slots of triangles that are gone to new ones. */
  #replace(before, after, ids) {
    const changed = [];
    const slotOf = new Map();
    const vacant = [];
    for (const [key, { slot }] of before) {
      if (after.has(key)) slotOf.set(key, slot);
      else vacant.push(slot);
    }
    for (const [key, corners] of after) {
      if (slotOf.has(key)) continue;
      const slot = vacant.pop() ?? this.#free.pop() ?? this.slots++;
      this.corners = grown(this.corners, 3 * (slot + 1));
      this.corners.set(corners, 3 * slot);
      slotOf.set(key, slot);
      changed.push(slot);
    }
    for (const slot of vacant) {
      this.corners.fill(0, 3 * slot, 3 * slot + 3);
      changed.push(slot);
    }
    this.#free.push(...vacant);
    this.triangles += after.size - before.size;
    for (const id of ids) this.#changed.set(id, []);
    for (const [key, corners] of after) {
      for (const id of corners) if (ids.has(id)) this.#changed.get(id).push(slotOf.get(key));
    }
    return changed;
  }
}
