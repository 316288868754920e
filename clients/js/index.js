// The connection: requests in lines, replies as promises in the order of requests, large tables as typed arrays.

import net from 'node:net';
import { endianness } from 'node:os';

export { Triangulation } from './triangulation.js';

const LF = 10;

/** The server answered ERR; the connection goes on. */
export class Refused extends Error {
  constructor(line) {
    super(line);
    this.name = 'Refused';
    this.code = line.split(' ', 2)[1];
  }
}

/** Bytes that arrive in pieces and are taken as lines or blocks. Pieces are joined only when one is needed whole. */
class Input {
  #pieces = [];
  #length = 0;
  #scanned = 0; // pieces without LF

  push(piece) {
    this.#pieces.push(piece);
    this.#length += piece.length;
  }

  get length() {
    return this.#length;
  }

  take(n) {
    if (this.#length < n) return null;
    const taken = [];
    let missing = n;
    while (missing > 0) {
      const first = this.#pieces[0];
      if (first.length <= missing) {
        taken.push(this.#pieces.shift());
        missing -= first.length;
      } else {
        taken.push(first.subarray(0, missing));
        this.#pieces[0] = first.subarray(missing);
        missing = 0;
      }
    }
    this.#length -= n;
    this.#scanned = 0;
    return taken.length === 1 ? taken[0] : Buffer.concat(taken, n);
  }

  line() {
    let before = 0;
    for (let i = 0; i < this.#scanned; i++) before += this.#pieces[i].length;
    for (; this.#scanned < this.#pieces.length; this.#scanned++) {
      const at = this.#pieces[this.#scanned].indexOf(LF);
      if (at >= 0) {
        const text = this.take(before + at + 1).toString('utf8');
        return text.slice(0, text.endsWith('\r\n') ? -2 : -1);
      }
      before += this.#pieces[this.#scanned].length;
    }
    return null;
  }
}

function parseStatus(line) {
  const match = /^OK (\d+)((?: .*)?)$/.exec(line);
  if (!match) throw new Error(`not a reply of this protocol: ${line.slice(0, 80)}`);
  const keys = {};
  for (const word of match[2].split(' ')) {
    const at = word.indexOf('=');
    if (at > 0) keys[word.slice(0, at)] = word.slice(at + 1);
  }
  return { keys, rows: [], data: null, expected: Number(match[1]) };
}

/** A view of the bytes as words of a type; copies unless they are aligned and in this machine's order. */
function words(Type, bytes) {
  const size = Type.BYTES_PER_ELEMENT;
  const own = new Uint8Array(bytes); // a copy of its own: the bytes may be part of a larger block
  if (endianness() === 'BE') {
    const buffer = Buffer.from(own.buffer);
    if (size === 4) buffer.swap32();
    else buffer.swap64();
  }
  return new Type(own.buffer, 0, own.length / size);
}

function checkSet(name) {
  if (!/^[A-Za-z0-9_.:-]{1,64}$/.test(name)) throw new TypeError('a set\'s name is 1 to 64 of A-Z a-z 0-9 _ . : -');
  return name;
}

/** Coordinates as bytes: a flat Float64Array, or any iterable of pairs. */
function pointBytes(points) {
  let flat = points;
  if (!(points instanceof Float64Array)) {
    flat = [];
    for (const [x, y] of points) flat.push(x, y);
    flat = Float64Array.from(flat);
  }
  if (flat.length % 2 !== 0) throw new TypeError('an x without its y');
  const bytes = Buffer.from(flat.buffer, flat.byteOffset, flat.byteLength);
  return endianness() === 'BE' ? Buffer.from(bytes).swap64() : bytes;
}

/** A connection to a daemon; made by connect(). */
export class Client {
  #socket;
  #input = new Input();
  #waiting = []; // requests without a reply: {resolve, reject, progress}
  #reply = null; // the one that is being read
  #failure = null;

  constructor(socket) {
    this.#socket = socket;
    socket.on('data', (piece) => {
      this.#input.push(piece);
      this.#read();
    });
    socket.on('error', (error) => this.#fail(error));
    socket.on('close', () => this.#fail(new Error('the connection was lost')));
  }

  close() {
    this.#fail(new Error('closed'));
  }

  #fail(error) {
    if (this.#failure) return;
    this.#failure = error;
    this.#socket.destroy();
    for (const request of this.#waiting.splice(0)) request.reject(error);
  }

  #read() {
    try {
      while (this.#waiting.length > 0 && this.#step());
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Reads one part of a reply; false if it has not arrived. */
  #step() {
    const reply = this.#reply;
    if (reply?.size !== undefined) {
      if ((reply.data = this.#input.take(reply.size)) === null) return false;
      return this.#settle();
    }
    const line = this.#input.line();
    if (line === null) return false;
    if (reply) {
      reply.rows.push(line);
      return reply.rows.length < reply.expected || this.#settle();
    }
    if (line.startsWith('#')) {
      this.#waiting[0].progress?.(line.slice(1).trim());
    } else if (line.startsWith('ERR ')) {
      this.#waiting.shift().reject(new Refused(line));
    } else {
      this.#reply = parseStatus(line);
      if (this.#reply.expected === 0) {
        if (this.#reply.keys.bytes === undefined) return this.#settle();
        this.#reply.size = Number(this.#reply.keys.bytes);
      }
    }
    return true;
  }

  #settle() {
    const { keys, rows, data } = this.#reply;
    this.#reply = null;
    this.#waiting.shift().resolve({ keys, rows, data });
    return true;
  }

  /** Sends a request, and bytes that belong to it; resolves with {keys, rows, data}. */
  request(line, { body, progress } = {}) {
    if (/[\r\n]/.test(line)) return Promise.reject(new TypeError('a line break in a request'));
    if (this.#failure) return Promise.reject(this.#failure);
    return new Promise((resolve, reject) => {
      this.#waiting.push({ resolve, reject, progress });
      this.#socket.write(`${line}\n`);
      if (body && body.length > 0) this.#socket.write(body);
    });
  }

  async #ids(line) {
    return words(Uint32Array, (await this.request(line)).data);
  }

  async sets() {
    return (await this.request('SETS')).rows.map((row) => row.split(' ', 1)[0]);
  }

  async create(set, tolerance = 0) {
    await this.request(`CREATE ${checkSet(set)} TOL ${tolerance}`);
  }

  async drop(set) {
    await this.request(`DROP ${checkSet(set)}`);
  }

  async stat(set) {
    return (await this.request(`STAT ${checkSet(set)}`)).keys;
  }

  /** Adds points, all or none; the first one's id. The array must not change until then. */
  async load(set, points) {
    const body = pointBytes(points);
    return Number((await this.request(`LOADB ${checkSet(set)} ${body.length / 16}`, { body })).keys.first);
  }

  async add(set, x, y) {
    return Number((await this.request(`ADD ${checkSet(set)} ${x} ${y}`)).keys.first);
  }

  async delete(set, ids) {
    return Number((await this.request(`DEL ${checkSet(set)} ${[...ids].join(' ')}`)).keys.deleted);
  }

  async move(set, id, x, y) {
    await this.request(`MOVE ${checkSet(set)} ${id} ${x} ${y}`);
  }

  /** {ids: Uint32Array, coords: Float64Array of x, y} */
  async points(set) {
    const { data } = await this.request(`POINTS ${checkSet(set)} BINARY`);
    const n = data.length / 20;
    const ids = new Uint32Array(n);
    const coords = new Float64Array(2 * n);
    for (let i = 0; i < n; i++) {
      ids[i] = data.readUInt32LE(20 * i);
      coords[2 * i] = data.readDoubleLE(20 * i + 4);
      coords[2 * i + 1] = data.readDoubleLE(20 * i + 12);
    }
    return { ids, coords };
  }

  async triangulate(set, { method, progress } = {}) {
    const line = `TRIANGULATE ${checkSet(set)}${method ? ` METHOD ${method}` : ''}`;
    return (await this.request(line, { progress })).keys;
  }

  async check(set) {
    return (await this.request(`CHECK ${checkSet(set)}`)).keys;
  }

  /** Three ids a triangle, counterclockwise. */
  triangles(set, { clockwise = false } = {}) {
    return this.#ids(`TRIANGLES ${checkSet(set)} ${clockwise ? 'CW ' : ''}BINARY`);
  }

  /** Two ids an edge. */
  edges(set) {
    return this.#ids(`EDGES ${checkSet(set)} BINARY`);
  }

  /** A Map from each point's id to its ring of neighbours, in the order of LISTS. */
  async lists(set) {
    const list = await this.#ids(`LISTS ${checkSet(set)} BINARY`);
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

  async locate(set, x, y) {
    const { keys, rows } = await this.request(`LOCATE ${checkSet(set)} ${x} ${y}`);
    return { where: keys.where, ids: rows.length > 0 ? rows[0].split(' ').map(Number) : [] };
  }

  async nearest(set, x, y, k = 1) {
    const { rows } = await this.request(`NEAREST ${checkSet(set)} ${x} ${y} ${k}`);
    return rows.map((row) => {
      const [id, px, py, distance] = row.split(' ').map(Number);
      return { id, x: px, y: py, distance };
    });
  }

  /** The ids in a box (x0, y0, x1, y1) or a disc (x, y, r). */
  async within(set, ...where) {
    const { rows } = await this.request(`WITHIN ${checkSet(set)} ${where.join(' ')}`);
    return rows.map((row) => Number.parseInt(row, 10));
  }

  async info() {
    const { rows } = await this.request('INFO');
    return Object.fromEntries(rows.map((row) => [row.slice(0, row.indexOf(':')), row.slice(row.indexOf(':') + 1)]));
  }
}

/** Connects; resolves with a Client. */
export async function connect(url = process.env.DELAUNAY_URL ?? 'delaunay://localhost:6374') {
  const where = new URL(url);
  if (where.protocol !== 'delaunay:' || where.hostname === '') throw new TypeError('a URL is delaunay://[:token@]host[:port]');
  const socket = net.connect({ host: where.hostname.replace(/^\[|\]$/g, ''), port: Number(where.port || 6374), noDelay: true });
  await new Promise((resolve, reject) => {
    socket.once('connect', resolve);
    socket.once('error', reject);
  });
  const client = new Client(socket);
  if (where.password) {
    try {
      await client.request(`AUTH ${decodeURIComponent(where.password)}`);
    } catch (error) {
      client.close();
      throw error;
    }
  }
  return client;
}
