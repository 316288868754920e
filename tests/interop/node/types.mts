// Compiled, not run: what users write has the types that they expect.
import { type Change, Client, connect, LiveSet, type Mirror, Refused, Triangulation } from 'delaunayd';
import Constrainautor from 'delaunayd/constrainautor';
import Delaunator from 'delaunayd/delaunator';
import earcut from 'delaunayd/earcut';
import { Delaunay, type Polygon, Voronoi } from 'delaunayd/d3-delaunay';

export async function asynchronous(): Promise<number> {
  const client: Client = await connect('private:', { timeout: 100 });
  await client.load('t', [[0, 0], [1, 0], [0, 1]]);
  await client.load('t', [{ lon: 1, lat: 2 }], { getX: (p) => p.lon, getY: (p) => p.lat });
  const { triangles, ms } = await client.triangulate('t', { method: 'divide' });
  const delaunay: boolean = (await client.check('t')).delaunay;
  const ids: Uint32Array = await client.triangles('t', { clockwise: true });
  const [{ id, distance }] = await client.nearest('t', 0, 0);
  const t: Triangulation = await Triangulation.from(new Float32Array(6), { client });
  const steps: (string | number)[][] = await client.trace('t', { timeout: 100 });
  const dropped: void = await client.dropField('t', 'z');
  await client.stat('none').catch((e: unknown) => e instanceof Refused && e.code.length);
  const mirror: Mirror = await client.mirror('t', { within: [0, 0, 1, 1], fields: ['z'] });
  mirror.on('change', ({ added }: Change) => console.log(added.length, mirror.point(0)?.[1])).once('dropped', () => mirror.close());
  const { added }: { added: number } = await client.constrain('t', [[0, 1]], { border: true, number: 2, split: true });
  const { ends } = await client.constraints('t', { number: 2 });
  const inside: Uint32Array = await client.triangles('t', { inside: 2 });
  const area = (await client.regions('t')).borders.get(2)?.area ?? added + ends.length + inside.length;
  const facts = await client.loadPaths('t', [[[0, 0], [1, 1]], new Float64Array(4)], { fields: { z: [[1, 2], [3, 4]] } });
  client.close();
  return area + facts.constraints + (await client.regionsAt('t', [[0, 0]]))[0][0] + triangles + ms + Number(delaunay) + Number(dropped) + steps.length + ids.length + id + distance + t.halfedges.length;
}

export function synchronous(): Polygon {
  const d: Delaunator<Float64Array> = Delaunator.from([[0, 0], [1, 0], [0, 1]]);
  const named = Delaunator.from([{ x: 1, y: 2 }], (p) => p.x, (p) => p.y);
  const flat = new Delaunator([0, 0, 1, 0, 0, 1]);
  flat.coords[0] = 2;
  flat.update();
  const delaunay = Delaunay.from(new Set([{ x: 1, y: 2 }]), (p) => p.x, (p, i) => p.y + i);
  const found: number = delaunay.find(1, 2, 0) + [...delaunay.neighbors(0)].length + d.hull.length + named.triangles.length;
  const path: string = delaunay.render() + delaunay.voronoi([0, 0, found, 1]).renderCell(0);
  return path === '' ? [] : delaunay.hullPolygon();
}

export function constrained(): number[] {
  const edges: [number, number][] = [[0, 1]];
  const del: Constrainautor.DelaunatorLike = Delaunator.from([[0, 0], [1, 0], [0, 1]]);
  const con = new Constrainautor(del, edges).constrainAll(edges);
  const { vertices, holes, dimensions } = earcut.flatten([[[0, 0], [1, 0], [0, 1]]]);
  const corners: number[] = earcut(vertices, holes, dimensions);
  earcut.refine(corners, vertices, dimensions);
  return con.isConstrained(con.findEdge(0, 1)) && earcut.deviation(vertices, holes, 2, corners) === 0 ? corners : [];
}

// As with d3's types.
export function ofD3(context: CanvasRenderingContext2D): Delaunay.Point[] {
  const points: Delaunay.Point[] = [[0, 0], [1, 0], [0, 1]];
  const bounds: Delaunay.Bounds = [0, 0, 1, 1];
  const delaunay: Delaunay<Delaunay.Point> = Delaunay.from(points);
  const voronoi: Voronoi<Delaunay.Point> = delaunay.voronoi(bounds);
  const named: Voronoi<{ x: number; y: number }> = Delaunay.from([{ x: 1, y: 2 }], (p) => p.x, (p) => p.y).voronoi();
  voronoi.renderBounds(context);
  voronoi.renderCell(0, context);
  named.delaunay.renderPoints(context, 2);
  for (const cell of voronoi.update().cellPolygons()) if (cell.index === 0) return cell;
  return voronoi.cellPolygon(0);
}

export function live(): number {
  const set = LiveSet.from([{ lon: 1, lat: 2 }], { getX: (p) => p.lon, getY: (p) => p.lat, values: [3] });
  set.move(set.add([[1, 2]]), 3, 4);
  const { levels, coords } = set.contours([1, 2], { maxEdge: 5 });
  const values: Float64Array = set.interpolate(new Float64Array(2), { method: 'natural' });
  set.free();
  return set.size + set.delete([0]) + values[0] + levels[0] + coords[0] + set.nearest([0, 0], 2)[1];
}

// @ts-expect-error: a set's name comes first
export const wrong = (client: Client) => client.nearest(1, 2);
