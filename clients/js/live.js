// A set of points in process that stays triangulated while points come, go and move. Answers are typed arrays.
'use strict';

const { NOPOINT, RANGE, addPoints, findCore, refusal, withPlaces } = require('./lib/core.js');
const { column, pairs } = require('./lib/points.js');
const { box, isTrue, list, only, real } = require('./lib/values.js');

const TABLES = { points: 0, coincident: 1, edges: 4, hull: 5 }; // enum dt_table
const METHODS = ['linear', 'natural', 'laplace', 'nearest', 'smooth']; // enum dt_interpolation
const NONE = 0xffffffff; // in answers, for a missing id

// The memory of sets that nobody refers to any more.
const forgotten = new FinalizationRegistry(({ core, set }) => core.freeSet(set));

function methodNumber(method) {
  const number = METHODS.indexOf(method);
  if (number < 0) throw new TypeError(`no such method: ${method}; there are ${METHODS.join(', ')}`);
  return number;
}

/** An id as the core takes it. */
function idOf(id) {
  if (!(Number.isInteger(id) && id >= 0 && id < 2 ** 32)) throw refusal(NOPOINT);
  return id;
}

/** Values of points, which are finite or NaN. */
function valuesOf(values) {
  const known = column(values);
  if (known.some((v) => Math.abs(v) === Infinity)) throw new RangeError('values are finite or NaN');
  return known;
}

function isClockwise({ clockwise, ...others } = {}) {
  only(others);
  return isTrue('clockwise', clockwise);
}

class LiveSet {
  #core = findCore();
  #set; // null: freed

  /** points: flat (x, y, x, y ...), or pairs, or anything with getX and getY. */
  static from(points, { tolerance, ...options } = {}) {
    const live = new LiveSet({ tolerance });
    live.add(points, options);
    return live;
  }

  /** Points within the tolerance of an earlier one coincide with it. */
  constructor({ tolerance = 0, ...others } = {}) {
    only(others);
    if (!(real(tolerance) === 0 || (tolerance >= 2 ** -142 && tolerance <= 2 ** 201))) throw refusal(RANGE);
    this.#set = this.#core.newSet(tolerance);
    forgotten.register(this, { core: this.#core, set: this.#set }, this);
    this.#core.call('set_triangulate', this.#set);
  }

  /** Gives the memory back now instead of when the object is collected. */
  free() {
    if (this.#set !== null) this.#core.freeSet(this.#set);
    forgotten.unregister(this);
    this.#set = null;
  }

  get #mine() {
    if (this.#set === null) throw new TypeError('this set has been freed');
    return this.#set;
  }

  #counts() {
    this.#core.call('set_counts', this.#mine);
    return [0, 1, 2].map((i) => this.#core.number(i));
  }

  /** The number of points. */
  get size() {
    return this.#counts()[0];
  }

  /** The id that the next point will get. */
  get nextId() {
    return this.#counts()[2];
  }

  // ---- edits ----

  /** Adds points, all or none; returns the id of the first one, the others follow. */
  add(points, { getX, getY, values, ...others } = {}) {
    only(others);
    const flat = pairs(points, getX, getY);
    const known = values === undefined ? null : valuesOf(values);
    if (known !== null && 2 * known.length !== flat.length) throw new RangeError(`${known.length} values for ${flat.length / 2} points`);
    addPoints(this.#core, this.#mine, flat);
    const first = this.#core.number(0);
    if (known !== null) this.setValues(known, { first });
    return first;
  }

  /** Deletes the points with these ids, all or none; returns how many. */
  delete(ids) {
    const which = Uint32Array.from(list(ids, idOf));
    this.#core.callWith('set_delete', this.#mine, Uint32Array, which, which.length);
    return this.#core.number(0);
  }

  /** Moves a point, which keeps its id. */
  move(id, x, y) {
    withPlaces([real(x), real(y)], () => this.#core.call('set_move', this.#mine, idOf(id), x, y));
  }

  // ---- constraints ----

  /** Pairs of ids, flat or not, become edges that stay, or chains of edges through the points on them, all or none. Returns the number
   * of new ones. border: they are parts of the border of inside(). */
  constrain(ids, options = {}) {
    this.#pairs('set_constrain', ids, options);
    return this.#core.number(0);
  }

  /** The opposite of constrain(), all or none. */
  release(ids, options = {}) {
    this.#pairs('set_release', ids, options);
  }

  #pairs(name, ids, { border, ...others }) {
    only(others);
    const ends = Uint32Array.from(pairs(ids), idOf);
    this.#core.call('set_triangulate', this.#mine);
    this.#core.callWith(name, this.#mine, Uint32Array, ends, ends.length / 2, isTrue('border', border));
  }

  /** Pairs: the edges that are parts of constraints. */
  constrainedEdges() {
    this.#core.call('set_constrained', this.#mine);
    return this.#core.array(Uint32Array, 0);
  }

  /** The triangles inside the border, three ids each: from there every way out crosses it an odd number of times. */
  inside(options) {
    this.#core.call('set_triangulate', this.#mine);
    this.#core.call('set_inside', this.#set, isClockwise(options));
    return this.#core.array(Uint32Array, 0);
  }

  // ---- the triangulation ----

  /** [x, y] of a point. */
  point(id) {
    this.#core.call('set_get', this.#mine, idOf(id));
    return [...this.#core.doubles(2)];
  }

  #table(name, options) {
    this.#core.call('set_triangulate', this.#mine);
    this.#core.call('set_table', this.#set, TABLES[name], isClockwise(options));
    return this.#core.array(Uint32Array, 0);
  }

  /** All ids, ascending. */
  ids() {
    return this.#table('points');
  }

  /** Pairs: a point that coincides with another one, and that one. */
  coincident() {
    return this.#table('coincident');
  }

  edges() {
    return this.#table('edges');
  }

  hull(options) {
    return this.#table('hull', options);
  }

  /** {triangles, halfedges} as Delaunator has them; counterclockwise in a plane whose y axis points up, unless clockwise. */
  triangulation(options) {
    this.#core.call('set_triangulate', this.#mine);
    this.#core.call('set_triangles', this.#set, isClockwise(options));
    return { triangles: this.#core.array(Uint32Array, 0), halfedges: this.#core.array(Int32Array, 1) };
  }

  /** In the order of LISTS. */
  neighbors(id, options) {
    this.#core.call('set_triangulate', this.#mine);
    this.#core.call('set_ring', this.#set, idOf(id), isClockwise(options));
    return this.#core.array(Uint32Array, 0);
  }

  // ---- questions about places, as points are given ----

  #ask(name, places, ...rest) {
    const flat = pairs(places);
    withPlaces(flat, () => this.#core.callWith(name, this.#mine, Float64Array, flat, flat.length / 2, ...rest));
  }

  /** Three ids for each place: the triangle that contains it; NONE: there is none. */
  locate(places) {
    this.#ask('set_locate', places);
    return this.#core.array(Uint32Array, 0);
  }

  /** k ids for each place, the nearest first; NONE behind the last point. */
  nearest(places, k = 1) {
    if (!(Number.isInteger(k) && k >= 1 && k < 2 ** 32)) throw new RangeError('k is a number of points from 1 on');
    this.#ask('set_nearest', places, k);
    return this.#core.array(Uint32Array, 0);
  }

  // ---- surfaces ----

  /** Sets the values of the points with the ids from `first` on; NaN: it has none. */
  setValues(values, { first = 0, ...others } = {}) {
    only(others);
    const known = valuesOf(values);
    this.#core.callWith('set_values', this.#mine, Float64Array, known, known.length, idOf(first));
  }

  /** The values at places; NaN where there is no surface. */
  interpolate(places, { method = 'linear', maxEdge = Infinity, ...others } = {}) {
    only(others);
    this.#ask('set_interpolate', places, methodNumber(method), real(maxEdge));
    return this.#core.array(Float64Array, 0);
  }

  /** The lines at levels: line i is at levels[i], has the places offsets[i] .. offsets[i + 1] of coords, and is closed if closed[i]
   * is 1. Higher ground is on the left; a closed line does not repeat its first place. */
  contours(levels, { maxEdge = Infinity, ...others } = {}) {
    only(others);
    const sorted = Float64Array.from(new Set(list(levels, real))).sort();
    if (!sorted.every(Number.isFinite)) throw new RangeError('levels are finite numbers');
    this.#core.call('set_triangulate', this.#mine);
    this.#core.callWith('set_contours', this.#set, Float64Array, sorted, sorted.length, real(maxEdge));
    const [Types, core] = [[Float64Array, Uint32Array, Float64Array, Uint32Array], this.#core];
    const [of, offsets, coords, closed] = Types.map((Type, i) => core.array(Type, i));
    return { levels: of, offsets, coords, closed };
  }

  /** The Voronoi cells, clipped to a box: the cell of point id has the corners offsets[id] .. offsets[id + 1] of coords, counterclockwise
   * if y points up. */
  cells(bounds) {
    this.#core.call('set_triangulate', this.#mine);
    this.#core.call('set_cells', this.#set, ...box(bounds));
    return { offsets: this.#core.array(Uint32Array, 0), coords: this.#core.array(Float64Array, 1) };
  }
}

module.exports = { LiveSet, NONE };
