// From bytes to replies and from points to bytes: PROTOCOL.md, sections 2 and 7.
'use strict';

const { endianness } = require('node:os');

const LF = 10;
const BIG_ENDIAN = endianness() === 'BE';

/** Bytes that arrive in pieces and are read as lines or blocks. Pieces are joined only when a line or block spans several. */
class Input {
  #pieces = [];
  #length = 0;
  #scanned = 0; // pieces without LF

  push(piece) {
    this.#pieces.push(piece);
    this.#length += piece.length;
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

/** The number and the words after OK or EVENT. */
function parseLine(line, kind) {
  const [first, count, ...words] = line.split(' ');
  if (first !== kind || !/^\d+$/.test(count)) throw new Error(`not a reply of this protocol: ${line.slice(0, 80)}`);
  const keys = {};
  for (const word of words) {
    const at = word.indexOf('=');
    if (at > 0) keys[word.slice(0, at)] = word.slice(at + 1);
  }
  return { keys, words, expected: Number(count) };
}

/** {keys, rows, data} of the status line, with `expected` rows to come. */
function parseStatus(line) {
  const { keys, expected } = parseLine(line, 'OK');
  return { keys, rows: [], data: null, expected };
}

/** {event: {set, version, reset, more, dropped}, rows}, with `expected` rows to come. */
function parseEvent(line) {
  const { keys, words, expected } = parseLine(line, 'EVENT');
  const event = { set: keys.set, version: Number(keys.version) };
  for (const word of ['reset', 'more', 'dropped']) event[word] = words.includes(word);
  return { event, rows: [], expected };
}

const NUMBER = /^-?\d+(\.\d+)?(e[+-]?\d+)?$/;

/** A value of the protocol with its type: a number, true or false, or text. */
function typed(text) {
  if (NUMBER.test(text)) return Number(text);
  return text === 'yes' ? true : text === 'no' ? false : text;
}

// ---- words of requests ----

function checkSet(name) {
  if (!/^[A-Za-z0-9_.:-]{1,64}$/.test(name)) throw new TypeError('a set\'s name is 1 to 64 of A-Z a-z 0-9 _ . : -');
  return name;
}

function checkField(name) {
  if (!/^[A-Za-z_][A-Za-z0-9_.:-]{0,63}$/.test(name)) throw new TypeError('a field\'s name is a letter or _, then up to 63 of A-Z a-z 0-9 _ . : -');
  return name;
}

const numbers = (values) => Array.from(values, Number);

/** The words of what may be left out: undefined or false: none; true: the keyword alone; else the keyword, if there is one, and the
 * values. */
function option(keyword, value) {
  if (value === undefined || value === null || value === false) return [];
  const before = keyword === null ? [] : [keyword];
  if (value === true) return before;
  return before.concat(typeof value === 'object' ? [...value] : value);
}

/** The line of a request: words, and lists of words. */
const line = (...parts) => parts.flat(2).join(' ');

// ---- results: functions of a reply ----

const nothing = () => undefined;
const text = (key) => ({ keys }) => keys[key];
const number = (key) => ({ keys }) => (key in keys ? Number(keys[key]) : undefined);
const truth = (key) => ({ keys }) => keys[key] === 'yes' || keys[key] === '1';
const typedKeys = ({ keys }) => Object.fromEntries(Object.entries(keys).map(([key, word]) => [key, typed(word)]));

/** The rows, each word of the type of its letter, the last one's for the rest: i, d, s; others have that of their form. */
function table(types) {
  const reads = [...types].map((letter) => ({ i: Number, d: Number, s: String })[letter] ?? typed);
  return ({ rows }) => rows.map((row) => row.split(' ').map((word, i) => reads[Math.min(i, reads.length - 1)](word)));
}

// ---- arrays ----

/** The bytes as an array of a type. They are copied: they may be part of a larger block, and not aligned. */
function words(Type, bytes) {
  const size = Type.BYTES_PER_ELEMENT;
  const own = new Uint8Array(bytes);
  if (BIG_ENDIAN) {
    const buffer = Buffer.from(own.buffer);
    if (size === 4) buffer.swap32();
    else buffer.swap64();
  }
  return new Type(own.buffer, 0, own.length / size);
}

/** Coordinates as LOADB expects them. They are not copied on a little-endian machine. */
function pointBytes(flat) {
  if (flat.length % 2 !== 0) throw new TypeError('odd number of coordinates');
  return doubleBytes(flat);
}

/** Pairs of ids as CONSTRAINB expects them. */
function idBytes(flat) {
  const ids = Uint32Array.from(flat);
  if (ids.some((id, i) => id !== flat[i])) throw new RangeError('an id is a number from 0 to 2^32 - 1');
  const bytes = Buffer.from(ids.buffer);
  return BIG_ENDIAN ? bytes.swap32() : bytes;
}

function doubleBytes(flat) {
  const bytes = Buffer.from(flat.buffer, flat.byteOffset, flat.byteLength);
  return BIG_ENDIAN ? Buffer.from(bytes).swap64() : bytes;
}

module.exports = {
  Input,
  checkField,
  checkSet,
  doubleBytes,
  idBytes,
  line,
  nothing,
  number,
  numbers,
  option,
  parseEvent,
  parseStatus,
  pointBytes,
  table,
  text,
  truth,
  typed,
  typedKeys,
  words,
};
