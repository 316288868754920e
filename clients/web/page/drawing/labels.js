// Names of points on the map: the first ones by id come first, and a name that would cover another one is left out.

const FONT = '12px system-ui, sans-serif';
const HEIGHT = 15; // pixels of a line
const GAP = 3; // pixels between two names
const MOST = 400; // names on the screen

/** Writes the names, Map id -> name, of points of a mesh that are in view. Returns the boxes [x0, y0, x1, y1] of what it wrote. */
export function writeLabels(context, view, mesh, names, { text, halo }) {
  context.font = FONT;
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  context.lineWidth = 3;
  context.strokeStyle = halo;
  context.fillStyle = text;
  const boxes = [];
  for (const [id, name] of names) {
    const n = mesh.numberOf(id);
    if (n === undefined || !mesh.hasPoint(n)) continue;
    const [x, y] = view.toScreen(mesh.xy[2 * n], mesh.xy[2 * n + 1]);
    if (x < 0 || y < 0 || x > view.width || y > view.height) continue;
    const width = widthOf(context, name);
    const left = x + 7 + width > view.width ? x - 7 - width : x + 5;
    const box = [left, y - HEIGHT / 2, left + 2 + width, y + HEIGHT / 2];
    if (boxes.some((other) => overlap(box, other))) continue;
    boxes.push(box);
    context.strokeText(name, left + 1, y);
    context.fillText(name, left + 1, y);
    if (boxes.length === MOST) break;
  }
  return boxes;
}

const overlap = (a, b) => a[0] < b[2] + GAP && b[0] < a[2] + GAP && a[1] < b[3] && b[1] < a[3];

const widths = new Map();
function widthOf(context, name) {
  if (!widths.has(name)) widths.set(name, context.measureText(name).width);
  return widths.get(name);
}
