// Points as x, y one after the other.
'use strict';

const { list, real, whole } = require('./values.js');

/** A point x, y, which may have more coordinates, such as a height. */
function pairOf(point) {
  if (!(point?.length >= 2)) throw new TypeError('a point is a pair of coordinates; getX and getY take them of other points');
  return point;
}

/** From such an array of any kind, from pairs, or from anything with getX and getY. A Float64Array is returned as it is; take: checks others. */
function flatten(points, getX, getY, take) {
  if (getX === undefined && getY === undefined) {
    const [first, isView] = [typeof points?.[0], ArrayBuffer.isView(points)];
    if (points instanceof Float64Array) return points;
    if (isView && first === 'number') return Float64Array.from(points);
    if ((isView || Array.isArray(points)) && (first === 'number' || first === 'bigint')) return Float64Array.from(points, take);
  }
  const x = getX ?? ((p) => pairOf(p)[0]);
  const y = getY ?? ((p) => pairOf(p)[1]);
  const flat = [];
  for (const p of points) flat.push(take(x(p)), take(y(p)));
  return Float64Array.from(flat);
}

/** The same, whose length must be even. */
function pairs(points, getX, getY, take = real) {
  const flat = flatten(points, getX, getY, take);
  if (flat.length % 2 !== 0) throw new TypeError('odd number of coordinates');
  return flat;
}

/** Ids, flat or as pairs. */
const idPairs = (ends) => pairs(ends, undefined, undefined, whole);

/** Values of points; NaN where one is missing. */
function column(values) {
  if (values instanceof Float64Array) return values;
  if (ArrayBuffer.isView(values) && !(values instanceof DataView)) return Float64Array.from(values);
  return Float64Array.from(list(values, real));
}

module.exports = { column, idPairs, pairs };
