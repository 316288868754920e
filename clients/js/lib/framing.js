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

function typedKeys(keys) {
  return Object.fromEntries(Object.entries(keys).map(([key, text]) => [key, typed(text)]));
}

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

/** Points as x, y one after the other: from such an array of any kind, from pairs, or from anything with getX and getY. A
 * Float64Array is returned as it is. */
function flatten(points, getX, getY) {
  if (getX === undefined && getY === undefined) {
    if (points instanceof Float64Array) return points;
    if (ArrayBuffer.isView(points) || (Array.isArray(points) && typeof points[0] === 'number')) return Float64Array.from(points);
  }
  const x = getX ?? ((p) => p[0]);
  const y = getY ?? ((p) => p[1]);
  const flat = [];
  for (const p of points) flat.push(x(p), y(p));
  return Float64Array.from(flat);
}

/** Coordinates as LOADB expects them. They are not copied on a little-endian machine. */
function pointBytes(flat) {
  if (flat.length % 2 !== 0) throw new TypeError('odd number of coordinates');
  return doubleBytes(flat);
}

function doubleBytes(flat) {
  const bytes = Buffer.from(flat.buffer, flat.byteOffset, flat.byteLength);
  return BIG_ENDIAN ? Buffer.from(bytes).swap64() : bytes;
}

module.exports = { Input, doubleBytes, flatten, parseEvent, parseStatus, pointBytes, typed, typedKeys, words };
