// A client: commands as methods. It reconnects after its connection has been lost.
'use strict';

const { chooseAddress } = require('./address.js');
const { Connection } = require('./connection.js');
const { Constraints } = require('./constraints.js');
const { Disconnected } = require('./errors.js');
const { checkField, checkSet, doubleBytes, option, pointBytes, typed, words } = require('./framing.js');
const { flatten } = require('./points.js');
const { Cells, bandsOf, contourOf, levelWords, multiPolygon } = require('./surfaces.js');

const CONNECT_MS = 10000;
const MOST_TRIES = 10; // until the set is not edited meanwhile

const insideWords = (inside) => option('INSIDE', inside).map((word) => ` ${word}`).join('');
const missingWords = (missing) => (missing ? ` MISSING ${missing}` : '');
const fieldWords = (field) => (typeof field === 'string' ? checkField(field) : Array.from(field, checkField).join(','));
const methodWords = ({ method, maxEdge, inside, outside, missing, clip }) =>
  `${method ? ` METHOD ${method}` : ''}${maxEdge === undefined ? '' : ` MAXEDGE ${maxEdge}`}${insideWords(inside)}${missingWords(missing)}` +
  `${outside ? ` OUTSIDE ${outside}` : ''}${clip ? ` CLIP ${checkSet(clip)}` : ''}`;
const boxWords = (box, word = 'BOX') => (box ? ` ${word} ${[...box].join(' ')}` : '');

/** Rows x, y and the values of fields. */
function withFields(coords, fields) {
  const columns = Object.values(fields);
  const width = 2 + columns.length;
  const n = coords.length / 2;
  const rows = new Float64Array(n * width);
  for (const column of columns) if (column.length !== n) throw new RangeError(`${column.length} values for ${n} points`);
  for (let i = 0; i < n; i++) {
    rows[width * i] = coords[2 * i];
    rows[width * i + 1] = coords[2 * i + 1];
    for (let k = 2; k < width; k++) rows[width * i + k] = columns[k - 2][i];
  }
  return rows;
}

const numbersOf = (row) => row.split(' ').map(Number);

/** {id, x, y}, and in replies to NEAREST the distance. */
function pointOf(row) {
  const [id, x, y, distance] = numbersOf(row);
  return distance === undefined ? { id, x, y } : { id, x, y, distance };
}

/** A row of ALPHA. */
function loopOf(row) {
  const [kind, , ...ids] = row.split(' ');
  return { hole: kind === 'hole', ids: Uint32Array.from(ids, Number) };
}

/** Made by connect(). Requests may be made without waiting for one another. The methods here take or return more than words. */
class Client extends Constraints {
  #address;
  #options;
  #connection = null;
  #opening = null;
  #queued = []; // requests made while it connects
  #closed = false;
  #mirrors = new Set();

  constructor(address, { timeout = 0, connectTimeout = CONNECT_MS, unref = false } = {}) {
    super();
    this.#address = address;
    this.#options = { timeout, connectTimeout, unref };
  }

  /** Rejects pending requests and all later ones, and ends the mirrors. */
  close() {
    const error = new Disconnected('closed', 'CLOSED');
    this.#closed = true;
    this.#connection?.fail(error);
    for (const request of this.#queued.splice(0)) request.reject(error);
    for (const mirror of this.#mirrors) mirror.close();
  }

  /** Connects if there is no connection; concurrent calls wait for the same one. */
  open() {
    this.#opening ??= this.#open().finally(() => {
      this.#opening = null;
    });
    return this.#opening;
  }

  /** A new connection that has shown its token. */
  async #connect(options) {
    const { connectTimeout, unref } = this.#options;
    const socket = await this.#address.open(connectTimeout);
    const connection = new Connection(socket, { unref, ...options });
    if (this.#closed) connection.fail(new Disconnected('closed', 'CLOSED'));
    await this.#introduce(connection, connectTimeout);
    return connection;
  }

  async #open() {
    try {
      const connection = await this.#connect();
      this.#connection = connection;
      for (const request of this.#queued.splice(0)) connection.send(request);
    } catch (error) {
      for (const request of this.#queued.splice(0)) request.reject(error);
      throw error;
    }
  }

  /** Sends the token. A connection that is not used is closed. */
  async #introduce(connection, timeout) {
    if (!this.#address.token) return;
    try {
      await new Promise((resolve, reject) => {
        connection.send({ line: `AUTH ${this.#address.token}`, timeout, resolve, reject });
      });
    } catch (error) {
      connection.fail(error);
      throw error;
    }
  }

  /** Sends a request, and bytes that belong to it; resolves with {keys, rows, data}. timeout: in ms, 0 for none. */
  request(line, { body, progress, timeout = this.#options.timeout } = {}) {
    if (/[\r\n]/.test(line)) return Promise.reject(new TypeError('a line break in a request'));
    if (this.#closed) return Promise.reject(new Disconnected('closed', 'CLOSED'));
    return new Promise((resolve, reject) => {
      const request = { line, body, progress, timeout, resolve, reject };
      if (this.#opening === null && this.#connection !== null && !this.#connection.failed) {
        this.#connection.send(request);
        return;
      }
      this.#queued.push(request);
      this.open().catch(() => {}); // all that are queued are rejected
    });
  }

  async #ids(line) {
    return words(Uint32Array, (await this.request(line)).data);
  }

  async #points(line) {
    return (await this.request(line)).rows.map(pointOf);
  }

  // ---- sets ----

  async sets() {
    return (await this.request('SETS')).rows.map((row) => row.split(' ', 1)[0]);
  }

  /** A temporary set is dropped when this client's connection ends. */
  async create(set, tolerance = 0, { temporary = false } = {}) {
    await this.request(`CREATE ${checkSet(set)} TOL ${tolerance}${temporary ? ' TEMPORARY' : ''}`);
  }

  // ---- points ----

  /** Adds points, all or none; resolves with the id of the first one. Until it resolves a Float64Array must not change. */
  async load(set, points, { getX, getY, fields, timeout } = {}) {
    const coords = flatten(points, getX, getY);
    if (fields && Object.keys(fields).length > 0) return this.#loadFields(set, coords, fields, timeout);
    const body = pointBytes(coords);
    return Number((await this.request(`LOADB ${checkSet(set)} ${body.length / 16}`, { body, timeout })).keys.first);
  }

  async #loadFields(set, coords, fields, timeout) {
    const names = Object.keys(fields).map(checkField).join(',');
    const line = `LOADB ${checkSet(set)} ${coords.length / 2} FIELDS ${names}`;
    return Number((await this.request(line, { body: doubleBytes(withFields(coords, fields)), timeout })).keys.first);
  }

  async add(set, x, y) {
    return Number((await this.request(`ADD ${checkSet(set)} ${x} ${y}`)).keys.first);
  }

  /** Moves a point, which keeps its id. */
  async move(set, id, x, y, options) {
    await this.request(`MOVE ${checkSet(set)} ${Number(id)} ${Number(x)} ${Number(y)}`, options);
  }

  /** {id, x, y} of each id, in the order of the request. */
  async get(set, ids) {
    return this.#points(`GET ${checkSet(set)} ${[...ids].join(' ')}`);
  }

  /** {ids: Uint32Array, coords: Float64Array of x, y}. With names of fields also `values`, a Float64Array for each, NaN if a
   * value is missing; all of it belongs to one state of the set. */
  async points(set, { fields = [] } = {}) {
    const names = [...fields].map(checkField);
    const { data } = await this.request(`POINTS ${checkSet(set)}${names.length > 0 ? ` FIELDS ${names.join(',')}` : ''} BINARY`);
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
  async coincident(set) {
    return new Map((await this.request(`COINCIDENT ${checkSet(set)}`)).rows.map(numbersOf));
  }

  // ---- fields: values at points ----

  /** {name: {count, least, most}}; NaN if there are no values. */
  async fields(set) {
    const { rows } = await this.request(`FIELDS ${checkSet(set)}`);
    return Object.fromEntries(rows.map((row) => row.split(' ')).map(([name, ...facts]) => {
      const [count, least, most] = facts.map((text) => (text === 'nan' ? NaN : Number(text)));
      return [name, { count, least, most }];
    }));
  }

  /** The values of points, a Float64Array; NaN where one is missing. */
  async getField(set, field, ids) {
    const { rows } = await this.request(`FGET ${checkSet(set)} ${checkField(field)} ${[...ids].join(' ')}`);
    return Float64Array.from(rows, (row) => numbersOf(row)[1]);
  }

  /** The values of all points: {ids: Uint32Array, values: Float64Array}. */
  async field(set, field) {
    const { ids, values } = await this.points(set, { fields: [field] });
    return { ids, values: values[field] };
  }

  /** Sets the values of the ids first, first + 1, ...; NaN takes one away. */
  async setField(set, field, values, { first = 0, timeout } = {}) {
    const column = Float64Array.from(values);
    await this.request(`FSETB ${checkSet(set)} ${checkField(field)} ${first} ${column.length}`, { body: doubleBytes(column), timeout });
  }

  // ---- the triangulation ----

  /** Three ids a triangle, counterclockwise. With within, [x0, y0, x1, y1], only the triangles that meet this box. With inside, only the
   * triangles inside the border of this number, or, if it is true, inside any border. */
  async triangles(set, { clockwise = false, within, inside } = {}) {
    return this.#ids(`TRIANGLES ${checkSet(set)}${boxWords(within, 'WITHIN')}${insideWords(inside)}${clockwise ? ' CW' : ''} BINARY`);
  }

  /** Two ids an edge. constrained: only those that are parts of constraints; inside: only those with a border's inside on a side. */
  async edges(set, { constrained = false, inside } = {}) {
    return this.#ids(`EDGES ${checkSet(set)}${constrained ? ' CONSTRAINED' : ''}${insideWords(inside)} BINARY`);
  }

  /** A Map from each point's id to its ring of neighbours, in the order of LISTS. within: [x0, y0, x1, y1], only the
   * points in this box. */
  async lists(set, { within } = {}) {
    const list = await this.#ids(`LISTS ${checkSet(set)}${boxWords(within, 'WITHIN')} BINARY`);
    const rings = new Map();
    for (let at = 0; at < list.length; at += 2 + list[at + 1]) {
      rings.set(list[at], list.subarray(at + 2, at + 2 + list[at + 1]));
    }
    return rings;
  }

  async hull(set, { clockwise = false } = {}) {
    const { rows } = await this.request(`HULL ${checkSet(set)}${clockwise ? ' CW' : ''}`);
    return Uint32Array.from(rows, (row) => Number.parseInt(row, 10));
  }

  // ---- queries ----

  async locate(set, x, y) {
    const { keys, rows } = await this.request(`LOCATE ${checkSet(set)} ${x} ${y}`);
    return { where: keys.where, ids: rows.length > 0 ? numbersOf(rows[0]) : [] };
  }

  /** The k nearest points, nearest first, as {id, x, y, distance}. */
  async nearest(set, x, y, k = 1) {
    return this.#points(`NEAREST ${checkSet(set)} ${x} ${y} ${k}`);
  }

  async #places(command, set, places, rest, { getX, getY, timeout } = {}) {
    const body = pointBytes(flatten(places, getX, getY));
    const { data } = await this.request(`${command} ${checkSet(set)} ${body.length / 16}${rest}`, { body, timeout });
    return words(Uint32Array, data);
  }

  /** Three ids for each place: of the triangle that contains it, the first in triangles() if there are several; outside three
   * times NONE. */
  async locateAll(set, places, options) {
    return this.#places('LOCATEB', set, places, '', options);
  }

  /** k ids for each place, nearest first; NONE where there are too few points. */
  async nearestAll(set, places, k = 1, options) {
    return this.#places('NEARESTB', set, places, ` ${k}`, options);
  }

  /** The ids in a box (x0, y0, x1, y1) or a disc (x, y, r). */
  async within(set, ...where) {
    const { rows } = await this.request(`WITHIN ${checkSet(set)} ${where.join(' ')}`);
    return rows.map((row) => Number.parseInt(row, 10));
  }

  // ---- surfaces ----

  /** A Map from each id to its weight. */
  async weights(set, x, y, { method = 'linear', timeout } = {}) {
    const { rows } = await this.request(`WEIGHTS ${checkSet(set)} ${x} ${y} METHOD ${method}`, { timeout });
    return new Map(rows.map(numbersOf));
  }

  /** The values at places, a Float64Array; NaN where there are none. inside: as for triangles(). missing: 'skip' leaves out points
   * without a value. Of several fields, an array of names, each place has their values. */
  async interpolate(set, field, places, { getX, getY, timeout, ...options } = {}) {
    const body = pointBytes(flatten(places, getX, getY));
    const line = `INTERPOLATEB ${checkSet(set)} ${fieldWords(field)} ${body.length / 16}${methodWords({ ...options, clip: undefined })}`;
    return words(Float64Array, (await this.request(line, { body, timeout })).data);
  }

  /** By how much a field grows at places, for a unit of x and of y: two numbers for each place. */
  async gradient(set, field, places, { maxEdge, inside, missing, getX, getY, timeout } = {}) {
    const body = pointBytes(flatten(places, getX, getY));
    const line = `GRADIENTB ${checkSet(set)} ${fieldWords(field)} ${body.length / 16}${methodWords({ maxEdge, inside, missing })}`;
    return words(Float64Array, (await this.request(line, { body, timeout })).data);
  }

  /** The values at the centres of cells, row by row from the largest y, as d3-contour expects them. With the quantity 'slope' or
   * 'aspect' they are the slope or the direction downhill there, in degrees. */
  async raster(set, field, box, columns, rows, { quantity, progress, timeout, ...options } = {}) {
    const as = quantity === undefined ? '' : ` AS ${quantity}`;
    const line = `RASTER ${checkSet(set)} ${fieldWords(field)} ${[...box].join(' ')} ${columns} ${rows}${methodWords(options)}${as} BINARY`;
    return words(Float64Array, (await this.request(line, { progress, timeout })).data);
  }

  /** Contour lines {level, closed, coords}, higher ground on the left: at `levels`, or at base and all multiples of `every` from it. */
  async contourLines(set, field, { levels, every, base = 0, maxEdge, inside, missing, timeout } = {}) {
    const line = `CONTOUR ${checkSet(set)} ${checkField(field)} ${levelWords(levels, every, base)}${methodWords({ maxEdge, inside, missing })}`;
    return (await this.request(line, { timeout })).rows.map(contourOf);
  }

  /** The bands between neighbouring levels as GeoJSON Polygons with the properties low and high. The lowest level may be -Infinity and the
   * highest Infinity; `every` takes as many levels as cover the surface. */
  async bands(set, field, { levels, every, base = 0, maxEdge, inside, missing, timeout } = {}) {
    const which = `${levelWords(levels, every, base)} BANDS${methodWords({ maxEdge, inside, missing })}`;
    return bandsOf((await this.request(`CONTOUR ${checkSet(set)} ${checkField(field)} ${which}`, { timeout })).rows);
  }

  /** For each level the ground at or above it: a GeoJSON MultiPolygon with the property value, as d3-contour and d3-tricontour. All
   * levels are of one state of the set: what was edited meanwhile is asked for again. */
  async contours(set, field, levels, { timeout } = {}) {
    const wanted = [...levels];
    const stat = () => this.request(`STAT ${checkSet(set)}`, { timeout });
    const above = async (level) => multiPolygon(await this.bands(set, field, { levels: [level, Infinity], timeout }), level);
    if (wanted.length === 0) return [];
    for (let i = 0; i < MOST_TRIES; i++) {
      const [before, ...polygons] = await Promise.all([stat(), ...wanted.map(above), stat()]);
      if (polygons.pop().keys.version === before.keys.version) return polygons;
    }
    throw new Error(`${set} is edited while it is read; try again`);
  }

  /** The surface along straight pieces between places: distance, x, y and value of the places and of every edge and corner of the
   * triangulation between them, four numbers each. */
  async profile(set, field, places, { maxEdge, inside, missing, getX, getY, timeout } = {}) {
    const line = `PROFILE ${checkSet(set)} ${checkField(field)} ${flatten(places, getX, getY).join(' ')}${methodWords({ maxEdge, inside, missing })} BINARY`;
    return words(Float64Array, (await this.request(line, { timeout })).data);
  }

  /** {above, below, area}: the volumes between the surface of a field and a level, or the surface of another field, `minus`; and the
   * area of the triangles whose corners have values. Only what is inside borders, and in a box. */
  async volume(set, field, { level, minus, inside, missing, box, timeout } = {}) {
    const base = `${level === undefined ? '' : ` LEVEL ${Number(level)}`}${minus === undefined ? '' : ` MINUS ${checkField(minus)}`}`;
    const line = `VOLUME ${checkSet(set)} ${checkField(field)}${base}${insideWords(inside)}${missingWords(missing)}${boxWords(box)}`;
    const { keys } = await this.request(line, { timeout });
    return Object.fromEntries(Object.entries(keys).map(([key, text]) => [key, text === 'inf' ? Infinity : Number(text)]));
  }

  /** Voronoi cells, with cellPolygon(id) and cellPolygons() as d3-delaunay's; box: [x0, y0, x1, y1]. */
  async voronoi(set, { ids = [], box, timeout } = {}) {
    const list = [...ids].map((id) => ` ${id}`).join('');
    const { data, keys } = await this.request(`VORONOI ${checkSet(set)}${list}${boxWords(box)} BINARY`, { timeout });
    return new Cells(data, keys.box.split(',').map(Number));
  }

  /** {ids: Uint32Array, areas: Float64Array} of the cells of voronoi(). */
  async areas(set, { box, timeout } = {}) {
    const { data } = await this.request(`AREAS ${checkSet(set)}${boxWords(box)} BINARY`, { timeout });
    const n = data.length / 12;
    return {
      ids: Uint32Array.from({ length: n }, (_, i) => data.readUInt32LE(12 * i)),
      areas: Float64Array.from({ length: n }, (_, i) => data.readDoubleLE(12 * i + 4)),
    };
  }

  /** The boundary of the alpha shape, loops {hole, ids} with the shape on their left. */
  async alpha(set, radius, { timeout } = {}) {
    const { rows } = await this.request(`ALPHA ${checkSet(set)} ${Number(radius)}`, { timeout });
    return rows.map(loopOf);
  }

  /** {radius, loops}: the least radius that gives one piece with all points, and the boundary of its alpha shape. */
  async alphaAuto(set, { timeout } = {}) {
    const { rows, keys } = await this.request(`ALPHA ${checkSet(set)} AUTO`, { timeout });
    return { radius: Number(keys.radius), loops: rows.map(loopOf) };
  }

  /** Makes the new set `into` of few points of the set, at most `points`: the linear surface of the field through them is within the error
   * of every point. The field `ids` of the new set gets their ids in the set. Returns {points, constraints, error}. */
  async simplify(set, field, error, into, { points, ids, timeout } = {}) {
    const words = ['SIMPLIFY', checkSet(set), checkField(field), 'ERROR', Number(error)];
    if (points !== undefined) words.push('POINTS', Number(points));
    if (ids !== undefined) words.push('IDS', checkField(ids));
    const { keys } = await this.request([...words, 'INTO', checkSet(into)].join(' '), { timeout });
    const worst = keys.error === 'inf' ? Infinity : Number(keys.error);
    return { points: Number(keys.points), constraints: Number(keys.constraints), error: worst };
  }

  // ---- mirrors ----

  /** A copy of the set that follows it, over a connection of its own; resolves when it is whole. within is a box [x0, y0, x1, y1].
   * Points have the values of `fields`, names, after their coordinates. */
  async mirror(set, { within, fields = [] } = {}) {
    const { Mirror } = await import('./mirror.mjs');
    const names = [...fields].map(checkField);
    const rest = `${boxWords(within, 'WITHIN')}${names.length > 0 ? ` FIELDS ${names.join(',')}` : ''} CONSTRAINTS`;
    const onEnd = () => this.#mirrors.delete(mirror);
    const mirror = new Mirror(checkSet(set), { open: (options) => this.#connect(options), rest, fields: names, onEnd });
    this.#mirrors.add(mirror);
    await mirror.start();
    await mirror.reached(0);
    return mirror;
  }

  // ---- the server ----

  async info() {
    const { rows } = await this.request('INFO');
    return Object.fromEntries(rows.map((row) => [row.slice(0, row.indexOf(':')), typed(row.slice(row.indexOf(':') + 1))]));
  }
}

/** Connects; resolves with a Client. Without a URL: $DELAUNAY_URL, or else localhost:6374, or else a private daemon. */
async function connect(url, options) {
  const client = new Client(chooseAddress(url), options);
  await client.open();
  return client;
}

let common = null;

/** The default client. It does not keep the process alive. */
function commonClient() {
  common ??= new Client(chooseAddress(), { unref: true });
  return common;
}

/** Sets the server of the default client for later calls, as in connect(). */
function useServer(url, { timeout = 0 } = {}) {
  common?.close();
  common = new Client(chooseAddress(url), { unref: true, timeout });
}

module.exports = { Client, commonClient, connect, useServer };
