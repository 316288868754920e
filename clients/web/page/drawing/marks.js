// Marks over the canvases, as SVG: the point and the triangle under the pointer, a drag that is refused, and other people's pointers.

const SVG = 'http://www.w3.org/2000/svg';
const ARROW = 'M0 0L5 15L12 9z';

export class Marks {
  /** {place: [x, y], triangle: [[x, y], ...] or null} under the pointer, or null. */
  picked = null;
  /** Two places: where a point that is dragged stays, and where it cannot go; or null. */
  refused = null;
  /** Map number -> [x, y] of other people's pointers. */
  pointers = new Map();
  #svg;

  constructor(svg) {
    this.#svg = svg;
  }

  /** Draws the marks for a view. */
  draw(view) {
    const parts = [];
    if (this.picked !== null) {
      const { place, triangle } = this.picked;
      const [cx, cy] = view.toScreen(...place);
      if (triangle !== null) parts.push(make('polygon', { points: triangle.map((corner) => view.toScreen(...corner)).join(' ') }));
      parts.push(make('circle', { cx, cy, r: 5 }));
    }
    if (this.refused !== null) parts.push(make('polyline', { points: this.refused.map((place) => view.toScreen(...place)).join(' ') }));
    for (const [number, place] of this.pointers) {
      const fill = `hsl(${(number * 137.508) % 360} 80% 45%)`; // hues a golden angle apart
      parts.push(make('path', { d: ARROW, fill, transform: `translate(${view.toScreen(...place).join(' ')})` }));
    }
    if (parts.length > 0 || this.#svg.hasChildNodes()) this.#svg.replaceChildren(...parts);
  }
}

function make(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}
