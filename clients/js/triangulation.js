// A triangulation shaped like Delaunator: coords, triangles, halfedges, hull.

import { randomUUID } from 'node:crypto';

/** Three points a triangle; halfedges[e] is the half edge on the other side of e, -1 at the hull.
 *
 *              b
 *            / ^          half edge e = 3t + k runs from triangles[e] to the triangle's next corner,
 *       3t /   | 3t + 1   so e and halfedges[e] run in opposite directions along one edge.
 *         v    |
 *        c --> a
 */
function findHalfedges(triangles) {
  const n = triangles.length;
  const halfedges = new Int32Array(n).fill(-1);
  let size = 16;
  while (size < 2 * n) size *= 2;
  const table = new Int32Array(size).fill(-1); // open addressing, from an edge to one of its half edges
  const next = (e) => (e % 3 === 2 ? e - 2 : e + 1);
  for (let e = 0; e < n; e++) {
    const a = triangles[e];
    const b = triangles[next(e)];
    const low = Math.min(a, b);
    const high = Math.max(a, b);
    let slot = (Math.imul(low, 0x9e3779b1) ^ Math.imul(high, 0x85ebca77)) >>> 0;
    slot = (slot ^ (slot >>> 15)) & (size - 1);
    for (; table[slot] >= 0; slot = (slot + 1) & (size - 1)) {
      const other = table[slot];
      if (triangles[other] === b && triangles[next(other)] === a) {
        halfedges[e] = other;
        halfedges[other] = e;
        break;
      }
    }
    if (table[slot] < 0) table[slot] = e;
  }
  return halfedges;
}

export class Triangulation {
  constructor(coords, triangles, hull) {
    this.coords = coords;
    this.triangles = triangles;
    this.hull = hull;
    this.halfedges = findHalfedges(triangles);
  }

  /** Triangulates points, a flat Float64Array or pairs, in a set of its own that is dropped again. */
  static async from(points, { client, clockwise = false, getX = (p) => p[0], getY = (p) => p[1] }) {
    const coords = points instanceof Float64Array ? points : new Float64Array(2 * points.length);
    if (coords !== points) {
      points.forEach((p, i) => {
        coords[2 * i] = getX(p);
        coords[2 * i + 1] = getY(p);
      });
    }
    const set = `js.${randomUUID()}`;
    const steps = await Promise.allSettled([
      client.load(set, coords),
      client.triangulate(set),
      client.triangles(set, { clockwise }),
      client.hull(set, { clockwise }),
      client.drop(set),
    ]);
    const failed = steps.find((step) => step.status === 'rejected');
    if (failed) throw failed.reason;
    return new Triangulation(coords, steps[2].value, steps[3].value);
  }
}
