// Sets in process, for a page without a server: what the page asks a daemon for, answered by the core in WebAssembly (core.js is
// ../../../js/browser.js). It has the requests and events of PROTOCOL.md that the page uses, and the interface of a Connection.
import { qualityOf } from '../angles.js';
import { Refused } from './connection.js';
import { parse } from './files.js';

const LITTLE = true; // byte order of binary replies
const bytesOf = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

/** A set: a LiveSet, and places of its points by id with their values. */
class LocalSet {
  version = 1;
  isWatched = false;

  constructor({ LiveSet }, { xy, values, field }) {
    this.field = field;
    this.live = LiveSet.from(xy, values === null ? {} : { values });
    this.places = new Map();
    for (let id = 0; id < xy.length / 2; id++) this.places.set(id, [xy[2 * id], xy[2 * id + 1], values?.[id] ?? NaN]);
  }

  /** The counts of STAT, which are made once for each version. */
  stat() {
    if (this.counted?.version === this.version) return this.counted;
    const [points, hull] = [this.places.size, this.live.hull().length];
    const triangles = points === 0 ? 0 : this.live.triangulation().triangles.length / 3;
    this.counted = { points, triangles, hull, version: this.version, triangulated: 'yes' };
    return this.counted;
  }

  /** `id x y value`, without the value if there is no field. */
  row(id) {
    const [x, y, value] = this.places.get(id);
    return this.field === null ? `${id} ${x} ${y}` : `${id} ${x} ${y} ${value}`;
  }

  /** The ids whose rings an edit of a point can change; null: of any points, as where points coincide or are on a line, or there are
   * constraints. */
  around(id) {
    const { live } = this;
    if (live.constrainedEdges().length > 0 || live.hull().length < 3 || live.size < 4 || live.coincident().includes(id)) return null;
    return [id, ...live.neighbors(id)];
  }

  /** The rows of an event about these ids; null: about all. */
  event(ids) {
    const hull = new Set(this.live.hull());
    const aliases = new Set(this.live.coincident().filter((_, k) => k % 2 === 0));
    return [...new Set(ids ?? this.places.keys())].flatMap((id) => {
      if (!this.places.has(id)) return [`gone ${id}`];
      const ring = aliases.has(id) ? [] : [`list ${id} ${hull.has(id) ? 'b' : 'i'} ${this.live.neighbors(id).join(' ')}`];
      return [`point ${this.row(id)}`, ...ring];
    });
  }
}

export class Local {
  isLost = false;
  #core = null;
  #sets = new Map(); // name -> LocalSet, or the address of its file until it is used
  #onEvent;

  /** files: {name: address}. */
  constructor(files, { onEvent }) {
    this.#onEvent = onEvent;
    for (const [name, address] of Object.entries(files)) this.#sets.set(name, address);
    this.opened = import('../core.js').then(() => (this.#core = globalThis.delaunayd));
  }

  /** Makes a set of what parse() returns. */
  load(name, points) {
    this.#sets.set(name, new LocalSet(this.#core, points));
  }

  close() {}

  fetchAll = (requests) => Promise.all(requests.map((line) => this.request(line)));

  async request(line) {
    const [command, name, ...words] = line.split(' ');
    if (command === 'SETS') return { rows: [...this.#sets.keys()].map((of) => `${of} `) };
    const set = await this.#set(name);
    const answer = ANSWERS[command];
    if (answer === undefined) throw new Refused('UNKNOWN', `${command} needs a server`);
    const { rows = [], keys = {}, data = null, ids } = answer(set, words);
    if (ids !== undefined) {
      set.version++;
      const event = { set: name, version: set.version, rows: set.event(ids), reset: ids === null, more: false, dropped: false };
      if (set.isWatched) this.#onEvent(event);
    }
    return { rows, keys, data };
  }

  async #set(name) {
    const known = this.#sets.get(name);
    if (known === undefined) throw new Refused('NOSET', `there is no set ${name}`);
    if (typeof known === 'string') {
      const response = await fetch(known);
      if (!response.ok) throw new Refused('NOSET', `${known} cannot be read`);
      const points = parse(known, await response.text());
      if (typeof this.#sets.get(name) === 'string') this.load(name, points);
    }
    return this.#sets.get(name);
  }
}

const join = (a, b) => (a === null || b === null ? null : [...a, ...b]);

/** For each command: (set, words) -> {rows, keys, data, ids}; ids as LocalSet.event takes them, if the command edits. */
const ANSWERS = {
  STAT: (set) => ({ keys: set.stat() }),
  FIELDS: ({ field, places }) => {
    const values = [...places.values()].map((place) => place[2]).filter((value) => !Number.isNaN(value));
    const [least, most] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    return { rows: field === null || values.length === 0 ? [] : [`${field} ${values.length} ${least} ${most}`] };
  },
  POINTS: ({ places }, words) => {
    const size = words.includes('FIELDS') ? 28 : 20;
    const view = new DataView(new ArrayBuffer(size * places.size));
    let at = 0;
    for (const id of [...places.keys()].sort((a, b) => a - b)) {
      view.setUint32(at, id, LITTLE);
      for (let k = 0; 8 * k + 4 < size; k++) view.setFloat64(at + 4 + 8 * k, places.get(id)[k], LITTLE);
      at += size;
    }
    return { data: bytesOf(view) };
  },
  TRIANGLES: ({ live }) => ({ data: bytesOf(live.triangulation().triangles.slice()) }),
  QUALITY: ({ live, places }) => qualityOf(places.size === 0 ? [] : live.triangulation().triangles, (id) => places.get(id)),
  HULL: ({ live, places }) => ({ rows: [...live.hull()].map((id) => `${id} ${places.get(id).slice(0, 2).join(' ')}`) }),
  EDGES: ({ live }) => {
    const ends = live.constrainedEdges(); // the page asks for no others
    return { rows: Array.from({ length: ends.length / 2 }, (_, k) => `${ends[2 * k]} ${ends[2 * k + 1]}`) };
  },
  LISTS: ({ live }, [id]) => ({ rows: [`${id} ${live.neighbors(Number(id)).join(' ')}`] }),
  GET: ({ live }, [id]) => ({ rows: [`${id} ${live.point(Number(id)).join(' ')}`] }),
  FGET: ({ places }, [, id]) => ({ rows: [`${id} ${places.get(Number(id))[2]}`] }),
  NEAREST: (set, words) => {
    const [id] = set.live.nearest(words.map(Number));
    return { rows: set.places.has(id) ? [set.row(id)] : [] };
  },
  LOCATE: ({ live }, words) => {
    const corners = [...live.locate(words.map(Number))];
    return corners[0] === 0xffffffff ? { keys: { where: 'outside' } } : { keys: { where: 'inside' }, rows: [corners.join(' ')] };
  },
  VORONOI: ({ live, places }, [, ...box]) => {
    const { offsets, coords } = live.cells(box.slice(0, 4).map(Number));
    const numbers = new Float64Array(places.size + coords.length);
    const words = new Uint32Array(numbers.buffer);
    let at = 0;
    for (const id of places.keys()) {
      const cell = coords.subarray(2 * offsets[id], 2 * offsets[id + 1]);
      if (cell.length === 0) continue;
      words.set([id, cell.length / 2], 2 * at);
      numbers.set(cell, at + 1);
      at += 1 + cell.length;
    }
    return { data: bytesOf(numbers.slice(0, at)) };
  },
  CONTOUR: (set, [, , every]) => {
    const [, , least, most] = ANSWERS.FIELDS(set).rows[0].split(' ').map(Number);
    const step = Number(every);
    const levels = [];
    for (let k = Math.ceil(least / step); k * step <= most; k++) levels.push(k * step);
    const { levels: of, offsets, coords, closed } = set.live.contours(levels);
    const rowOf = (level, i) => {
      const places = coords.subarray(2 * offsets[i], 2 * offsets[i + 1]);
      return `${level} ${closed[i] ? 'closed' : 'open'} ${places.length / 2} ${places.join(' ')}`;
    };
    return { rows: Array.from(of, rowOf) };
  },
  WATCH: (set) => {
    set.isWatched = true;
    return {};
  },
  UNWATCH: (set) => {
    set.isWatched = false;
    return {};
  },
  CONSTRAIN: ({ live }, ids) => {
    live.constrain(ids.map(Number));
    return { ids: null };
  },
  ADD: (set, words) => {
    const [x, y, value = NaN] = (words[0] === 'FIELDS' ? words.slice(2) : words).map(Number);
    const id = set.live.add([x, y], { values: [value] });
    set.places.set(id, [x, y, value]);
    return { keys: { first: String(id) }, ids: set.around(id) };
  },
  MOVE: (set, words) => {
    const [id, x, y] = words.map(Number);
    const before = set.places.has(id) ? set.around(id) : [];
    set.live.move(id, x, y);
    set.places.set(id, [x, y, set.places.get(id)[2]]);
    return { ids: join(before, set.around(id)) };
  },
  DEL: (set, [word]) => {
    const id = Number(word);
    const before = set.places.has(id) ? set.around(id) : [];
    set.live.delete([id]);
    set.places.delete(id);
    return { ids: set.live.hull().length < 3 ? null : before };
  },
};
