// Functions of a list of triangles. Three points a triangle; halfedges[e] is the half edge on the other side of e, -1 at
// the hull.
//
//              b
//            / ^          half edge e = 3t + k runs from triangles[e] to the triangle's next corner,
//       3t /   | 3t + 1   so e and halfedges[e] run in opposite directions along one edge.
//         v    |
//        c --> a
'use strict';

const nextHalfedge = (e) => (e % 3 === 2 ? e - 2 : e + 1);

/** Half edges without a twin yet are chained at the end of their edge that has fewer triangles. In a planar graph the sum
 * of the smaller degree over all edges is linear, so the cost is linear for all inputs [Chiba and Nishizeki 1985]. */
function findHalfedges(triangles, points) {
  const n = triangles.length;
  const halfedges = new Int32Array(n).fill(-1);
  const degree = new Int32Array(points);
  const first = new Int32Array(points).fill(-1);
  const chain = new Int32Array(n);
  for (let e = 0; e < n; e++) degree[triangles[e]]++;
  for (let e = 0, k = 0; e < n; e++, k = k === 2 ? 0 : k + 1) {
    const a = triangles[e];
    const b = triangles[k === 2 ? e - 2 : e + 1];
    const at = degree[a] < degree[b] || (degree[a] === degree[b] && a < b) ? a : b;
    let before = -1;
    let twin = first[at];
    while (twin >= 0 && !(triangles[twin] === b && triangles[nextHalfedge(twin)] === a)) {
      before = twin;
      twin = chain[twin];
    }
    if (twin < 0) {
      chain[e] = first[at];
      first[at] = e;
      continue;
    }
    halfedges[e] = twin;
    halfedges[twin] = e;
    if (before < 0) first[at] = chain[twin];
    else chain[before] = chain[twin];
  }
  return halfedges;
}

/** The points on the hull in the direction of the triangles, from the smallest id. */
function findHull(triangles, halfedges) {
  const after = new Map();
  let start = -1;
  for (let e = 0; e < halfedges.length; e++) {
    if (halfedges[e] >= 0) continue;
    after.set(triangles[e], triangles[nextHalfedge(e)]);
    if (start < 0 || triangles[e] < start) start = triangles[e];
  }
  const hull = new Uint32Array(after.size);
  for (let i = 0, p = start; i < hull.length; i++, p = after.get(p)) hull[i] = p;
  return hull;
}

module.exports = { findHalfedges, findHull, nextHalfedge };
