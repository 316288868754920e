// The interface of Constrainautor: edges that a triangulation like Delaunator's has to keep. Synchronous, in process.
'use strict';

const { nextHalfedge } = require('./lib/mesh.js');
const { LiveSet } = require('./live.js');

const CLOCKWISE = { clockwise: true };

/** Writes the numbers into the same array if it has as many. */
function replace(del, name, numbers) {
  if (del[name].length === numbers.length) del[name].set(numbers);
  else del[name] = numbers;
}

class Constrainautor {
  #set;
  #declared = new Set(); // edges as #key() has them
  #fixed = new Set(); // the same of the edges in the triangulation
  #ending = null; // by point: a half edge that ends there, at the hull the one along it, -1: none; null: to be found

  /** del: what Delaunator makes, which is modified; edges: pairs of points. */
  constructor(del, edges) {
    if (!del?.triangles || !del.halfedges || !del.coords) throw new Error('Expected an object with Delaunator output');
    if (del.triangles.length % 3 || del.halfedges.length !== del.triangles.length || del.coords.length % 2) {
      throw new Error('Delaunator output appears inconsistent');
    }
    if (del.triangles.length < 3) throw new Error('No edges in triangulation');
    this.del = del;
    this.#set = LiveSet.from(del.coords);
    if (edges) this.constrainAll(edges);
  }

  #key(a, b) {
    const points = this.del.coords.length / 2;
    return a < b ? a * points + b : b * points + a;
  }

  /** Returns the half edge from p1 to p2, or minus the one from p2 to p1; its number is valid until the next call. */
  constrainOne(p1, p2) {
    this.constrainAll([[p1, p2]]);
    return this.findEdge(p1, p2);
  }

  /** All or none; much faster than one by one. */
  constrainAll(edges) {
    const more = Array.from(edges).filter(([a, b]) => !this.#declared.has(this.#key(a, b)));
    this.#constrain(more);
    const fixed = this.#set.constrainedEdges();
    const keys = new Set();
    for (let i = 0; i < fixed.length; i += 2) keys.add(this.#key(fixed[i], fixed[i + 1]));
    if (!more.every(([a, b]) => keys.has(this.#key(a, b)))) {
      this.#set.release(more);
      throw new Error('Constraining edge intersects point');
    }
    for (const [a, b] of more) this.#declared.add(this.#key(a, b));
    this.#fixed = keys;
    this.#update();
    return this;
  }

  #constrain(edges) {
    const lost = new Set(edges.length > 0 ? this.untriangulatedPoints() : []);
    if (edges.some((ends) => ends.some((p) => lost.has(p)))) throw new Error('Cannot constrain between points that are not triangulated');
    try {
      this.#set.constrain(edges);
    } catch (error) {
      throw error.code === 'CROSSES' ? new Error('Edge intersects already constrained edge', { cause: error }) : error;
    }
  }

  #update() {
    const { triangles, halfedges } = this.#set.triangulation(CLOCKWISE);
    replace(this.del, 'triangles', triangles);
    replace(this.del, 'halfedges', halfedges);
    this.#ending = null;
  }

  /** Every edge that is not constrained is Delaunay already. */
  delaunify() {
    return this;
  }

  isConstrained(edg) {
    const { triangles } = this.del;
    return this.#fixed.has(this.#key(triangles[edg], triangles[nextHalfedge(edg)]));
  }

  /** The half edge from p1 to p2; minus the one from p2 to p1 if that is the only one, at the hull; Infinity: there is none. */
  findEdge(p1, p2) {
    const { triangles, halfedges } = this.del;
    this.#ending ??= this.#findEnding();
    const start = this.#ending[p2] ?? -1;
    for (let e = start; e >= 0; ) {
      if (triangles[e] === p1) return e;
      const leaving = nextHalfedge(e);
      e = halfedges[leaving];
      if (e === start) break;
      if (e < 0 && triangles[nextHalfedge(leaving)] === p1) return -leaving;
    }
    return Infinity;
  }

  #findEnding() {
    const { triangles, halfedges, coords } = this.del;
    const ending = new Int32Array(coords.length / 2).fill(-1);
    for (let e = 0; e < triangles.length; e++) {
      const p = triangles[nextHalfedge(e)];
      if (halfedges[e] < 0 || ending[p] < 0) ending[p] = e;
    }
    return ending;
  }

  /** Points that coincide with earlier points. */
  untriangulatedPoints() {
    return Array.from(this.#set.coincident()).filter((_, i) => i % 2 === 0);
  }
}

Constrainautor.default = Constrainautor; // for what compilers make of `import Constrainautor`

module.exports = Constrainautor;
