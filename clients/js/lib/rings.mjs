// The rows of an event of WATCH, and the triangles that rings contain: for mirror.mjs, and for the page in clients/web, which a browser
// runs. A ring is {inner, ring}: the neighbours of a point counterclockwise. The ring of an inner point goes all around it, the ring of
// a boundary point from the next point on the hull to the previous one.

/** The parts of an event, gathered row by row: the last row about an id counts, and the row of a point ends what was said of its ring
 * before. */
export class Gathered {
  reset = false;
  points = new Map(); // id -> [x, y, value ...]
  rings = new Map(); // id -> {inner, ring}
  gone = new Set(); // ids
  constraints = new Map(); // `a b kind k` -> {a, b, border, number}, of a box with places; null: released

  add({ reset, rows }) {
    if (reset) {
      this.reset = true;
      for (const of of [this.points, this.rings, this.gone, this.constraints]) of.clear();
    }
    for (const row of rows) this.#row(row.split(' '));
  }

  #row([kind, first, ...words]) {
    const id = Number(first);
    if (kind === 'point') {
      this.points.set(id, words.map(Number)); // Number('nan') is NaN
      this.rings.delete(id);
      this.gone.delete(id);
    } else if (kind === 'list') {
      this.rings.set(id, { inner: words[0] === 'i', ring: words.slice(1).map(Number) });
    } else if (kind === 'gone') {
      this.points.delete(id);
      this.rings.delete(id);
      this.gone.add(id);
    } else if (kind === 'constraint' || kind === 'released') {
      this.#constraint(kind === 'constraint', id, words);
    }
  }

  #constraint(isDeclared, a, [b, kind, number, ...places]) {
    const constraint = { a, b: Number(b), border: kind === 'border', number: Number(number) };
    if (places.length > 0) constraint.places = places.map(Number);
    this.constraints.set(`${a} ${b} ${kind} ${number}`, isDeclared ? constraint : null);
  }

  /** All ids that it is about. */
  ids() {
    return new Set([...this.points.keys(), ...this.rings.keys(), ...this.gone]);
  }
}

/** Calls found(a, b, c) once for each triangle at a point of `rings`, a Map. The corners are counterclockwise, from the smallest of
 * those in `rings`. ringOf(id) is the ring of any point, undefined if unknown.
 *
 * Two points of a ring that follow each other make a triangle with its point, unless all points are on a line. On a line a ring has
 * two points, which are no neighbours. If both of their rings are unknown, isTriangle(id, a, b) decides. */
export function eachTriangle(rings, ringOf, isTriangle, found) {
  for (const [id, { inner, ring }] of rings) {
    if (!inner && ring.length === 2 && !areJoined(id, ring, ringOf, isTriangle)) continue;
    for (let k = inner ? 0 : 1; k < ring.length; k++) {
      const a = ring[k === 0 ? ring.length - 1 : k - 1];
      const b = ring[k];
      if ((a < id && rings.has(a)) || (b < id && rings.has(b))) continue; // found there
      found(id, a, b);
    }
  }
}

function areJoined(id, [a, b], ringOf, isTriangle) {
  const [one, other] = [ringOf(a)?.ring, ringOf(b)?.ring];
  if (one === undefined && other === undefined) return isTriangle(id, a, b);
  const isShorter = other === undefined || one?.length <= other.length; // one of them may be that of a hub
  return isShorter ? one.includes(b) : other.includes(a);
}

/** Whether rings contain the triangle a, b, c, counterclockwise. Cost: linear in the shortest of its points' rings, so linear for all
 * triangles together: few triangles have long rings at all corners. */
export function hasTriangle(a, b, c, ringOf, isTriangle) {
  let [best, from, to] = [undefined, b, c];
  let at = a;
  for (const [id, x, y] of [
    [a, b, c],
    [b, c, a],
    [c, a, b],
  ]) {
    const known = ringOf(id);
    if (known !== undefined && !(best?.ring.length <= known.ring.length)) [best, at, from, to] = [known, id, x, y];
  }
  if (best === undefined) return false;
  const { inner, ring } = best;
  const k = ring.indexOf(from);
  if (k < 0 || (k + 1 === ring.length && !inner) || ring[(k + 1) % ring.length] !== to) return false;
  return inner || ring.length > 2 || areJoined(at, ring, ringOf, isTriangle);
}
