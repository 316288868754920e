// Constraints and regions as methods of the client.
'use strict';

const { idBytes, line, numberOf, typedKeys, words } = require('./framing.js');
const { column, idPairs, pairs } = require('./points.js');
const { Table } = require('./table.js');
const { checkField, checkSet, flag, inside, isTrue, list, option, real, whole } = require('./values.js');

const PLACES_A_LINE = 500; // a line may have 65536 bytes

const whichWords = ({ border, number }) => [...flag('BORDER', border), ...option('OF', number, whole)];
const released = ({ keys }) => Number(keys.released);

/** The lines of LOAD PATHS: one before each path, one for each point. columns: of each field the values of each path. */
function pathLines(paths, columns) {
  const lines = [];
  for (const { length } of columns) if (length !== paths.length) throw new RangeError(`values of ${length} paths for ${paths.length}`);
  paths.forEach((path, i) => {
    const flat = pairs(path);
    const values = columns.map((of) => column(of[i]));
    lines.push('>');
    for (const { length } of values) {
      if (2 * length !== flat.length) throw new RangeError(`${length} values for ${flat.length / 2} points of path ${i}`);
    }
    for (let k = 0; 2 * k < flat.length; k++) lines.push(line(flat[2 * k], flat[2 * k + 1], values.map((of) => of[k])));
  });
  return lines;
}

class Constraints extends Table {
  /** Declares constraints between pairs of ids, flat or not, all or none: lines, or borders; number: of the line or polygon that they
   * belong to. Resolves with {added}. split: those that cross get points in common; then with {first, added, split, deviation}. */
  async constrain(set, ends, { border, number, split, ...options } = {}) {
    const body = idBytes(idPairs(ends));
    const rest = [...whichWords({ border, number }), flag('SPLIT', split), body.length / 8];
    return typedKeys(await this._ask(['CONSTRAINB', checkSet(set), ...rest], options, body));
  }

  /** The same for the segments along a path of ids; closed: also from its last one to its first. */
  async constrainPath(set, ids, { closed, ...options } = {}) {
    const way = list(ids, whole);
    const isClosed = isTrue('closed', closed);
    if (way.length < (isClosed ? 3 : 2)) throw new RangeError('a path has at least two points, a closed one three');
    const ends = way.slice(1).map((id, i) => [way[i], id]);
    return this.constrain(set, isClosed ? [...ends, [way.at(-1), way[0]]] : ends, options);
  }

  /** Adds points until no triangle inside borders, or inside border `inside`, has an angle below `angle` degrees (25 without any limit), an
   * area above `area`, or an edge longer than `length`. keep: constraints are not divided; limit: points that may be added. Resolves with
   * {first, added, split, angle, unrefined, hull}. */
  async refine(set, { angle, area, length, inside: border, keep, limit, ...options } = {}) {
    const limits = [option('ANGLE', angle, real), option('AREA', area, real), option('LENGTH', length, real), option('LIMIT', limit, whole)];
    return typedKeys(await this._ask(['REFINE', checkSet(set), ...limits, inside(border), flag('KEEP', keep)], options));
  }

  /** Releases constraints, given as for constrain(), all or none; resolves with how many. */
  async release(set, ends, { border, number, ...options } = {}) {
    const body = idBytes(idPairs(ends));
    return released(await this._ask(['RELEASEB', checkSet(set), whichWords({ border, number }), body.length / 8], options, body));
  }

  /** Releases all constraints, or all lines, or borders, of a number; resolves with how many. */
  async releaseAll(set, { border, number, ...options } = {}) {
    const which = whichWords({ border, number });
    if (which.length === 1) throw new TypeError('border needs a number; without both, all constraints are released');
    if (which.length === 0) which.push('ALL');
    return released(await this._ask(['RELEASE', checkSet(set), which], options));
  }

  /** All constraints, those that end at one of `ids`, or those of a number: {ends: Uint32Array of pairs, border: Uint8Array, 1 for
   * borders, number: Uint32Array}, in the order of CONSTRAINTS. */
  async constraints(set, { ids = [], number, ...options } = {}) {
    const which = [list(ids, whole), option('OF', number, whole)];
    if (which.every(({ length }) => length > 0)) throw new TypeError('either ids or a number');
    const rows = words(Uint32Array, (await this._ask(['CONSTRAINTS', checkSet(set), ...which, 'BINARY'], options)).data);
    const n = rows.length / 3;
    const at = (i) => rows[3 * i + 2];
    return {
      ends: Uint32Array.from({ length: 2 * n }, (_, i) => rows[3 * (i >> 1) + (i & 1)]),
      border: Uint8Array.from({ length: n }, (_, i) => at(i) & 1),
      number: Uint32Array.from({ length: n }, (_, i) => at(i) >>> 1),
    };
  }

  /** {triangles, area, borders}: of all that is inside at least one border; and by number what is inside each, {closed, triangles, area}. */
  async regions(set, options) {
    const { keys, rows } = await this._ask(['REGIONS', checkSet(set)], options);
    const borders = new Map(rows.map((row) => row.split(' ')).map(([number, state, triangles, area]) => {
      return [Number(number), { closed: state === 'closed', triangles: Number(triangles), area: numberOf(area) }];
    }));
    return { triangles: Number(keys.inside), area: numberOf(keys.area), borders };
  }

  /** The angles of all triangles, or of those inside borders: {triangles, area, angle, largest, shortest, longest, counts}; counts[i] triangles
   * have a least angle from 5 i to 5 (i + 1) degrees. */
  async quality(set, { inside: border, ...options } = {}) {
    const { keys, rows } = await this._ask(['QUALITY', checkSet(set), inside(border)], options);
    const sizes = ['triangles', 'area', 'angle', 'largest', 'shortest', 'longest'].map((key) => [key, numberOf(keys[key])]);
    return { ...Object.fromEntries(sizes), counts: rows.map((row) => Number(row.split(' ')[2])) };
  }

  /** For each place the numbers of the borders that contain it, ascending; a place on the edge of a region belongs to it. */
  async regionsAt(set, places, { getX, getY, ...options } = {}) {
    const flat = pairs(places, getX, getY);
    const asked = [];
    for (let at = 0; at < flat.length; at += 2 * PLACES_A_LINE) {
      asked.push(this._ask(['REGIONS', checkSet(set), 'AT', [...flat.subarray(at, at + 2 * PLACES_A_LINE)]], options));
    }
    return (await Promise.all(asked)).flatMap(({ rows }) => rows.map((row) => row.split(' ').slice(1).map(Number)));
  }

  /** Adds the points of paths, flat or pairs, and the constraints along them, as one change. A path whose last place equals its first is
   * closed. The first path gets `number`, the others the numbers after it. fields: {name: [the values of each path]}. Resolves with
   * {first, added, coincident, constraints}, and if `split` is true also {split, deviation}. */
  async loadPaths(set, paths, { border, number, split, fields = {}, ...options } = {}) {
    const names = Object.keys(fields).map(checkField);
    const lines = pathLines([...paths], Object.values(fields));
    const rest = ['PATHS', ...whichWords({ border, number }), flag('SPLIT', split), names.length > 0 ? ['FIELDS', names.join(',')] : []];
    const body = Buffer.from(lines.map((text) => `${text}\n`).join(''));
    return typedKeys(await this._ask(['LOAD', checkSet(set), lines.length, ...rest], options, body));
  }
}

module.exports = { Constraints };
