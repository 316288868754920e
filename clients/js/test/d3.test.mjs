// The interface of d3-delaunay, compared with d3-delaunay itself if that is installed in the current directory.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import { Delaunay } from '../d3-delaunay.mjs';


const theirs = await (async () => {
  try {
    return await import(createRequire(path.join(process.cwd(), 'x.js')).resolve('d3-delaunay'));
  } catch {
    return null;
  }
})();
const skip = theirs === null && 'd3-delaunay is not installed here';

const square = [[0, 0], [300, 0], [0, 300], [300, 300], [100, 100]];
const random = (n) => Array.from({ length: n }, () => [Math.random() * 900, Math.random() * 500]);
const sorted = (list) => [...list].sort((a, b) => a - b);

test('points come in arrays, iterables and by functions', () => {
  const expected = Float64Array.of(0, 0, 1, 0, 0, 1);
  const pairs = [[0, 0], [1, 0], [0, 1]];
  const named = pairs.map(([x, y]) => ({ x, y }));
  assert.deepEqual(Delaunay.from(pairs).points, expected);
  assert.deepEqual(Delaunay.from(new Set(pairs)).points, expected);
  assert.deepEqual(Delaunay.from(named.values(), (p) => p.x, (p) => p.y).points, expected);
  assert.deepEqual(Delaunay.from({ length: 3 }, (p, i) => i & 1, (p, i) => i >> 1).points, expected);
  const that = { sx: 1 };
  assert.deepEqual(Delaunay.from(named, function (p) { return p.x * this.sx; }, (p, i, all) => all[i].y, that).points, expected);
  assert.deepEqual([...new Delaunay([0, 0, 1, 0, 0, 1]).triangles], [0, 2, 1]);
});

test('the nearest point is found from any point', () => {
  const points = random(400);
  const delaunay = Delaunay.from(points);
  for (let k = 0; k < 200; k++) {
    const [x, y] = [Math.random() * 1200 - 100, Math.random() * 800 - 100];
    const distances = points.map(([px, py]) => (px - x) ** 2 + (py - y) ** 2);
    const nearest = distances.indexOf(Math.min(...distances));
    assert.equal(delaunay.find(x, y), nearest);
    assert.equal(delaunay.find(x, y, k), nearest);
  }
  assert.equal(delaunay.find(NaN, 0), -1);
  assert.equal(Delaunay.from([]).find(0, 0), -1);
});

test('coincident points have no neighbours and are passed over', () => {
  const delaunay = Delaunay.from([[0, 0], [0, 0], [10, 10], [10, -10]]);
  assert.deepEqual([...delaunay.neighbors(1)], []);
  assert.deepEqual(sorted(delaunay.neighbors(0)), [2, 3]);
  assert.equal(delaunay.find(100, 100, 1), 2);
  assert.equal(delaunay.inedges[1], -1);
});

test('one place and two are searched', () => {
  const points = [[0, 1], [0, 2]];
  const delaunay = Delaunay.from(points);
  assert.equal(delaunay.find(0, -1), 0);
  assert.equal(delaunay.find(0, 2.2), 1);
  assert.deepEqual([...delaunay.neighbors(0)], [1]);
  assert.deepEqual([...delaunay.neighbors(1)], [0]);
  delaunay.points.fill(0);
  delaunay.update();
  assert.equal(delaunay.find(0, -1), 0);
  assert.equal(delaunay.find(0, 1.2), 0);
});

test('points on one line are searched and joined in order', () => {
  const points = [[0, 1], [0, 2], [0, 4], [0, 0], [0, 3], [0, 4], [0, 4]];
  const delaunay = Delaunay.from(points);
  const nearest = (x, y, i) => points[delaunay.find(x, y, i)][1];
  assert.deepEqual([nearest(0, -1), nearest(0, 1.2), nearest(1, 1.9), nearest(-1, 3.3), nearest(10, 10), nearest(10, 10, 0)], [0, 1, 2, 3, 4, 4]);
  assert.equal(delaunay.collinear.length, 7);
  assert.deepEqual(sorted(delaunay.neighbors(0)), [1, 3]);
  assert.deepEqual([...delaunay.neighbors(3)], [0]);
  delaunay.points[0] = 1;
  assert.equal(delaunay.update(), delaunay);
  assert.equal(delaunay.collinear, undefined);
  assert.ok(delaunay.triangles.length > 0);
});

test('drawings go to a context, or are text', () => {
  const delaunay = Delaunay.from([[0, 0], [1, 0], [0, 1]]);
  assert.equal(delaunay.renderHull(), 'M0,0L0,1L1,0Z');
  assert.equal(delaunay.renderTriangle(0), 'M0,0L0,1L1,0Z');
  assert.equal(delaunay.render(), 'M0,0L0,1L1,0Z');
  assert.equal(Delaunay.from([[0, 0]]).renderPoints(3), 'M3,0A3,3,0,1,1,-3,0A3,3,0,1,1,3,0');
  assert.deepEqual(delaunay.hullPolygon(), [[0, 0], [0, 1], [1, 0], [0, 0]]);
  assert.deepEqual([...delaunay.trianglePolygons()], [[[0, 0], [0, 1], [1, 0], [0, 0]]]);
  assert.deepEqual(delaunay.trianglePolygon(0), [[0, 0], [0, 1], [1, 0], [0, 0]]);
  const calls = [];
  const context = Object.fromEntries(['moveTo', 'lineTo', 'closePath', 'arc'].map((name) => [name, (...args) => calls.push([name, ...args])]));
  assert.equal(delaunay.renderHull(context), undefined);
  assert.deepEqual(calls, [['moveTo', 0, 0], ['lineTo', 0, 1], ['lineTo', 1, 0], ['closePath']]);
  calls.length = 0;
  Delaunay.from([[5, 6]]).renderPoints(context);
  assert.deepEqual(calls, [['moveTo', 7, 6], ['arc', 5, 6, 2, 0, 2 * Math.PI]]);
});

const area = (polygon) => {
  let sum = 0;
  for (let k = 0; k + 1 < (polygon?.length ?? 0); k++) sum += polygon[k][0] * polygon[k + 1][1] - polygon[k][1] * polygon[k + 1][0];
  return sum / 2;
};

test('Voronoi cells tile the bounds, also of points that are collinear but for rounding', () => {
  for (const n of [1, 2, 4, 5, 10, 120]) {
    const points = Array.from({ length: n }, (_, i) => [(i * 480) / n, (i * 40) / n / 3 + 100]);
    const voronoi = Delaunay.from(points).voronoi([0, 0, 480, 200]);
    const cells = [...voronoi.cellPolygons()];
    assert.deepEqual(cells.map((cell) => cell.index), points.map((_, i) => i));
    assert.ok(Math.abs(cells.reduce((sum, cell) => sum + area(cell), 0) - 96000) < 1e-6);
  }
});

test('Voronoi diagrams follow an update from a line to a plane and back', () => {
  const voronoi = Delaunay.from([[0, 0], [1, 1], [2, 2]]).voronoi([-10, -10, 10, 10]);
  const before = voronoi.cellPolygon(0);
  const { points } = voronoi.delaunay;
  points[2] = 5;
  assert.equal(voronoi.update(), voronoi);
  assert.notDeepEqual(voronoi.cellPolygon(0), before);
  assert.equal(voronoi.delaunay.triangles.length, 3);
  points[2] = 1;
  assert.deepEqual(voronoi.update().cellPolygon(0), before);
});

test('Voronoi diagrams are drawn, and edges are those of the cells', () => {
  const voronoi = Delaunay.from(square).voronoi([-500, -500, 500, 500]);
  assert.equal(voronoi.renderBounds(), 'M-500,-500h1000v1000h-1000Z');
  assert.equal(voronoi.renderCell(4), 'M-50,150L150,-50L250,150L150,250Z');
  assert.equal(voronoi.render().match(/M/g).length, 8);
  assert.deepEqual(sorted(voronoi.neighbors(4)), [0, 1, 2, 3]);
  const seen = [];
  voronoi.renderBounds({ rect: (...args) => seen.push(args) });
  assert.deepEqual(seen, [[-500, -500, 1000, 1000]]);
  assert.equal(voronoi.cellPolygon(9), null);
  assert.throws(() => Delaunay.from(square).voronoi([1, 0, 0, 1]), /invalid bounds/);
  assert.throws(() => Delaunay.from(square).voronoi([0, NaN, 0, 1]), /invalid bounds/);
  assert.deepEqual([...Delaunay.from(square).voronoi([0, 0, 0, 9]).cellPolygons()], []);
});

// ---- beside d3-delaunay ----

/** Triangles as text, each from its smallest point, sorted. */
function triangleSet({ triangles }) {
  const set = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const abc = [...triangles.subarray(t, t + 3)];
    const k = abc.indexOf(Math.min(...abc));
    set.push([abc[k], abc[(k + 1) % 3], abc[(k + 2) % 3]].join(' '));
  }
  return set.sort();
}

const turned = (list) => {
  const k = list.indexOf(Math.min(...list));
  return [...list.slice(k), ...list.slice(0, k)];
};

test('random points give the same triangles, hull and neighbours', { skip }, () => {
  for (const n of [3, 4, 10, 100, 2000]) {
    const points = random(n);
    const ours = Delaunay.from(points);
    const other = theirs.Delaunay.from(points);
    assert.deepEqual(triangleSet(ours), triangleSet(other));
    assert.deepEqual(turned([...ours.hull]), turned([...other.hull]));
    for (let i = 0; i < n; i++) assert.deepEqual(turned([...ours.neighbors(i)]), turned([...other.neighbors(i)]));
    assert.equal(ours.renderPoints(1.5), other.renderPoints(1.5));
    assert.deepEqual(ours.render().match(/M/g).length, other.render().match(/M/g).length);
    assert.deepEqual(ours.hullPolygon().length, other.hullPolygon().length);
  }
});

/** The corners of a cell to 1e-6, from the first in order. */
const cell = (polygon) => turnedCorners(polygon.slice(1).map((p) => p.map((v) => Math.round(v * 1e6) / 1e6 + 0)));

function turnedCorners(corners) {
  const texts = corners.map(String);
  const k = texts.indexOf([...texts].sort()[0]);
  return [...texts.slice(k), ...texts.slice(0, k)];
}

test('Voronoi cells are those of d3-delaunay', { skip }, () => {
  const points = random(300);
  const ours = Delaunay.from(points).voronoi([0, 0, 900, 500]);
  const other = theirs.Delaunay.from(points).voronoi([0, 0, 900, 500]);
  points.forEach(([x, y], i) => {
    assert.deepEqual(cell(ours.cellPolygon(i)), cell(other.cellPolygon(i)));
    assert.deepEqual(sorted(ours.neighbors(i)), sorted(other.neighbors(i)));
    assert.ok(ours.contains(i, x, y));
  });
  const rounded = (d) => Array.from({ length: d.circumcenters.length / 2 }, (_, t) => [0, 1].map((k) => d.circumcenters[2 * t + k].toFixed(4)).join()).sort();
  assert.deepEqual(rounded(ours), rounded(other));
  assert.deepEqual([...ours.vectors], [...other.vectors]);
  assert.equal(ours.renderBounds(), other.renderBounds());
});

test('Voronoi diagrams follow an update, and have default bounds', { skip }, () => {
  const delaunay = Delaunay.from(square);
  const centres = (d) => [...d.voronoi([-500, -500, 500, 500]).circumcenters];
  assert.deepEqual(sorted(centres(delaunay)), sorted([150, -50, -50, 150, 250, 150, 150, 250]));
  delaunay.points.forEach((v, i) => {
    delaunay.points[i] = -v;
  });
  assert.deepEqual(sorted(centres(delaunay.update())), sorted([-150, 50, -250, -150, 50, -150, -150, -250]));
  const { xmin, ymin, xmax, ymax } = delaunay.voronoi();
  assert.deepEqual([xmin, ymin, xmax, ymax], [0, 0, 960, 500]);
});

/** The parts of a path, each as its corners to 1e-6, from the first in order: d3 moves collinear points a little. */
const place = (text) => text.split(',').map((v) => Math.round(v * 1e6) / 1e6 + 0).join();
const parts = (path) => (path ?? '').split('M').slice(1).map((part) => turnedCorners(part.replace('Z', '').split('L').map(place)).join(' ')).sort();

/** Of the edges of a path together. */
const length = (path) => parts(path).map((edge) => edge.split(/[ ,]/).map(Number)).reduce((sum, [x0, y0, x1, y1]) => sum + Math.hypot(x1 - x0, y1 - y0), 0);

test('few points, points on a line and coincident points have the same Voronoi cells', { skip }, () => {
  const bounds = [-1, -1, 2, 2];
  for (const points of [[], [[0, 0]], [[0, 0], [1, 0], [1, 0], [1, 0]], [[0, 0], [1, 0], [0, 1], [1, 0]], [[0, 0], [1, 0], [-1, 0]]]) {
    const ours = Delaunay.from(points).voronoi(bounds);
    const other = theirs.Delaunay.from(points).voronoi(bounds);
    points.forEach((_, i) => assert.deepEqual(parts(ours.renderCell(i)), parts(other.renderCell(i))));
    assert.ok(Math.abs(length(ours.render()) - length(other.render())) < 1e-5); // d3 has some edges in two parts
  }
});
