// The interface of earcut: the triangles of a polygon with holes, exact. Synchronous, in process.
'use strict';

const { findCore, withPlaces } = require('./lib/core.js');

/** The first two coordinates of each corner, and then where each ring ends. */
function numbersOf(data, holeIndices, dim) {
  const corners = Math.floor(data.length / dim);
  const holes = holeIndices?.length ?? 0;
  const numbers = new Float64Array(2 * corners + holes + 1);
  if (dim === 2) numbers.set(data.length === 2 * corners ? data : Array.prototype.slice.call(data, 0, 2 * corners));
  else {
    for (let i = 0; i < corners; i++) {
      numbers[2 * i] = data[dim * i];
      numbers[2 * i + 1] = data[dim * i + 1];
    }
  }
  for (let i = 0; i <= holes; i++) numbers[2 * corners + i] = i < holes ? holeIndices[i] : corners;
  return { numbers, corners, rings: holes + 1 };
}

/** data: the coordinates of all corners, dim for each, of which the first two count; holeIndices: the corners where holes begin.
 * Returns three corners for each triangle. A place is inside if it is enclosed an odd number of times. No triangles are exact if sides cross
 * between corners. Then the result is the triangles whose centroid is inside. */
function earcut(data, holeIndices, dim = 2) {
  const { numbers, corners, rings } = numbersOf(data, holeIndices, dim);
  const core = findCore();
  withPlaces(numbers, () => core.callNumbers(Float64Array, numbers, (address) => core.call('polygon', address, corners, rings)));
  return toArray(core.array(Uint32Array, 0));
}

/** The same numbers. Array.from() takes fifteen times as long. */
function toArray(numbers) {
  const array = new Array(numbers.length);
  for (let i = 0; i < numbers.length; i++) array[i] = numbers[i];
  return array;
}

/** Twice the area of a ring, positive if it is counterclockwise where y points up. */
function ringArea(data, from, to, dim) {
  let sum = 0;
  for (let i = from, j = to - dim; i < to; j = i, i += dim) sum += (data[j] - data[i]) * (data[i + 1] + data[j + 1]);
  return sum;
}

/** The relative difference between the area of the triangles and the area of the polygon. */
earcut.deviation = (data, holeIndices, dim, triangles) => {
  const begins = [0, ...(holeIndices ?? []).map((i) => i * dim), data.length];
  const area = (i) => Math.abs(ringArea(data, begins[i], begins[i + 1], dim));
  let polygon = area(0);
  for (let i = 1; i + 1 < begins.length; i++) polygon -= area(i);
  let all = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => triangles[i + k] * dim);
    all += Math.abs((data[a] - data[c]) * (data[b + 1] - data[a + 1]) - (data[a] - data[b]) * (data[c + 1] - data[a + 1]));
  }
  return polygon === 0 && all === 0 ? 0 : Math.abs((all - polygon) / polygon);
};

/** The rings of a GeoJSON polygon, the outer one first, as arguments: {vertices, holes, dimensions}. */
earcut.flatten = (rings) => {
  const dimensions = rings[0][0].length;
  const vertices = [];
  const holes = [];
  for (const ring of rings) {
    if (ring !== rings[0]) holes.push(vertices.length / dimensions);
    for (const corner of ring) for (let d = 0; d < dimensions; d++) vertices.push(corner[d]);
  }
  return { vertices, holes, dimensions };
};

/** Does nothing: every edge of earcut()'s triangles is a side or Delaunay already. */
earcut.refine = (triangles, vertices) => {};

earcut.default = earcut; // for what compilers make of `import earcut`

module.exports = earcut;
