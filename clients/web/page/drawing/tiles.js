// Triangles sorted by their place, in the tiles of a grid, and in each tile by size, the largest first. So the triangles in view are
// found fast, and of each tile the first ones, which are large enough to be seen.

const TILE = 512; // triangles in a tile, about
const MOST_TILES = 128; // along each side
const SIZES = 17; // classes of sizes: each half as large as the one before

/** Makes the box least[k], least[k + 1] to most[k], most[k + 1] contain a place. */
function extend(least, most, k, place) {
  const x = place >>> 16;
  const y = place & 65535;
  if (x < least[k]) least[k] = x;
  if (x > most[k]) most[k] = x;
  if (y < least[k + 1]) least[k + 1] = y;
  if (y > most[k + 1]) most[k + 1] = y;
}

const extent = (a, b, c) => Math.max(a, b, c) - Math.min(a, b, c);

const NOWHERE = [Infinity, Infinity, -Infinity, -Infinity];

export class Tiles {
  /** The corners of all slots in their new order. */
  corners;
  /** {first, count, box} by first slot; the last one may be `open`: slots that came later. */
  list;
  #starts; // the first slot of each class of sizes of each tile
  #step; // of the grid of places, in units, where its steps are larger
  #area; // of a tile

  /** Sorts the slots of a mesh that lies in a box. Corners are in no order of places, so what is read of each is four bytes: its place on
   * a grid of 65536 by 65536. */
  constructor(mesh, [x0, y0, x1, y1]) {
    const side = Math.max(1, Math.min(MOST_TILES, Math.round(Math.sqrt(mesh.slots / TILE))));
    const { corners, xy, ids, slots } = mesh;
    const [sx, sy] = [65535 / (x1 - x0), 65535 / (y1 - y0)];
    this.#step = Math.max(1 / sx, 1 / sy);
    this.#area = ((x1 - x0) * (y1 - y0)) / (side * side);
    const [kx, ky] = [1 / sx / this.#step, 1 / sy / this.#step];
    const places = new Uint32Array(ids);
    for (let id = 0; id < ids; id++) places[id] = (((xy[2 * id] - x0) * sx) << 16) | ((xy[2 * id + 1] - y0) * sy);
    const each = side / 65536 / 3;
    const classOf = new Uint32Array(slots);
    const starts = new Uint32Array(SIZES * side * side + 1);
    const least = new Uint16Array(2 * side * side).fill(65535);
    const most = new Uint16Array(2 * side * side);
    for (let slot = 0; slot < slots; slot++) {
      const a = places[corners[3 * slot]];
      const b = places[corners[3 * slot + 1]];
      const c = places[corners[3 * slot + 2]];
      const column = ((a >>> 16) + (b >>> 16) + (c >>> 16)) * each;
      const row = ((a & 65535) + (b & 65535) + (c & 65535)) * each;
      const t = (row | 0) * side + (column | 0);
      const size = Math.max(extent(a >>> 16, b >>> 16, c >>> 16) * kx, extent(a & 65535, b & 65535, c & 65535) * ky);
      classOf[slot] = SIZES * t + Math.clz32(size) - 16;
      starts[classOf[slot] + 1]++;
      extend(least, most, 2 * t, a);
      extend(least, most, 2 * t, b);
      extend(least, most, 2 * t, c);
    }
    for (let k = 1; k < starts.length; k++) starts[k] += starts[k - 1];
    const next = starts.slice();
    const sorted = new Uint32Array(3 * slots);
    for (let slot = 0; slot < slots; slot++) {
      const to = 3 * next[classOf[slot]]++;
      sorted[to] = corners[3 * slot];
      sorted[to + 1] = corners[3 * slot + 1];
      sorted[to + 2] = corners[3 * slot + 2];
    }
    // A step more on each side, for what was rounded.
    const at = ([x, y], step) => [x0 + (x + step) / sx, y0 + (y + step) / sy];
    const boxOf = (t) => [...at(least.subarray(2 * t), -1), ...at(most.subarray(2 * t), 2)];
    this.#starts = starts;
    this.corners = sorted;
    this.list = Array.from({ length: side * side }, (_, t) => {
      const first = starts[SIZES * t];
      const count = starts[SIZES * (t + 1)] - first;
      return { first, count, box: count > 0 ? boxOf(t) : [...NOWHERE], sizes: SIZES * t };
    });
  }

  /** Returns how many of the first slots of a tile have all triangles longer than `pixels` pixels, and some of more than half that
   * length. A unit of the plane has `unit` pixels. Triangles that events have put into slots since may be larger or smaller. */
  large({ first, count, sizes, open }, pixels, unit) {
    const bits = Math.floor(Math.log2(pixels / (unit * this.#step)));
    if (open || bits < 0) return count;
    return bits >= 16 ? 0 : this.#starts[sizes + 16 - bits] - first;
  }

  /** The pixels that a tile has on the screen. */
  pixels(unit) {
    return this.#area * unit * unit;
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
    if (low < this.list.length - 1 || t.open) return t;
    if (slot < t.first + t.count) return t;
    const open = { first: t.first + t.count, count: 0, box: [...NOWHERE], open: true };
    this.list.push(open);
    return open;
  }
}

/** Makes a box contain another one. */
export function widen(box, [x0, y0, x1, y1]) {
  if (x0 < box[0]) box[0] = x0;
  if (y0 < box[1]) box[1] = y0;
  if (x1 > box[2]) box[2] = x1;
  if (y1 > box[3]) box[3] = y1;
}

export const meets = (a, b) => a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3];
