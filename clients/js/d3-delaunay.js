// The interface of d3-delaunay: synchronous, in process, without d3-delaunay.
'use strict';

const Delaunator = require('./delaunator.js');
const { Line } = require('./lib/line.js');
const { nextHalfedge } = require('./lib/mesh.js');
const { Corners, onto } = require('./lib/path.js');
const { Voronoi } = require('./lib/voronoi.js');

const first = (p) => p[0];
const second = (p) => p[1];

class Delaunay {
  #line = null; // of collinear points

  /** points: an array or any other iterable; fx and fy get (point, index, points). */
  static from(points, fx = first, fy = second, that = undefined) {
    const coords = [];
    const all = 'length' in points ? { length: points.length } : points;
    const add = (p, i) => coords.push(fx.call(that, p, i, points), fy.call(that, p, i, points));
    let i = 0;
    if (all === points) for (const p of points) add(p, i++);
    else for (; i < points.length; i++) add(points[i], i);
    return new Delaunay(Float64Array.from(coords));
  }

  constructor(points) {
    this._delaunator = new Delaunator(points);
    this.points = this._delaunator.coords;
    this.inedges = new Int32Array(points.length / 2);
    this._hullIndex = new Int32Array(points.length / 2);
    this.#index();
  }

  update() {
    this._delaunator.update();
    this.#index();
    return this;
  }

  /** inedges[p] is a half edge that ends at p, at the hull the one along it; _hullIndex[p] where p is in hull. */
  #index() {
    const { triangles, halfedges, hull } = Object.assign(this, {
      triangles: this._delaunator.triangles,
      halfedges: this._delaunator.halfedges,
      hull: this._delaunator.hull,
    });
    this.inedges.fill(-1);
    this._hullIndex.fill(-1);
    for (let e = 0; e < halfedges.length; e++) {
      const p = triangles[nextHalfedge(e)];
      if (halfedges[e] < 0 || this.inedges[p] < 0) this.inedges[p] = e;
    }
    hull.forEach((p, i) => {
      this._hullIndex[p] = i;
    });
    this.#line = triangles.length === 0 && hull.length > 2 ? new Line(this.points, hull) : null;
    if (this.#line !== null) this.collinear = this.#line.order;
    else delete this.collinear;
    if (hull.length === 1 || hull.length === 2) this.#indexFew();
  }

  /** One place or two places: as d3-delaunay has them. */
  #indexFew() {
    const [a, b = -1] = this.hull;
    this.triangles = Int32Array.of(a, b, b);
    this.halfedges = new Int32Array(3).fill(-1);
    this.inedges[a] = 1;
    if (b >= 0) this.inedges[b] = 0;
  }

  // ---- queries ----

  /** The neighbours of point i; none for a point that coincides with an earlier one. */
  *neighbors(i) {
    if (this.#line !== null) {
      yield* this.#line.neighbors(i);
      return;
    }
    const { inedges, triangles, halfedges, hull, _hullIndex } = this;
    const start = inedges[i];
    let last = -1;
    for (let e = start; e >= 0; ) {
      yield (last = triangles[e]);
      e = nextHalfedge(e);
      if (triangles[e] !== i) return; // one place or two
      e = halfedges[e];
      if (e === start) return;
      if (e >= 0) continue;
      const after = hull[(_hullIndex[i] + 1) % hull.length];
      if (after !== last) yield after;
    }
  }

  /** The point nearest to a place, found by a walk over ever nearer points from point i; -1 if there is none. */
  find(x, y, i = 0) {
    const n = this.points.length >> 1;
    x = +x;
    y = +y;
    if (x !== x || y !== y || n === 0) return -1;
    if (this.#line !== null) return this.#line.find(x, y);
    for (let next; (next = this._step(i, x, y)) !== i; i = next);
    return i;
  }

  /** The neighbour of i that is nearest to a place, or i itself; for a coincident point, which has none, the next point.
   * Voronoi.contains() calls it. */
  _step(i, x, y) {
    if (this.inedges[i] < 0) return (i + 1) % (this.points.length >> 1);
    let nearest = i;
    let least = this.#squareDistance(i, x, y);
    for (const p of this.neighbors(i)) {
      const d = p < 0 ? Infinity : this.#squareDistance(p, x, y);
      if (d < least) {
        least = d;
        nearest = p;
      }
    }
    return nearest;
  }

  #squareDistance(i, x, y) {
    return (this.points[2 * i] - x) ** 2 + (this.points[2 * i + 1] - y) ** 2;
  }

  voronoi(bounds) {
    return new Voronoi(this, bounds);
  }

  // ---- drawing: on a canvas's context, or else the text of an SVG path ----

  #corner(context, how, i) {
    context[how](this.points[2 * i], this.points[2 * i + 1]);
  }

  #polygon(context, corners) {
    corners.forEach((p, i) => this.#corner(context, i === 0 ? 'moveTo' : 'lineTo', p));
    context.closePath();
  }

  render(context) {
    return onto(context, (to) => {
      this.halfedges.forEach((twin, e) => {
        if (twin < e) return;
        this.#corner(to, 'moveTo', this.triangles[e]);
        this.#corner(to, 'lineTo', this.triangles[twin]);
      });
      this.renderHull(to);
    });
  }

  renderHull(context) {
    return onto(context, (to) => this.#polygon(to, this.hull));
  }

  renderTriangle(i, context) {
    return onto(context, (to) => this.#polygon(to, this.triangles.subarray(3 * i, 3 * i + 3)));
  }

  /** renderPoints(context, radius), renderPoints(radius) */
  renderPoints(context, radius) {
    if (radius === undefined && typeof context?.moveTo !== 'function') [context, radius] = [null, context];
    const r = radius == null ? 2 : +radius;
    return onto(context, (to) => {
      for (let i = 0; i + 1 < this.points.length; i += 2) {
        to.moveTo(this.points[i] + r, this.points[i + 1]);
        to.arc(this.points[i], this.points[i + 1], r, 0, 2 * Math.PI);
      }
    });
  }

  hullPolygon() {
    const corners = new Corners();
    this.renderHull(corners);
    return corners.value();
  }

  trianglePolygon(i) {
    const corners = new Corners();
    this.renderTriangle(i, corners);
    return corners.value();
  }

  *trianglePolygons() {
    for (let i = 0; 3 * i < this.triangles.length; i++) yield this.trianglePolygon(i);
  }
}

module.exports = { Delaunay, Voronoi };
