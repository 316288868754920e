// Lines over the triangles that are asked for: hull and constraints, Voronoi cells, contours, and triangles that reach out of a mesh that
// covers only a box. Each is asked for again when the set has changed, or when the view has left the box it was asked for.
import { contains, emptyBox, extend } from '../data/box.js';
import { placesOf } from '../data/sample.js';
import { stepOf } from './steps.js';

const MOST_CELLS = 20000; // in the box they are asked for; more would be nothing but lines
const MOST_HULL = 100000; // points on the hull, for it to be shown
const MARGIN = 1; // of the box around the view, in views on each side
const EVERYWHERE = [-Infinity, -Infinity, Infinity, Infinity];

export class Lines {
  #known; // layer -> {key, box}: of what and for which box its lines are
  #turn = 0; // how often it was cleared: lines that come later are not those of the set

  constructor() {
    this.clear();
  }

  clear() {
    /** Lines of each layer: coordinates x, y, ..., and whether it is closed; cells have an id and a box, too. */
    Object.assign(this, { hull: [], cells: [], contours: [], reaching: [] });
    this.constraints = []; // pairs of ids
    this.isConstrained = false;
    this.#known = new Map();
    this.#turn++;
  }

  /** All lines are to be asked for again: the mesh is another one. */
  forget() {
    this.#known.clear();
  }

  /** Asks for the layers that are shown and not known. `layers` says which are shown. set: {name, version, field, hull, mesh, kind},
   * hull: points on the hull, kind: what the mesh is, as a Follower has it. Returns a text of the layers that cannot be shown. */
  async refresh(fetchAll, view, layers, set) {
    const { name, field, mesh, kind } = set;
    const isWhole = kind === 'whole';
    const notes = [];
    const update = (layer, margin, get) => this.#update(layer, [set.version, field?.name, kind].join(' '), view, margin, get);
    if ((layers.hull || layers.triangles) && set.hull <= MOST_HULL) {
      await update('hull', null, async () => {
        const [around, edges] = await fetchAll([`HULL ${name}`, ...(isWhole ? [`EDGES ${name} CONSTRAINED`] : [])]);
        return { hull: hullOf(around.rows), constraints: edges?.rows.map((row) => row.split(' ').map(Number)) ?? [] };
      });
    }
    if (layers.cells) {
      const margin = kind === 'sample' ? undefined : [MARGIN, 0].find((m) => mesh.countIn(view.box(m)) <= MOST_CELLS);
      if (margin === undefined) notes.push('zoom in for Voronoi cells');
      else await update('cells', margin, (box) => cellsIn(fetchAll, name, box));
      if (margin === undefined) this.cells = [];
      else if (this.isConstrained) notes.push('a set with constraints has no Voronoi cells');
    }
    if (layers.contours && field !== null) {
      const step = stepOf(field);
      const get = async () => ({ contours: (await fetchAll([`CONTOUR ${name} ${field.name} EVERY ${step}`]))[0].rows.map(contourOf) });
      if (isWhole && step > 0) await update('contours', null, get);
      if (step > 0) notes.push(isWhole ? `contours every ${step}` : 'the set is too large for contours');
    }
    if (kind === 'box') await update('reaching', 0, async (box) => ({ reaching: await reachingOut(fetchAll, name, box, mesh) }));
    else this.reaching = [];
    return notes.join('; ');
  }

  /** Gets the lines of a layer from get(box), unless those with this key are known for a box around the view. margin: of the box that is
   * asked for; null: everywhere. */
  async #update(layer, key, view, margin, get) {
    const known = this.#known.get(layer);
    if (known?.key === key && contains(known.box, view.box())) return;
    const turn = this.#turn;
    const box = margin === null ? EVERYWHERE : view.box(margin);
    const lines = await get(box.join(' '));
    if (turn !== this.#turn) return;
    this.#known.set(layer, { key, box });
    Object.assign(this, lines);
  }
}

/** The triangles that meet a box and have a corner that the mesh does not have. */
async function reachingOut(fetchAll, set, box, mesh) {
  const [{ data }] = await fetchAll([`TRIANGLES ${set} WITHIN ${box} BINARY`]);
  const corners = new Uint32Array(data.buffer);
  const reaching = [];
  for (let k = 0; k < corners.length; k += 3) {
    const three = [...corners.subarray(k, k + 3)];
    if (!three.every((id) => mesh.hasPoint(mesh.numberOf(id)))) reaching.push(three);
  }
  if (reaching.length === 0) return [];
  const places = await placesOf(fetchAll, set, new Set(reaching.flat()), null);
  const whole = reaching.filter((three) => three.every((id) => places.has(id)));
  return whole.map((three) => ({ closed: true, places: three.flatMap((id) => places.get(id).slice(0, 2)) }));
}

const hullOf = (rows) => [{ closed: true, places: rows.flatMap((row) => row.split(' ').slice(1).map(Number)) }];

/** The cells in a box; there are none in a set with constraints. */
async function cellsIn(fetchAll, set, box) {
  try {
    return { cells: cellsOf((await fetchAll([`VORONOI ${set} BOX ${box} BINARY`]))[0].data), isConstrained: false };
  } catch (error) {
    if (error.code !== 'NOTDELAUNAY') throw error;
    return { cells: [], isConstrained: true };
  }
}

/** A row of CONTOUR: `level closed|open k x1 y1 ...`. */
function contourOf(row) {
  const [, kind, , ...places] = row.split(' ');
  return { closed: kind === 'closed', places: places.map(Number) };
}

/** The binary reply to VORONOI: id and k, k corners; the numbers of a cell begin at multiples of 8 bytes. */
function cellsOf(data) {
  const cells = [];
  const [words, numbers] = [new Uint32Array(data.buffer), new Float64Array(data.buffer)];
  for (let at = 0; at < numbers.length; ) {
    const [id, corners] = words.subarray(2 * at, 2 * at + 2);
    const places = numbers.subarray(at + 1, at + 1 + 2 * corners);
    const box = emptyBox();
    for (let k = 0; k < places.length; k += 2) extend(box, places[k], places[k + 1]);
    cells.push({ id, closed: true, places, box });
    at += 1 + places.length;
  }
  return cells;
}
