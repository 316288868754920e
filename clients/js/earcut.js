// The interface of earcut: the triangles of a polygon with holes, exact. Synchronous, in process.
'use strict';

const { LiveSet } = require('./live.js');

/** The sides of a ring of the corners from .. to - 1, as pairs. */
function addSides(pairs, from, to) {
  for (let i = from; to - from > 2 && i < to; i++) pairs.push([i, i + 1 < to ? i + 1 : from]);
}

/** data: the coordinates of all corners, dim for each, of which the first two count; holeIndices: the corners where holes begin.
 * Returns three corners for each triangle. A place is inside if it is enclosed an odd number of times. */
function earcut(data, holeIndices, dim = 2) {
  const corners = Math.floor(data.length / dim);
  const coords = Float64Array.from({ length: 2 * corners }, (_, i) => data[(i >> 1) * dim + (i & 1)]);
  const begins = [0, ...(holeIndices ?? []), corners];
  const sides = [];
  for (let i = 0; i + 1 < begins.length; i++) addSides(sides, begins[i], begins[i + 1]);
  const set = LiveSet.from(coords);
  try {
    set.constrain(sides, { border: true });
    return sides.length === 0 ? [] : Array.from(set.inside());
  } finally {
    set.free();
  }
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

earcut.default = earcut; // for what compilers make of `import earcut`

module.exports = earcut;
