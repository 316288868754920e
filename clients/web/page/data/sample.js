// A set that is too large to be mirrored whole: the page shows everything in a box around the view, if that has few enough triangles.
// Otherwise it shows a sample: the triangles at the places of a grid. A sample can be known at once for a set of any size. It has all triangles that
// are larger than a cell of the grid; of smaller ones it has one for each cell.

const PLACES = 40000; // of the grid
const LEAST_CELL = 3; // pixels
const SMALL = 8; // cells: where triangles are smaller, squares fill the holes between those of the sample
const MOST_IN_BOX = 200000; // triangles
const MARGIN = 0.25; // of a box around the view, on each side
const BYTES_OF_TRIANGLE = 12;
const LINE = 4000; // ids in a line of GET
const FAR = 2 ** 201; // the largest coordinate of a point
const NOWHERE = 0xffffffff;

/** fetchAll(requests) resolves to the replies. Resolves to:
 * - version;
 * - triangles: three ids each, and places: Map id -> [x, y, value] of their corners;
 * - squares: {places, size}: x, y and value in the middle of each cell with a small triangle, and the side of a cell;
 * - estimate: about how many triangles are in view. */
export async function sampleOf(fetchAll, set, view, field) {
  const size = Math.max(LEAST_CELL, Math.sqrt((view.width * view.height) / PLACES)) / view.scale;
  const grid = gridOf(view.box(), size);
  const [{ keys }, located] = await fetchAll([`STAT ${set}`, [`LOCATEB ${set} ${grid.length / 2}`, grid]]);
  const corners = new Uint32Array(located.data.buffer);
  const ids = new Set(corners);
  ids.delete(NOWHERE);
  const places = await placesOf(fetchAll, set, ids, field);
  const triangles = new Map();
  const squares = [];
  let estimate = 0;
  for (let k = 0; k < corners.length; k += 3) {
    const triangle = [...corners.subarray(k, k + 3)];
    if (!triangle.every((id) => places.has(id))) continue; // there is none, or it was deleted meanwhile
    const cells = areaOf(triangle.map((id) => places.get(id))) / size ** 2;
    estimate += 1 / cells;
    triangles.set(triangle.join(' '), triangle);
    if (cells < SMALL) squares.push(grid[(2 * k) / 3], grid[(2 * k) / 3 + 1], places.get(triangle[0])[2]);
  }
  return { version: Number(keys.version), triangles: [...triangles.values()].flat(), places, squares: { places: squares, size }, estimate };
}

/** Decides what is shown of a view with this sample. Resolves to the box around the view in which everything is to be shown; null: it
 * has more than `most` triangles, or than a box may have, and the sample is shown. */
export async function boxToShow(fetchAll, set, view, { estimate }, most) {
  const limit = Math.min(most, MOST_IN_BOX);
  if (estimate > limit) return null;
  const box = view.box(MARGIN);
  try {
    await fetchAll([`TRIANGLES ${set} WITHIN ${box.join(' ')} BINARY`], BYTES_OF_TRIANGLE * limit);
    return box;
  } catch (error) {
    if (error.code === 'LARGE') return null;
    throw error;
  }
}

/** The middles of cells of some size in a box, x and y. */
function gridOf([x0, y0, x1, y1], size) {
  const places = [];
  for (let y = y1 - size / 2; y > y0; y -= size) {
    for (let x = x0 + size / 2; x < x1; x += size) places.push(x, y);
  }
  return Float64Array.from(places);
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
