// Triangles sorted by their place, in the tiles of a grid, so that those in a part of the plane are found fast.
import { emptyBox, extend, widen } from '../data/box.js';

const TILE = 512; // triangles in a tile, about
const MOST_TILES = 128; // along each side

export class Tiles {
  /** The corners of all slots in their new order. */
  corners;
  /** {first, count, box} by first slot; the last one may have `isOpen`: it has slots that came later. */
  list;

  /** Sorts the slots of a mesh whose points are in a box. A triangle is in the tile of its first corner. */
  constructor({ corners, xy, slots }, [x0, y0, x1, y1]) {
    const side = Math.max(1, Math.min(MOST_TILES, Math.round(Math.sqrt(slots / TILE))));
    const step = (from, to, at) => Math.min(side - 1, ((at - from) * side) / (to - from)) | 0;
    const tiles = new Uint16Array(slots);
    const starts = new Uint32Array(side * side + 1);
    for (let slot = 0; slot < slots; slot++) {
      const corner = corners[3 * slot];
      tiles[slot] = step(y0, y1, xy[2 * corner + 1]) * side + step(x0, x1, xy[2 * corner]);
      starts[tiles[slot] + 1]++;
    }
    for (let t = 1; t < starts.length; t++) starts[t] += starts[t - 1];
    this.list = Array.from({ length: side * side }, (_, t) => ({ first: starts[t], count: starts[t + 1] - starts[t], box: emptyBox() }));
    this.corners = new Uint32Array(3 * slots);
    for (let slot = 0; slot < slots; slot++) {
      const to = 3 * starts[tiles[slot]]++;
      const { box } = this.list[tiles[slot]];
      for (let k = 0; k < 3; k++) {
        const corner = corners[3 * slot + k];
        this.corners[to + k] = corner;
        extend(box, xy[2 * corner], xy[2 * corner + 1]);
      }
    }
  }

  /** Makes the tiles of slots that have changed reach as far as a box. */
  change(slots, box) {
    for (const slot of slots) {
      const t = this.#tileOf(slot);
      widen(t.box, box);
      t.count = Math.max(t.count, slot - t.first + 1);
    }
  }

  #tileOf(slot) {
    let [low, high] = [0, this.list.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.list[middle].first <= slot) low = middle;
      else high = middle;
    }
    const t = this.list[low];
    if (low < this.list.length - 1 || t.isOpen || slot < t.first + t.count) return t;
    const open = { first: t.first + t.count, count: 0, box: emptyBox(), isOpen: true };
    this.list.push(open);
    return open;
  }
}
