// Points as x, y one after the other.
'use strict';

/** From such an array of any kind, from pairs, or from anything with getX and getY. A Float64Array is returned as it is. */
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

/** The same, whose length must be even. */
function pairs(points, getX, getY) {
  const flat = flatten(points, getX, getY);
  if (flat.length % 2 !== 0) throw new TypeError('odd number of coordinates');
  return flat;
}

module.exports = { flatten, pairs };
