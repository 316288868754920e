// The part of the plane that is shown: a centre, and how many pixels a unit has. y points up in the plane and down on the screen.

export class View {
  x = 0;
  y = 0;
  scale = 1; // pixels of the screen per unit
  width = 1; // of the screen, in pixels
  height = 1;

  resize(width, height) {
    this.width = width;
    this.height = height;
  }

  /** A View as this one is now. */
  copy() {
    return Object.assign(new View(), this);
  }

  equals({ x, y, scale, width, height }) {
    return x === this.x && y === this.y && scale === this.scale && width === this.width && height === this.height;
  }

  /** The CSS transform that brings what was drawn for another view to its place in this one. */
  transformOf(drawn) {
    const factor = this.scale / drawn.scale;
    const left = (drawn.x - this.x) * this.scale + this.width / 2 - (factor * drawn.width) / 2;
    const top = (this.y - drawn.y) * this.scale + this.height / 2 - (factor * drawn.height) / 2;
    return `translate(${left}px, ${top}px) scale(${factor})`;
  }

  /** Shows a box [x0, y0, x1, y1] whole, with a margin. */
  fit([x0, y0, x1, y1]) {
    this.x = x0 / 2 + x1 / 2;
    this.y = y0 / 2 + y1 / 2;
    const scale = Math.min((0.92 * this.width) / (x1 - x0), (0.92 * this.height) / (y1 - y0));
    this.scale = Number.isFinite(scale) && scale > 0 ? scale : Math.min(this.width, this.height) / 2;
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  toPlane(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  /** The box of the plane on the screen, with `margin` times its width and height more on each side. */
  box(margin = 0) {
    const [x0, y1] = this.toPlane(-margin * this.width, -margin * this.height);
    const [x1, y0] = this.toPlane((1 + margin) * this.width, (1 + margin) * this.height);
    return [x0, y0, x1, y1];
  }

  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** Zooms by a factor; the point at this place of the screen stays at this place. */
  zoom(factor, px, py) {
    const [x, y] = this.toPlane(px, py);
    this.scale *= factor;
    const [qx, qy] = this.toScreen(x, y);
    this.pan(px - qx, py - qy);
  }
}
