// Points as x, y one after the other.
'use strict';

const { list, real } = require('./values.js');

function pairOf(point) {
  if (point?.length !== 2) throw new TypeError('a point is a pair of coordinates; getX and getY take them of other points');
  return point;
}

/** From such an array of any kind, from pairs, or from anything with getX and getY. A Float64Array is returned as it is. */
function flatten(points, getX, getY) {
  if (getX === undefined && getY === undefined) {
    if (points instanceof Float64Array) return points;
    if (ArrayBuffer.isView(points) && !(points instanceof DataView)) return Float64Array.from(points);
    if (Array.isArray(points) && typeof points[0] === 'number') return Float64Array.from(points, real);
  }
  const x = getX ?? ((p) => pairOf(p)[0]);
  const y = getY ?? ((p) => pairOf(p)[1]);
  const flat = [];
  for (const p of points) flat.push(real(x(p)), real(y(p)));
  return Float64Array.from(flat);
}

/** The same, whose length must be even. */
function pairs(points, getX, getY) {
  const flat = flatten(points, getX, getY);
  if (flat.length % 2 !== 0) throw new TypeError('odd number of coordinates');
  return flat;
}

/** Values of points; NaN where one is missing. */
function column(values) {
  if (values instanceof Float64Array) return values;
  if (ArrayBuffer.isView(values) && !(values instanceof DataView)) return Float64Array.from(values);
  return Float64Array.from(list(values, real));
}

module.exports = { column, flatten, pairs };
