// The commands as methods: here those that take or return more than words. Others are in constraints.js and table.js.
'use strict';

const { Constraints } = require('./constraints.js');
const { doubleBytes, numberOf, numbersOf, typed, words } = require('./framing.js');
const { column, pairs } = require('./points.js');
const { Cells, bandsOf, contourOf, levelWords, multiPolygon } = require('./surfaces.js');
const { box, checkField, checkSet, fieldList, flag, inside, list, option, real, whole, word } = require('./values.js');

const MOST_TRIES = 10; // until the set is not edited meanwhile

/** The words of options that several methods about surfaces have, and the other options. */
function surfaceWords({ maxEdge, inside: within, missing, ...options }) {
  return [[option('MAXEDGE', maxEdge, real), inside(within), option('MISSING', missing, word)], options];
}

/** Rows x, y and the values of fields. */
function withFields(coords, fields) {
  const columns = Object.values(fields).map(column);
  const width = 2 + columns.length;
  const n = coords.length / 2;
  const rows = new Float64Array(n * width);
  for (const { length } of columns) if (length !== n) throw new RangeError(`${length} values for ${n} points`);
  for (let i = 0; i < n; i++) {
    rows[width * i] = coords[2 * i];
    rows[width * i + 1] = coords[2 * i + 1];
    for (let k = 2; k < width; k++) rows[width * i + k] = columns[k - 2][i];
  }
  return rows;
}

/** {id, x, y}, and in replies to NEAREST the distance. */
function pointOf(row) {
  const [id, x, y, distance] = numbersOf(row);
  return distance === undefined ? { id, x, y } : { id, x, y, distance };
}

const firstOf = (row) => Number.parseInt(row, 10);

/** A row of ALPHA. */
function loopOf(row) {
  const [kind, , ...ids] = row.split(' ');
  return { hole: kind === 'hole', ids: Uint32Array.from(ids, Number) };
}

/** `inside` of several: only what is inside the border of this number, or, if it is true, inside any border. */
class Commands extends Constraints {
  async #ids(request, options) {
    return words(Uint32Array, (await this._ask(request, options)).data);
  }

  async #numbers(request, options, body) {
    return words(Float64Array, (await this._ask(request, options, body)).data);
  }

  /** Sends a command about places, with `rest` after their number. */
  async #places(Type, command, places, rest, { getX, getY, ...options } = {}) {
    const body = doubleBytes(pairs(places, getX, getY));
    return words(Type, (await this._ask([...command, body.length / 16, ...rest], options, body)).data);
  }

  // ---- sets ----

  async sets(options) {
    return (await this._ask(['SETS'], options)).rows.map((row) => row.split(' ', 1)[0]);
  }

  /** A temporary set is dropped when this client's connection ends. */
  async create(set, tolerance = 0, { temporary, ...options } = {}) {
    await this._ask(['CREATE', checkSet(set), 'TOL', real(tolerance), flag('TEMPORARY', temporary)], options);
  }

  // ---- points ----

  /** Adds points, all or none; resolves with the id of the first one. Until it resolves a Float64Array must not change. */
  async load(set, points, { getX, getY, fields = {}, ...options } = {}) {
    const coords = pairs(points, getX, getY);
    const names = Object.keys(fields).map(checkField).join(',');
    const body = doubleBytes(names === '' ? coords : withFields(coords, fields));
    const { keys } = await this._ask(['LOADB', checkSet(set), coords.length / 2, names === '' ? [] : ['FIELDS', names]], options, body);
    return Number(keys.first);
  }

  async add(set, x, y, options) {
    return Number((await this._ask(['ADD', checkSet(set), real(x), real(y)], options)).keys.first);
  }

  /** Moves a point, which keeps its id. */
  async move(set, id, x, y, options) {
    await this._ask(['MOVE', checkSet(set), whole(id), real(x), real(y)], options);
  }

  /** {id, x, y} of each id, in the order of the request. */
  async get(set, ids, options) {
    return (await this._ask(['GET', checkSet(set), list(ids, whole)], options)).rows.map(pointOf);
  }

  /** {ids: Uint32Array, coords: Float64Array of x, y}. With names of fields also `values`, a Float64Array for each, NaN if a
   * value is missing; all of it belongs to one state of the set. */
  async points(set, { fields = [], ...options } = {}) {
    const names = fieldList(fields);
    const { data } = await this._ask(['POINTS', checkSet(set), names.length > 0 ? ['FIELDS', names.join(',')] : [], 'BINARY'], options);
    const width = 20 + 8 * names.length;
    const n = data.length / width;
    const ids = new Uint32Array(n);
    const coords = new Float64Array(2 * n);
    const columns = names.map(() => new Float64Array(n));
    for (let i = 0; i < n; i++) {
      ids[i] = data.readUInt32LE(width * i);
      coords[2 * i] = data.readDoubleLE(width * i + 4);
      coords[2 * i + 1] = data.readDoubleLE(width * i + 12);
      for (let k = 0; k < names.length; k++) columns[k][i] = data.readDoubleLE(width * i + 20 + 8 * k);
    }
    if (names.length === 0) return { ids, coords };
    return { ids, coords, values: Object.fromEntries(names.map((name, k) => [name, columns[k]])) };
  }

  /** A Map from each alias to its representative. */
  async coincident(set, options) {
    return new Map((await this._ask(['COINCIDENT', checkSet(set)], options)).rows.map(numbersOf));
  }

  // ---- fields: values at points ----

  /** {name: {count, least, most}}; NaN if there are no values. */
  async fields(set, options) {
    const { rows } = await this._ask(['FIELDS', checkSet(set)], options);
    return Object.fromEntries(rows.map((row) => row.split(' ')).map(([name, ...facts]) => {
      const [count, least, most] = facts.map(numberOf);
      return [name, { count, least, most }];
    }));
  }

  /** The values of points, a Float64Array; NaN where one is missing. */
  async getField(set, field, ids, options) {
    const { rows } = await this._ask(['FGET', checkSet(set), checkField(field), list(ids, whole)], options);
    return Float64Array.from(rows, (row) => numbersOf(row)[1]);
  }

  /** The values of all points: {ids: Uint32Array, values: Float64Array}. */
  async field(set, field, options) {
    const { ids, values } = await this.points(set, { ...options, fields: [field] });
    return { ids, values: values[field] };
  }

  /** Sets the values of the ids first, first + 1, ...; NaN takes one away. */
  async setField(set, field, values, { first = 0, ...options } = {}) {
    const numbers = column(values);
    await this._ask(['FSETB', checkSet(set), checkField(field), whole(first), numbers.length], options, doubleBytes(numbers));
  }

  // ---- the triangulation ----

  /** Three ids a triangle, counterclockwise. With within, [x0, y0, x1, y1], only the triangles that meet this box. */
  async triangles(set, { clockwise, within, inside: border, ...options } = {}) {
    return this.#ids(['TRIANGLES', checkSet(set), option('WITHIN', within, box), inside(border), flag('CW', clockwise), 'BINARY'], options);
  }

  /** Two ids an edge. constrained: only those that are parts of constraints; inside: only those with a border's inside on a side. */
  async edges(set, { constrained, inside: border, ...options } = {}) {
    return this.#ids(['EDGES', checkSet(set), flag('CONSTRAINED', constrained), inside(border), 'BINARY'], options);
  }

  /** A Map from each point's id to its ring of neighbours, in the order of LISTS. within: [x0, y0, x1, y1], only the
   * points in this box. */
  async lists(set, { within, ...options } = {}) {
    const ids = await this.#ids(['LISTS', checkSet(set), option('WITHIN', within, box), 'BINARY'], options);
    const rings = new Map();
    for (let at = 0; at < ids.length; at += 2 + ids[at + 1]) rings.set(ids[at], ids.subarray(at + 2, at + 2 + ids[at + 1]));
    return rings;
  }

  async hull(set, { clockwise, ...options } = {}) {
    return Uint32Array.from((await this._ask(['HULL', checkSet(set), flag('CW', clockwise)], options)).rows, firstOf);
  }

  // ---- queries ----

  async locate(set, x, y, options) {
    const { keys, rows } = await this._ask(['LOCATE', checkSet(set), real(x), real(y)], options);
    return { where: keys.where, ids: rows.length > 0 ? numbersOf(rows[0]) : [] };
  }

  /** The k nearest points, nearest first, as {id, x, y, distance}. */
  async nearest(set, x, y, k = 1, options = undefined) {
    return (await this._ask(['NEAREST', checkSet(set), real(x), real(y), whole(k)], options)).rows.map(pointOf);
  }

  /** Three ids for each place: of the triangle that contains it, the first in triangles() if there are several; outside three
   * times NONE. */
  async locateAll(set, places, options) {
    return this.#places(Uint32Array, ['LOCATEB', checkSet(set)], places, [], options);
  }

  /** k ids for each place, nearest first; NONE where there are too few points. */
  async nearestAll(set, places, k = 1, options = undefined) {
    return this.#places(Uint32Array, ['NEARESTB', checkSet(set)], places, [whole(k)], options);
  }

  /** The ids in a box (x0, y0, x1, y1) or a disc (x, y, r). */
  async within(set, ...where) {
    return (await this._ask(['WITHIN', checkSet(set), list(where, real)])).rows.map(firstOf);
  }

  // ---- surfaces ----

  /** A Map from each id to its weight. */
  async weights(set, x, y, { method = 'linear', ...options } = {}) {
    return new Map((await this._ask(['WEIGHTS', checkSet(set), real(x), real(y), 'METHOD', word(method)], options)).rows.map(numbersOf));
  }

  /** The values at places, a Float64Array; NaN where there are none. missing: 'skip' leaves out points without a value. Of several fields,
   * an array of names, each place has their values. */
  async interpolate(set, field, places, { method, outside, ...others } = {}) {
    const [surface, options] = surfaceWords(others);
    const rest = [option('METHOD', method, word), ...surface, option('OUTSIDE', outside, word)];
    return this.#places(Float64Array, ['INTERPOLATEB', checkSet(set), fieldList(field).join(',')], places, rest, options);
  }

  /** By how much a field grows at places, for a unit of x and of y: two numbers for each place. */
  async gradient(set, field, places, others = {}) {
    const [surface, options] = surfaceWords(others);
    return this.#places(Float64Array, ['GRADIENTB', checkSet(set), fieldList(field).join(',')], places, surface, options);
  }

  /** The values at the centres of cells, row by row from the largest y, as d3-contour expects them. With the quantity 'slope' or
   * 'aspect' they are the slope or the direction downhill there, in degrees. */
  async raster(set, field, extent, columns, rows, { method, outside, clip, quantity, ...others } = {}) {
    const [surface, options] = surfaceWords(others);
    const where = [...box(extent), whole(columns), whole(rows)];
    const how = [option('METHOD', method, word), ...surface, option('OUTSIDE', outside, word), option('CLIP', clip, checkSet), option('AS', quantity, word)];
    return this.#numbers(['RASTER', checkSet(set), fieldList(field).join(','), where, ...how, 'BINARY'], options);
  }

  async #contour(set, field, { levels, every, base, ...others }, bands) {
    const [surface, options] = surfaceWords(others);
    return (await this._ask(['CONTOUR', checkSet(set), checkField(field), levelWords(levels, every, base), bands, ...surface], options)).rows;
  }

  /** Contour lines {level, closed, coords}, higher ground on the left: at `levels`, or at base and all multiples of `every` from it. */
  async contourLines(set, field, options = {}) {
    return (await this.#contour(set, field, options, [])).map(contourOf);
  }

  /** The bands between neighbouring levels as GeoJSON Polygons with the properties low and high. The lowest level may be -Infinity and the
   * highest Infinity; `every` takes as many levels as cover the surface. */
  async bands(set, field, options = {}) {
    return bandsOf(await this.#contour(set, field, options, ['BANDS']));
  }

  /** For each level the ground at or above it: a GeoJSON MultiPolygon with the property value, as d3-contour and d3-tricontour. All
   * levels are of one state of the set: what was edited meanwhile is asked for again. */
  async contours(set, field, levels, options) {
    const wanted = list(levels, real);
    const stat = () => this._ask(['STAT', checkSet(set)], options);
    const above = async (level) => multiPolygon(await this.bands(set, field, { ...options, levels: [level, Infinity] }), level);
    for (let i = 0; i < MOST_TRIES; i++) {
      const [before, ...polygons] = await Promise.all([stat(), ...wanted.map(above), stat()]);
      if (polygons.pop().keys.version === before.keys.version) return polygons;
    }
    throw new Error(`${set} is edited while it is read; try again`);
  }

  /** The surface along straight pieces between places: distance, x, y and value of the places and of every edge and corner of the
   * triangulation between them, four numbers each. */
  async profile(set, field, places, { getX, getY, ...others } = {}) {
    const [surface, options] = surfaceWords(others);
    return this.#numbers(['PROFILE', checkSet(set), checkField(field), [...pairs(places, getX, getY)], ...surface, 'BINARY'], options);
  }

  /** {above, below, area}: the volumes between the surface of a field and a level, or the surface of another field, `minus`; and the
   * area of the triangles whose corners have values. Only what is inside borders, and in a box. */
  async volume(set, field, { level, minus, inside: border, missing, box: extent, ...options } = {}) {
    const above = [option('LEVEL', level, real), option('MINUS', minus, checkField)];
    const where = [inside(border), option('MISSING', missing, word), option('BOX', extent, box)];
    const { keys } = await this._ask(['VOLUME', checkSet(set), checkField(field), ...above, ...where], options);
    return Object.fromEntries(Object.entries(keys).map(([key, text]) => [key, numberOf(text)]));
  }

  /** Voronoi cells, with cellPolygon(id) and cellPolygons() as d3-delaunay's; box: [x0, y0, x1, y1]. */
  async voronoi(set, { ids = [], box: extent, ...options } = {}) {
    const { data, keys } = await this._ask(['VORONOI', checkSet(set), list(ids, whole), option('BOX', extent, box), 'BINARY'], options);
    return new Cells(data, keys.box.split(',').map(Number));
  }

  /** {ids: Uint32Array, areas: Float64Array} of the cells of voronoi(). */
  async areas(set, { box: extent, ...options } = {}) {
    const { data } = await this._ask(['AREAS', checkSet(set), option('BOX', extent, box), 'BINARY'], options);
    const n = data.length / 12;
    return {
      ids: Uint32Array.from({ length: n }, (_, i) => data.readUInt32LE(12 * i)),
      areas: Float64Array.from({ length: n }, (_, i) => data.readDoubleLE(12 * i + 4)),
    };
  }

  /** The boundary of the alpha shape, loops {hole, ids} with the shape on their left. */
  async alpha(set, radius, options) {
    return (await this._ask(['ALPHA', checkSet(set), real(radius)], options)).rows.map(loopOf);
  }

  /** {radius, loops}: the least radius that gives one piece with all points, and the boundary of its alpha shape. */
  async alphaAuto(set, options) {
    const { rows, keys } = await this._ask(['ALPHA', checkSet(set), 'AUTO'], options);
    return { radius: numberOf(keys.radius), loops: rows.map(loopOf) };
  }

  /** Makes the new set `into` of few points of the set, at most `points`: the linear surface of the field through them is within the error
   * of every point. The field `ids` of the new set gets their ids in the set. Returns {points, constraints, error}. */
  async simplify(set, field, error, into, { points, ids, ...options } = {}) {
    const how = [real(error), option('POINTS', points, whole), option('IDS', ids, checkField), 'INTO', checkSet(into)];
    const { keys } = await this._ask(['SIMPLIFY', checkSet(set), checkField(field), 'ERROR', ...how], options);
    return { points: Number(keys.points), constraints: Number(keys.constraints), error: numberOf(keys.error) };
  }

  // ---- the server ----

  async info(options) {
    const { rows } = await this._ask(['INFO'], options);
    return Object.fromEntries(rows.map((row) => [row.slice(0, row.indexOf(':')), typed(row.slice(row.indexOf(':') + 1))]));
  }
}

module.exports = { Commands };
