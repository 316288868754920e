// The core in process: compiled to WebAssembly (wasm/doors.c), and arrays that come and go. It works wherever there is WebAssembly with
// SIMD: in Node, in browsers and in workers.
'use strict';

const { Refused } = require('./errors.js');
const text = require('./module.js');

const LARGE = 1 << 26; // bytes of memory
const RESULTS = 64; // bytes

// By the numbers of enum dt_status (core/delaunay.h), in the words of the daemon.
const STATUS = {
  1: 'NOMEM out of memory',
  2: 'TOOBIG a set holds at most 268435455 points',
  3: 'RANGE a coordinate is 0 or has a magnitude from 2^-142 to 2^201',
  4: 'NOPOINT no such point',
  5: 'NOEDGE a constraint joins two points',
  7: 'NOFIELD the points have no values',
  14: 'CONSTRAINED the point is an end of a constraint',
  15: 'NOCONSTRAINT no such constraint',
  16: 'NOTDELAUNAY with constraints there are neither cells nor natural neighbours',
};

const NOMEM = 1;
const RANGE = 3;
const NOPOINT = 4;
const CROSSES = 13;

let compiled = null;
let small = null; // the instance for new sets
let large = null; // a weak reference to one that is not

function decode() {
  if (typeof Buffer === 'function') return Buffer.from(text, 'base64');
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

function refusal(status) {
  return new Refused(`ERR ${STATUS[status] ?? `INTERNAL status ${status}`}`);
}

/** An instance with its memory, which grows and never shrinks. */
class Core {
  #exports;
  #results; // address of what a call writes
  #buffer = null;
  #words;
  #bytes;
  last = 0; // the set of withSet(); 0: none

  constructor() {
    compiled ??= new WebAssembly.Module(decode());
    this.#exports = new WebAssembly.Instance(compiled).exports;
    this.#results = this.#exports.malloc(RESULTS);
  }

  /** The memory as bytes; what was returned before is void after the memory has grown. */
  #memory() {
    const { buffer } = this.#exports.memory;
    if (buffer !== this.#buffer) {
      this.#buffer = buffer;
      this.#bytes = new Uint8Array(buffer);
      this.#words = new Uint32Array(buffer, this.#results, RESULTS / 4);
    }
    return this.#bytes;
  }

  get isLarge() {
    return this.#memory().length > LARGE;
  }

  newSet(tolerance) {
    const set = this.#exports.set_new(tolerance);
    if (set === 0) throw refusal(NOMEM);
    return set;
  }

  freeSet(set) {
    this.#exports.set_free(set);
  }

  /** Calls a function that returns a status; an error unless that is DT_OK. Functions with results write them where `results`,
   * their last argument, says. */
  call(name, ...args) {
    const status = this.#exports[name](...args, this.#results);
    if (status === CROSSES) throw new Refused(this.#crossing());
    if (status !== 0) throw refusal(status);
  }

  /** Calls it with the numbers, of a type, in the memory: call(name, set, address, how many, ...rest). Returns this. */
  callWith(name, set, Type, numbers, n, ...rest) {
    return this.callNumbers(Type, numbers, (address) => this.call(name, set, address, n, ...rest));
  }

  /** Calls use() with the address of the numbers in the memory. Returns this. */
  callNumbers(Type, numbers, use) {
    const { malloc, free } = this.#exports;
    const address = malloc(numbers.length * Type.BYTES_PER_ELEMENT + 1) >>> 0;
    if (address === 0) throw refusal(NOMEM);
    try {
      new Type(this.#memory().buffer, address, numbers.length).set(numbers);
      use(address);
      return this;
    } finally {
      free(address);
    }
  }

  /** The number that the last call has written as its result i, of 4 bytes. */
  number(i) {
    this.#memory();
    return this.#words[i];
  }

  #crossing() {
    const [a, b, c, d] = [0, 1, 2, 3].map((i) => this.number(i));
    return `ERR CROSSES ${a} ${b} crosses ${c} ${d}`;
  }

  /** The n doubles that the last call has written. */
  doubles(n) {
    return new Float64Array(this.#memory().buffer, this.#results, n).slice();
  }

  /** The array that the last call has written as its result i, as an address and a length. */
  array(Type, i) {
    const { buffer } = this.#memory();
    const address = this.#words[2 * i];
    const copy = new Type(buffer, address, this.#words[2 * i + 1]).slice();
    this.#exports.free(address);
    return copy;
  }
}

/** Gives up the instance for new sets if its memory has become large: the system gets the memory back when the last set in it is gone. */
function retire() {
  if (!small?.isLarge) return;
  large = new WeakRef(small);
  small = null;
}

/** The instance for sets that stay. */
function findCore() {
  retire();
  return (small ??= new Core());
}

/** The instance for a set that does not: a large one as long as nothing has collected it, because fresh memory is expensive. */
function findScratch() {
  retire();
  return large?.deref() ?? findCore();
}

/** Calls use(core, set) with the points in a set, triangulated. It stays in the memory until the next call: for withPoints(). */
function withSet(coords, use) {
  const core = findScratch();
  core.freeSet(core.last);
  core.last = 0;
  const set = core.newSet(0);
  try {
    addPoints(core, set, coords);
    core.call('set_triangulate', set);
  } catch (error) {
    core.freeSet(set);
    throw error;
  }
  core.last = set;
  return use(core, set);
}

/** The same, but if the last set has the same points, it is used instead of a new one: a Voronoi diagram follows a triangulation. */
function withPoints(coords, use) {
  const core = findScratch();
  const has = core.last !== 0 && core.callWith('set_has', core.last, Float64Array, coords, coords.length >> 1).number(0) === 1;
  return has ? use(core, core.last) : withSet(coords, use);
}

function addPoints(core, set, coords) {
  withPlaces(coords, () => core.callWith('set_add', set, Float64Array, coords, coords.length >> 1));
}

/** Calls use(); if coordinates are refused and one of them is not a number, the error says so. */
function withPlaces(coords, use) {
  try {
    return use();
  } catch (error) {
    const isNaN = error.code === 'RANGE' && Array.prototype.some.call(coords, (v) => Number.isNaN(+v));
    throw isNaN ? new Refused('ERR NUMBER a coordinate is not a number') : error;
  }
}

module.exports = { NOPOINT, RANGE, addPoints, findCore, refusal, withPlaces, withPoints, withSet };
