// Collinear points: neighbours, and the nearest one.
'use strict';

class Line {
  #points;
  #rank; // position of a point in that order
  #ends; // of the direction

  constructor(points, hull) {
    const at = (i) => [points[2 * i], points[2 * i + 1]];
    this.#points = points;
    this.#ends = [...at(hull[0]), ...at(hull.at(-1))];
    /** All points, coincident ones as well, along the line. */
    this.order = Int32Array.from({ length: points.length >> 1 }, (_, i) => i).sort(
      (i, j) => points[2 * i] - points[2 * j] || points[2 * i + 1] - points[2 * j + 1],
    );
    this.#rank = new Int32Array(this.order.length);
    this.order.forEach((p, k) => {
      this.#rank[p] = k;
    });
  }

  neighbors(i) {
    const k = this.#rank[i];
    return [this.order[k - 1], this.order[k + 1]].filter((p) => p !== undefined);
  }

  /** The position of a place along the line. */
  #along(x, y) {
    const [x0, y0, x1, y1] = this.#ends;
    return (x - x0) * (x1 - x0) + (y - y0) * (y1 - y0);
  }

  find(x, y) {
    const { order } = this;
    const points = this.#points;
    const along = (k) => this.#along(points[2 * order[k]], points[2 * order[k] + 1]);
    const wanted = this.#along(x, y);
    let low = 0;
    let high = order.length - 1; // the two between which the place is
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (along(middle) <= wanted) low = middle;
      else high = middle;
    }
    return order[wanted - along(low) <= along(high) - wanted ? low : high];
  }
}

module.exports = { Line };
