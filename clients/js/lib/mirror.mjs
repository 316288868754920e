// A mirror: a copy of a set that follows it by WATCH, over a connection of its own.
import { EventEmitter } from 'node:events';
import errors from './errors.js';
import { Gathered, eachTriangle, hasTriangle } from './rings.mjs';

const { Disconnected } = errors;
const FIRST_RETRY_MS = 50;
const LONGEST_RETRY_MS = 5000;
const KEEPALIVE_MS = 30000;

const always = () => true;
const byNumber = (a, b) => a - b;

/** A list of triangles, three ids each from the smallest. */
class Triangles {
  #ids = [];

  push(a, b, c) {
    if (a < b && a < c) this.#ids.push(a, b, c);
    else if (b < c) this.#ids.push(b, c, a);
    else this.#ids.push(c, a, b);
  }

  array() {
    return Uint32Array.from(this.#ids);
  }

  sorted() {
    const ids = this.array();
    const order = Uint32Array.from({ length: ids.length / 3 }, (_, i) => 3 * i);
    order.sort((i, j) => ids[i] - ids[j] || ids[i + 1] - ids[j + 1] || ids[i + 2] - ids[j + 2]);
    return Uint32Array.from({ length: ids.length }, (_, k) => ids[order[Math.floor(k / 3)] + (k % 3)]);
  }
}

/** Whether two rows [x, y, value ...] are the same numbers. */
const areSame = (a, b) => a.every((value, k) => Object.is(value, b[k]));

/** In the order of CONSTRAINTS. */
const byConstraint = (one, other) => one.a - other.a || one.b - other.b || one.border - other.border || one.number - other.number;

/** Whether a constraint is as it was; in a box its ends may have moved. */
const isAsBefore = (old, now) => old !== undefined && (now.places === undefined || (old.places !== undefined && areSame(old.places, now.places)));

/** Places, values and rings by id, constraints, and what an event changes in them. */
class State {
  points = new Map(); // id -> [x, y, value ...]
  rings = new Map(); // id -> {inner, ring}
  constraints = new Map(); // as in Gathered

  /** Applies what has been gathered; returns the points added, moved and gone, and the triangles and constraints added and removed. */
  apply(gathered) {
    const { points, rings } = gathered;
    const ids = gathered.ids();
    if (gathered.reset) for (const id of this.points.keys()) ids.add(id);
    const before = { points: new Map(), rings: new Map() };
    for (const id of ids) {
      if (this.points.has(id)) before.points.set(id, this.points.get(id));
      if (this.rings.has(id)) before.rings.set(id, this.rings.get(id));
    }
    if (gathered.reset) [this.points, this.rings] = [points, rings];
    else this.#merge(gathered);
    return {
      ...this.#pointChanges(ids, before.points),
      ...this.#triangleChanges(ids, before.rings),
      ...this.#applyConstraints(gathered),
    };
  }

  #merge({ points, rings, gone }) {
    for (const id of gone) {
      this.points.delete(id);
      this.rings.delete(id);
    }
    for (const [id, point] of points) {
      this.points.set(id, point);
      this.rings.delete(id);
    }
    for (const [id, ring] of rings) this.rings.set(id, ring);
  }

  #pointChanges(ids, before) {
    const changes = { added: [], moved: [], gone: [] };
    for (const id of ids) {
      const [old, now] = [before.get(id), this.points.get(id)];
      if (old === undefined && now !== undefined) changes.added.push(id);
      else if (old !== undefined && now === undefined) changes.gone.push(id);
      else if (old !== undefined && !areSame(old, now)) changes.moved.push(id);
    }
    for (const kind of Object.keys(changes)) changes[kind] = Uint32Array.from(changes[kind].sort(byNumber));
    return changes;
  }

  #applyConstraints({ reset, constraints }) {
    const [constraintsAdded, constraintsReleased] = [[], []];
    const release = (key) => {
      if (!this.constraints.has(key)) return;
      constraintsReleased.push(this.constraints.get(key));
      this.constraints.delete(key);
    };
    if (reset) for (const key of [...this.constraints.keys()]) if (!constraints.has(key)) release(key);
    for (const [key, constraint] of constraints) {
      if (constraint === null) {
        release(key);
      } else if (!isAsBefore(this.constraints.get(key), constraint)) {
        constraintsAdded.push(constraint);
        this.constraints.set(key, constraint);
      }
    }
    return { constraintsAdded: constraintsAdded.sort(byConstraint), constraintsReleased: constraintsReleased.sort(byConstraint) };
  }

  /** A triangle that comes or goes changes the rings of its corners, so those of the ids are enough. */
  #triangleChanges(ids, before) {
    const [added, removed] = [new Triangles(), new Triangles()];
    const after = new Map();
    for (const id of ids) if (this.rings.has(id)) after.set(id, this.rings.get(id));
    const was = (id) => (ids.has(id) ? before.get(id) : this.rings.get(id));
    const is = (id) => this.rings.get(id);
    eachTriangle(before, was, always, (a, b, c) => hasTriangle(a, b, c, is, always) || removed.push(a, b, c));
    eachTriangle(after, is, always, (a, b, c) => hasTriangle(a, b, c, was, always) || added.push(a, b, c));
    return { trianglesAdded: added.array(), trianglesRemoved: removed.array() };
  }
}

/** Made by Client.mirror(). Emits 'change', 'lost', 'resumed', 'dropped'. */
export class Mirror extends EventEmitter {
  #open; // returns a connection that has shown its token
  #set;
  #rest; // of the line of WATCH, from the box on
  #fields;
  #onEnd;
  #connection = null;
  #state = new State();
  #gathered = new Gathered();
  #held = null; // events
  #version = null; // of the last whole event
  #ended = null; // why, an error
  #waiting = []; // {version, resolve, reject} of reached()
  #timer = null;
  #retry = FIRST_RETRY_MS;

  constructor(set, { open, rest, fields, onEnd }) {
    super();
    this.#open = open;
    this.#set = set;
    this.#rest = rest;
    this.#fields = fields;
    this.#onEnd = onEnd;
  }

  /** The version of the set that the copy has; null before the first event. */
  get version() {
    return this.#version;
  }

  get size() {
    return this.#state.points.size;
  }

  /** [x, y, value ...] of a point; undefined if there is none. */
  point(id) {
    return this.#state.points.get(id);
  }

  /** The neighbours of a point, counterclockwise; undefined if it has none. */
  neighbors(id) {
    return this.#state.rings.get(id)?.ring;
  }

  /** As Client.points(). */
  points() {
    const { points } = this.#state;
    const ids = Uint32Array.from(points.keys()).sort();
    const coords = new Float64Array(2 * ids.length);
    const columns = this.#fields.map(() => new Float64Array(ids.length));
    ids.forEach((id, i) => {
      const row = points.get(id);
      coords.set(row.slice(0, 2), 2 * i);
      columns.forEach((column, k) => (column[i] = row[2 + k]));
    });
    if (columns.length === 0) return { ids, coords };
    return { ids, coords, values: Object.fromEntries(this.#fields.map((name, k) => [name, columns[k]])) };
  }

  /** As Client.lists(): inner points by id, then the boundary along the hull, or along the line that all points are on. */
  lists() {
    const { rings } = this.#state;
    const lists = new Map();
    const ids = [...Uint32Array.from(rings.keys()).sort()];
    for (const id of ids) if (rings.get(id).inner) lists.set(id, Uint32Array.from(this.neighbors(id)));
    const isEnd = (id) => this.neighbors(id).length < 2;
    for (const start of [...ids.filter(isEnd), ...ids]) {
      for (let id = start; rings.has(id) && !lists.has(id); [id] = this.neighbors(id)) lists.set(id, Uint32Array.from(this.neighbors(id)));
    }
    return lists;
  }

  /** As Client.triangles(). */
  triangles() {
    const { rings } = this.#state;
    const found = new Triangles();
    eachTriangle(rings, (id) => rings.get(id), always, (a, b, c) => found.push(a, b, c));
    return found.sorted();
  }

  /** The constraints, in the order of CONSTRAINTS. */
  constraints() {
    return [...this.#state.constraints.values()].sort(byConstraint);
  }

  /** Resolves when the copy has this version of the set or a later one. */
  reached(version) {
    if (this.#ended !== null) return Promise.reject(this.#ended);
    if (this.#version !== null && this.#version >= version) return Promise.resolve();
    return new Promise((resolve, reject) => this.#waiting.push({ version, resolve, reject }));
  }

  /** Ends it; the copy stays as it is. */
  close() {
    this.#end(new Disconnected('closed', 'CLOSED'));
  }

  #end(error) {
    if (this.#ended !== null) return;
    this.#ended = error;
    clearTimeout(this.#timer);
    this.#connection?.fail(error);
    for (const { reject } of this.#waiting.splice(0)) reject(error);
    this.#onEnd();
  }

  /** Connects and follows; Client.mirror() has the errors of the first time. */
  async start() {
    const connection = await this.#open({
      keepAlive: KEEPALIVE_MS,
      onEvent: (event) => this.#onEvent(connection, event),
      onFail: (error) => this.#onFail(connection, error),
    });
    const begin = () => {
      if (this.#ended !== null) connection.fail(this.#ended);
      else this.#connection = connection;
      this.#gathered = new Gathered();
    };
    const since = this.#version === null ? '' : ` SINCE ${this.#version}`;
    const line = `WATCH ${this.#set}${since} ${this.#rest}`;
    try {
      // The first event may arrive together with the reply.
      await new Promise((resolve, reject) => connection.send({ line, timeout: 0, resolve: () => resolve(begin()), reject }));
    } catch (error) {
      connection.fail(error);
      throw error;
    }
  }

  #onEvent(connection, event) {
    if (connection !== this.#connection || event.set !== this.#set || this.#ended !== null) return;
    if (this.#held !== null) {
      this.#held.push(event);
      return;
    }
    if (event.dropped) {
      this.#drop();
      return;
    }
    this.#gathered.add(event);
    if (event.more) return;
    const gathered = this.#gathered;
    this.#gathered = new Gathered();
    this.#retry = FIRST_RETRY_MS;
    const changes = this.#state.apply(gathered);
    if (this.#version === null) this.#hold();
    this.#version = event.version;
    this.#waiting = this.#waiting.filter(({ version, resolve }) => version > event.version || resolve());
    this.emit('change', { version: event.version, reset: gathered.reset, ...changes });
  }

  /** Keeps events until the caller of Client.mirror() has had time to listen. */
  #hold() {
    this.#held = [];
    setImmediate(() => {
      const [events, connection] = [this.#held, this.#connection];
      this.#held = null;
      for (const event of events) this.#onEvent(connection, event);
    });
  }

  #drop() {
    this.#end(new Disconnected('the set has been dropped', 'DROPPED'));
    this.emit('dropped');
  }

  #onFail(connection, error) {
    if (connection !== this.#connection || this.#ended !== null) return;
    this.#connection = null;
    this.emit('lost', error);
    this.#resumeLater();
  }

  #resumeLater() {
    if (this.#ended !== null) return;
    this.#timer = setTimeout(() => this.#resume(), this.#retry);
    this.#retry = Math.min(2 * this.#retry, LONGEST_RETRY_MS);
  }

  /** The server may be starting, or the set may have been dropped meanwhile. */
  async #resume() {
    try {
      await this.start();
    } catch (error) {
      if (this.#ended !== null) return;
      if (error.code === 'NOSET') this.#drop();
      else this.#resumeLater();
      return;
    }
    this.emit('resumed');
  }
}
