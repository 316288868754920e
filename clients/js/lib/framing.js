// Words of requests, results of replies, and points as bytes: PROTOCOL.md, sections 2 and 7.
'use strict';

const { endianness } = require('node:os');

const BIG_ENDIAN = endianness() === 'BE';

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
  checkField,
  checkSet,
  doubleBytes,
  idBytes,
  line,
  nothing,
  number,
  numbers,
  option,
  pointBytes,
  table,
  text,
  truth,
  typed,
  typedKeys,
  words,
};
