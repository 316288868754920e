// A sample of the triangles in view, those at the places of a grid: it can be known at once for a set of any size. It has all triangles
// that are larger than a cell of the grid; of smaller ones it has one for each cell.

const PLACES = 40000; // of the grid
const LEAST_CELL = 3; // pixels
const LINE = 4000; // ids in a line of GET
const FAR = 1e50; // beyond all points

const NOWHERE = 0xffffffff;

/** fetchAll(requests) resolves to the replies. Resolves to {version, triangles, places, small, estimate, cell}. triangles: three ids each.
 * places: Map id -> [x, y, value] of their corners. small: an id of each triangle that is smaller than two cells. estimate: about how
 * many triangles are in view. cell: pixels. */
export async function sampleOf(fetchAll, set, view, field) {
  const cell = Math.max(LEAST_CELL, Math.sqrt((view.width * view.height) / PLACES));
  const grid = gridOf(view, cell);
  const [{ keys }, located] = await fetchAll([`STAT ${set}`, [`LOCATEB ${set} ${grid.length / 2}`, grid]]);
  const found = distinct(new Uint32Array(located.data.buffer));
  const places = await placesOf(fetchAll, set, new Set(found.flatMap(({ corners }) => corners)), field);
  const known = [];
  const small = [];
  const cellArea = (cell / view.scale) ** 2;
  let estimate = 0;
  for (const { corners, hits } of found) {
    if (!corners.every((id) => places.has(id))) continue; // deleted meanwhile
    const area = areaOf(corners.map((id) => places.get(id)));
    estimate += (hits * cellArea) / area;
    known.push(...corners);
    if (area < 2 * cellArea) small.push(corners[0]);
  }
  return { version: Number(keys.version), triangles: known, places, small, estimate, cell };
}

/** The middles of all cells in view, x and y. */
function gridOf(view, cell) {
  const places = [];
  for (let py = cell / 2; py < view.height; py += cell) {
    for (let px = cell / 2; px < view.width; px += cell) places.push(...view.toPlane(px, py));
  }
  return Float64Array.from(places);
}

/** The different triangles among those at places, {corners, hits}; hits: at how many places it is. */
function distinct(located) {
  const found = new Map();
  for (let k = 0; k < located.length; k += 3) {
    const corners = [...located.subarray(k, k + 3)];
    if (corners[0] === NOWHERE) continue;
    const key = corners.join(' ');
    if (!found.has(key)) found.set(key, { corners, hits: 0 });
    found.get(key).hits++;
  }
  return [...found.values()];
}

const areaOf = ([[ax, ay], [bx, by], [cx, cy]]) => Math.abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2;

/** Map id -> [x, y, value] of those ids that still have a place. */
export async function placesOf(fetchAll, set, ids, field) {
  const lines = [];
  const all = [...ids];
  for (let i = 0; i < all.length; i += LINE) lines.push(all.slice(i, i + LINE).join(' '));
  const get = async (line) => {
    const requests = [`GET ${set} ${line}`, ...(field === null ? [] : [`FGET ${set} ${field.name} ${line}`])];
    const [places, values] = await fetchAll(requests).catch((error) => {
      if (error.code === 'NOPOINT') return [{ rows: [] }]; // one of them has been deleted
      throw error;
    });
    return places.rows.map((row, i) => {
      const [id, x, y] = row.split(' ').map(Number);
      return [id, [x, y, Number(values?.rows[i].split(' ')[1] ?? NaN)]];
    });
  };
  return new Map((await Promise.all(lines.map(get))).flat());
}

/** The box around a set: the points nearest to places far away on all sides. */
export async function boxAround(fetchAll, set) {
  const far = [[-FAR, 0], [0, -FAR], [FAR, 0], [0, FAR]];
  const replies = await fetchAll(far.map(([x, y]) => `NEAREST ${set} ${x} ${y}`));
  return replies.map(({ rows }, i) => Number(rows[0].split(' ')[1 + (i % 2)]));
}
