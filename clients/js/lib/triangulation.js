// A triangulation shaped like Delaunator's: coords, triangles, halfedges, hull.
'use strict';

const { randomUUID } = require('node:crypto');

const { commonClient } = require('./client.js');
const { pairs } = require('./points.js');
const { only } = require('./values.js');
const { findHalfedges, findHull } = require('./mesh.js');

/** {triangles, hull} of the points. Uses a temporary set, which the server drops even if we are killed. hull is null unless
 * there are no triangles. */
async function triangulate(client, coords, clockwise) {
  const set = `js.${randomUUID()}`;
  const created = client.request(`CREATE ${set} TEMPORARY`); // LOADB makes the set where an older server refuses this
  const steps = [client.load(set, coords), client.triangulate(set), client.triangles(set, { clockwise })];
  try {
    const [, , triangles] = await Promise.all(steps);
    return { triangles, hull: triangles.length > 0 ? null : await client.hull(set, { clockwise }) };
  } finally {
    await Promise.allSettled([created, ...steps, client.drop(set)]);
  }
}

/** The fields of a triangulation, from the result of triangulate(). */
function complete(target, { triangles, hull }, points) {
  target.triangles = triangles;
  target.halfedges = findHalfedges(triangles, points);
  target.hull = hull ?? findHull(triangles, target.halfedges);
}

class Triangulation {
  #client;
  #clockwise;

  constructor(coords, client, clockwise) {
    this.coords = coords;
    this.#client = client;
    this.#clockwise = clockwise;
  }

  /** points: flat (x, y, x, y ...), or pairs, or anything with getX and getY. */
  static async from(points, { client = commonClient(), clockwise = false, getX, getY, ...others } = {}) {
    only(others);
    const t = new Triangulation(pairs(points, getX, getY), client, clockwise);
    return t.update();
  }

  /** After a change of coords; resolves with this. */
  async update() {
    complete(this, await triangulate(this.#client, this.coords, this.#clockwise), this.coords.length / 2);
    return this;
  }
}

module.exports = { Triangulation, complete, triangulate };
