// The interface of Delaunator: synchronous, in process, triangles clockwise in a plane whose y axis points up.
'use strict';

const { withSet } = require('./lib/core.js');

const CLOCKWISE = 1;
const HULL = 5; // enum dt_table

const first = (p) => p[0];
const second = (p) => p[1];

class Delaunator {
  static from(points, getX = first, getY = second) {
    const coords = new Float64Array(2 * points.length);
    for (let i = 0; i < points.length; i++) {
      coords[2 * i] = getX(points[i]);
      coords[2 * i + 1] = getY(points[i]);
    }
    return new Delaunator(coords);
  }

  /** The server is that of Triangulation.from(). */
  static useServer() {
    throw new Error('Delaunator computes in this process and uses no server; useServer() is for Triangulation.from()');
  }

  constructor(coords) {
    if (!(coords.length >= 0)) throw new RangeError(`Invalid typed array length: ${coords.length}`);
    if (coords.length > 1 && typeof coords[0] !== 'number') throw new Error('Expected coords to contain numbers.');
    this.coords = coords;
    this.update();
  }

  /** After a change of coords. */
  update() {
    const { coords } = this;
    withSet(coords, (core, set) => {
      core.call('set_triangles', set, CLOCKWISE);
      this.triangles = core.array(Uint32Array, 0);
      this.halfedges = core.array(Int32Array, 1);
      core.call('set_table', set, HULL, CLOCKWISE);
      this.hull = core.array(Uint32Array, 0);
    });
    this.trianglesLen = this.triangles.length;
    if (this.trianglesLen === 0 && this.#before(this.hull.at(-1), this.hull[0])) this.hull.reverse();
  }

  /** Collinear points are in the order of x, or of y where x is the same. */
  #before(i, j) {
    const { coords } = this;
    return coords[2 * i] - coords[2 * j] < 0 || (coords[2 * i] === coords[2 * j] && coords[2 * i + 1] < coords[2 * j + 1]);
  }
}

Delaunator.default = Delaunator; // for what compilers make of `import Delaunator`

module.exports = Delaunator;
