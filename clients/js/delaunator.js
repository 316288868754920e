// The interface of Delaunator: synchronous, triangles clockwise in a plane whose y axis points up.
'use strict';

const { useServer, triangulateSync } = require('./lib/sync.js');
const { complete } = require('./lib/triangulation.js');

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

  constructor(coords) {
    if (!(coords.length >= 0)) throw new RangeError(`Invalid typed array length: ${coords.length}`);
    if (coords.length > 1 && typeof coords[0] !== 'number') throw new Error('Expected coords to contain numbers.');
    this.coords = coords;
    this.update();
  }

  /** After a change of coords. */
  update() {
    const n = this.coords.length >> 1;
    const result = triangulateSync(this.coords.length === 2 * n ? this.coords : this.coords.slice(0, 2 * n));
    complete(this, result, n);
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
Delaunator.useServer = useServer;

module.exports = Delaunator;
