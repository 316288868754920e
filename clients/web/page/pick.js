// The thing under the pointer: the nearest point and the triangle there, for the mark on the map and the card. It is asked for again when
// the set changes, so that the card shows the present state.
import { request } from './daemon.js';
import { showCard } from './panel.js';
import { follower, latest } from './shown.js';
import { draw, marks, mesh, overlay, view } from './stage.js';

let pointer = null; // in pixels; null: it is elsewhere

/** The number of the point of the mesh nearest to a pixel, not farther than some pixels; null: there is none. */
export function nearest(px, py, pixels) {
  const [x, y] = view.toPlane(px, py);
  let [best, found] = [(pixels / view.scale) ** 2, null];
  for (let n = 0; n < mesh.ids; n++) {
    const d = (mesh.xy[2 * n] - x) ** 2 + (mesh.xy[2 * n + 1] - y) ** 2;
    if (d <= best) [best, found] = [d, n];
  }
  return found;
}

/** The pointer is at a pixel, or null: it has left the map. */
export function look(at) {
  pointer = at;
  lookAgain();
}

/** Shows what is there now. */
export const lookAgain = latest(async () => {
  const [at, { set, kind }] = [pointer, follower];
  const found = at === null || kind === null || mesh.points === 0 ? null : await find(set, at).catch(() => null);
  marks.picked = pointer === null || follower.set !== set ? null : found;
  showCard(marks.picked, view);
  draw();
});

async function find(set, at) {
  const [x, y] = view.toPlane(...at);
  const [near, where] = await Promise.all([
    request(`NEAREST ${set} ${x} ${y}`),
    mesh.triangles === 0 ? null : request(`LOCATE ${set} ${x} ${y}`),
  ]);
  const [id, ...place] = near.rows[0].split(' ').map(Number).slice(0, 3);
  const ring = where === null ? null : (await request(`LISTS ${set} ${id}`)).rows[0].split(' ').slice(1);
  const corners = where?.keys.where === 'inside' ? where.rows[0].split(' ').map((c) => mesh.numberOf(Number(c))) : [];
  const isKnown = corners.length > 0 && corners.every((n) => mesh.hasPoint(n));
  const triangle = isKnown ? corners.map((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]) : null;
  return { id, name: overlay.names.get(id), place, pixels: view.toScreen(...place), triangle, facts: factsOf(id, place, ring) };
}

function factsOf(id, place, ring) {
  const facts = { 'x, y': place.map((v) => Number(v.toPrecision(8))).join(', ') };
  if (ring !== null) facts.neighbours = ring.length;
  const { field } = follower;
  const value = mesh.values[mesh.numberOf(id)];
  if (field !== null && value !== undefined && !Number.isNaN(value)) facts[field.name] = Number(value.toPrecision(6));
  return facts;
}
