// Checks of the arguments of methods. A value that could be read in two ways, or only in part, is an error. Examples are text that looks like
// a number, 1.5 as an id, and an option that a method does not have. The package for Python has the same rules in _values.py.
'use strict';

const MOST_MS = 2 ** 31 - 1001; // timers take 2^31 - 1 milliseconds; a second is added to the limit of a request

const shown = (value) => (typeof value === 'string' ? JSON.stringify(value) : typeof value === 'bigint' ? `${value}n` : String(value));

function checkSet(name) {
  if (typeof name === 'string' && /^[A-Za-z0-9_.:-]{1,64}$/.test(name)) return name;
  throw new TypeError('a set\'s name is 1 to 64 of A-Z a-z 0-9 _ . : -');
}

function checkField(name) {
  if (typeof name === 'string' && /^[A-Za-z_][A-Za-z0-9_.:-]{0,63}$/.test(name)) return name;
  throw new TypeError('a field\'s name is a letter or _, then up to 63 of A-Z a-z 0-9 _ . : -');
}

/** A number, which may be NaN or infinite. */
function real(value) {
  if (typeof value !== 'number') throw new TypeError(`${shown(value)} is not a number`);
  return value;
}

/** A number without a fraction, which may be a BigInt; -0 is 0. */
function whole(value) {
  const number = (typeof value === 'bigint' ? Number(value) : real(value)) + 0;
  if (!Number.isSafeInteger(number)) throw new RangeError(`${shown(value)} is not a whole number`);
  return number;
}

/** A word of a request. */
function word(value) {
  if (typeof value !== 'string' || !/^\S+$/.test(value)) throw new TypeError(`${shown(value)} is not one word`);
  return value;
}

/** Each value of an array or another iterable, but not the letters of a text. */
function list(values, take) {
  if (typeof values !== 'object' || typeof values?.[Symbol.iterator] !== 'function') throw new TypeError(`${shown(values)} is not a list`);
  return Array.from(values, (value) => take(value));
}

function box(values) {
  const sides = list(values, real);
  if (sides.length !== 4) throw new RangeError('a box is x0, y0, x1, y1');
  return sides;
}

/** The name of one field, or those of several in a list. */
const fieldList = (fields) => (typeof fields === 'string' ? [checkField(fields)] : list(fields, checkField));

/** A limit of time in milliseconds. */
function milliseconds(value) {
  if (!(real(value) >= 0 && value <= MOST_MS)) throw new RangeError(`${value} is not a time from 0 to ${MOST_MS} milliseconds`);
  return value;
}

// ---- options ----

/** The words of an option with a value, or with several: none if it is undefined or null. */
const option = (keyword, value, take) => (value === undefined || value === null ? [] : [keyword, take(value)].flat());

function isTrue(name, value = false) {
  if (value === null || value === false || value === 0) return false;
  if (value !== true && value !== 1) throw new TypeError(`${name} is true or false, not ${shown(value)}`);
  return true;
}

/** The keyword of an option that is true or false. */
const flag = (keyword, value) => (isTrue(keyword.toLowerCase(), value) ? [keyword] : []);

/** Inside the border of a number, or, if it is true, inside any border. */
const inside = (value) => (typeof value === 'boolean' ? flag('INSIDE', value) : option('INSIDE', value, whole));

/** Options, which are an object and have only these names. A method calls it with what is left when it has taken its own. */
function only(options, ...names) {
  if (typeof options !== 'object') throw new TypeError(`options are an object, not ${shown(options)}`);
  const other = Object.keys(options).find((name) => !names.includes(name));
  if (other !== undefined) throw new TypeError(`there is no option ${other}`);
  return options;
}

module.exports = { box, checkField, checkSet, fieldList, flag, inside, isTrue, list, milliseconds, only, option, real, whole, word };
