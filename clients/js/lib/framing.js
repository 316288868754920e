// Lines of requests, results of replies, and arrays as bytes: PROTOCOL.md, sections 2 and 7.
'use strict';

const { endianness } = require('node:os');

const BIG_ENDIAN = endianness() === 'BE';

const NUMBER = /^-?(\d+(\.\d+)?(e[+-]?\d+)?|inf|nan)$/;

/** A number of the protocol: inf, nan, or as JavaScript writes it. */
const numberOf = (text) => Number(text.replace('inf', 'Infinity'));
const numbersOf = (row) => row.split(' ').map(numberOf);

/** A value of the protocol with its type: a number, true or false, or text. */
function typed(text) {
  if (NUMBER.test(text)) return numberOf(text);
  return text === 'yes' ? true : text === 'no' ? false : text;
}

// ---- words of requests ----

/** A word. Numbers are written so that the daemon reads the same number. */
const textOf = (word) => (Object.is(word, -0) ? '-0' : String(word).replace('Infinity', 'inf').replace('NaN', 'nan'));

/** The line of a request: words, and lists of words. */
const line = (...parts) => parts.flat(2).map(textOf).join(' ');

// ---- results: functions of a reply ----

const nothing = () => undefined;
const text = (key) => ({ keys }) => keys[key];
const number = (key) => ({ keys }) => (key in keys ? numberOf(keys[key]) : undefined);
const truth = (key) => ({ keys }) => keys[key] === 'yes' || keys[key] === '1';
const typedKeys = ({ keys }) => Object.fromEntries(Object.entries(keys).map(([key, word]) => [key, typed(word)]));

/** The rows, each word of the type of its letter, the last one's for the rest: i, d, s; others have that of their form. */
function table(types) {
  const reads = [...types].map((letter) => ({ i: numberOf, d: numberOf, s: String })[letter] ?? typed);
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

/** Pairs of ids as CONSTRAINB expects them. */
function idBytes(flat) {
  const ids = Uint32Array.from(flat);
  if (ids.some((id, i) => id !== flat[i])) throw new RangeError('an id is a number from 0 to 2^32 - 1');
  const bytes = Buffer.from(ids.buffer);
  return BIG_ENDIAN ? bytes.swap32() : bytes;
}

/** Numbers as LOADB expects them. They are not copied on a little-endian machine. */
function doubleBytes(flat) {
  const bytes = Buffer.from(flat.buffer, flat.byteOffset, flat.byteLength);
  return BIG_ENDIAN ? Buffer.from(bytes).swap64() : bytes;
}

module.exports = { doubleBytes, idBytes, line, nothing, number, numberOf, numbersOf, table, text, truth, typed, typedKeys, words };
