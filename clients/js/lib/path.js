// The drawing targets of Delaunay without a canvas: text for the attribute d of an SVG path, or the corners of a polygon.
'use strict';

class SvgPath {
  #text = '';
  #at = null; // where the pen is

  moveTo(x, y) {
    this.#at = [x, y];
    this.#text += `M${x},${y}`;
  }

  lineTo(x, y) {
    this.#at = [x, y];
    this.#text += `L${x},${y}`;
  }

  /** A whole circle, which begins and ends at its rightmost point. */
  arc(x, y, r) {
    if (this.#at === null || this.#at[0] !== x + r || this.#at[1] !== y) this[this.#at === null ? 'moveTo' : 'lineTo'](x + r, y);
    if (r > 0) this.#text += `A${r},${r},0,1,1,${x - r},${y}A${r},${r},0,1,1,${x + r},${y}`;
  }

  rect(x, y, width, height) {
    this.#at = [x, y];
    this.#text += `M${x},${y}h${width}v${height}h${-width}Z`;
  }

  closePath() {
    if (this.#at !== null) this.#text += 'Z';
  }

  value() {
    return this.#text === '' ? null : this.#text;
  }
}

class Corners {
  #corners = [];

  moveTo(x, y) {
    this.#corners.push([x, y]);
  }

  lineTo(x, y) {
    this.#corners.push([x, y]);
  }

  closePath() {
    if (this.#corners.length > 0) this.#corners.push([...this.#corners[0]]);
  }

  value() {
    return this.#corners.length === 0 ? null : this.#corners;
  }
}

/** Calls draw with the context, or without one with an SVG path, whose text is then the result. */
function onto(context, draw) {
  const path = context == null ? new SvgPath() : null;
  draw(context ?? path);
  return path?.value();
}

module.exports = { Corners, onto };
