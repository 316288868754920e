// The example of Delaunator's README, as published, with both packages; code in the style of its guide; and cells beside d3-delaunay's.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import Ours from '../../../clients/js/delaunator.mjs';
import { connect } from '../../../clients/js/index.mjs';

const peer = createRequire(path.join(process.cwd(), 'x.js'));
const { default: Theirs } = await import(peer.resolve('delaunator'));

/** Triangles as text, each from its smallest point, sorted. */
function triangleSet(triangles) {
  const set = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const abc = [...triangles.slice(t, t + 3)];
    const k = abc.indexOf(Math.min(...abc));
    set.push([abc[k], abc[(k + 1) % 3], abc[(k + 2) % 3]].join(' '));
  }
  return set.sort();
}

test('the example of the README prints the same triangles', () => {
  const readme = readFileSync(path.join(path.dirname(peer.resolve('delaunator')), 'README.md'), 'utf8');
  const example = /```js\n(const coords[^`]*)```/.exec(readme)[1];
  const run = (Delaunator) => {
    let printed;
    Function('Delaunator', 'console', example)(Delaunator, { log: (v) => (printed = v) });
    return triangleSet(printed);
  };
  assert.deepEqual(run(Ours), run(Theirs));
  const comment = example.slice(example.indexOf('// [')).match(/\d+/g).map(Number);
  assert.deepEqual(run(Ours), triangleSet(comment));
});

// Typical uses of half edges, written for this test: edges, circumcentres, Voronoi edges and cells.
const next = (e) => (e % 3 === 2 ? e - 2 : e + 1);
const corners = (d, t) => [0, 1, 2].map((k) => d.triangles[3 * t + k]);

function circumcentre(points, [a, b, c]) {
  const [[ax, ay], [bx, by], [cx, cy]] = [points[a], points[b], points[c]];
  const [dx, dy, ex, ey] = [bx - ax, by - ay, cx - ax, cy - ay];
  const [bl, cl, d] = [dx * dx + dy * dy, ex * ex + ey * ey, 0.5 / (dx * ey - dy * ex)];
  return [ax + (ey * bl - dy * cl) * d, ay + (dx * cl - ex * bl) * d];
}

const short = ([x, y]) => `${x.toFixed(6)},${y.toFixed(6)}`;

function edges(d) {
  const list = [];
  d.halfedges.forEach((twin, e) => {
    if (e > twin) list.push([d.triangles[e], d.triangles[next(e)]].sort((p, q) => p - q).join(' '));
  });
  return list.sort();
}

function voronoiEdges(d, points) {
  const list = [];
  d.halfedges.forEach((twin, e) => {
    if (e < twin) list.push([e, twin].map((h) => short(circumcentre(points, corners(d, Math.floor(h / 3))))).sort().join(' '));
  });
  return list.sort();
}

/** Half edges that end at a point, turning round it. */
function around(d, start) {
  const list = [];
  let e = start;
  do {
    list.push(e);
    e = d.halfedges[next(e)];
  } while (e !== -1 && e !== start);
  return list;
}

function cells(d, points) {
  const start = new Map();
  d.triangles.forEach((_, e) => {
    const end = d.triangles[next(e)];
    if (!start.has(end) || d.halfedges[e] === -1) start.set(end, e);
  });
  return [...start].sort(([p], [q]) => p - q).map(([p, e]) => {
    const corner = around(d, e).map((h) => short(circumcentre(points, corners(d, Math.floor(h / 3)))));
    return `${p}: ${corner.sort().join(' ')}`;
  });
}

test('edges, Voronoi edges and cells are the same', () => {
  const points = Array.from({ length: 1000 }, () => [Math.random() * 900, Math.random() * 500]);
  const [ours, theirs] = [Ours.from(points), Theirs.from(points)];
  assert.deepEqual(edges(ours), edges(theirs));
  assert.deepEqual(voronoiEdges(ours, points), voronoiEdges(theirs, points));
  assert.deepEqual(cells(ours, points), cells(theirs, points));
});

test('the hull is walked in the same direction', () => {
  const points = Array.from({ length: 50 }, () => [Math.random(), Math.random()]);
  const turned = ([...hull]) => {
    const k = hull.indexOf(Math.min(...hull));
    return [...hull.slice(k), ...hull.slice(0, k)];
  };
  assert.deepEqual(turned(Ours.from(points).hull), turned(Theirs.from(points).hull));
});

// ---- VORONOI ----

const families = {
  uniform: (i) => [900 * random(i, 1), 500 * random(i, 2)],
  clusters: (i) => [100 * (i % 7) + random(i, 1), 60 * (i % 5) + random(i, 2)],
  lattice: (i) => [i % 20, Math.floor(i / 20)],
  slivers: (i) => [i, random(i, 1) / 1000],
  circle: (i) => [Math.cos(i), Math.sin(i)],
  outlier: (i) => (i === 0 ? [1e4, 2e3] : [random(i, 1), random(i, 2)]),
  offset: (i) => [1e4 + random(i, 1), -1e4 + random(i, 2)],
};

/** A number from 0 to 1 that depends on i and k alone. */
function random(i, k) {
  const x = Math.sin(12.9898 * i + 78.233 * k) * 43758.5453;
  return x - Math.floor(x);
}

const area = (polygon) => polygon.slice(1).reduce((sum, [x, y], i) => sum + (polygon[i][0] * y - x * polygon[i][1]) / 2, 0);
const gap = ([x, y], polygon) => Math.min(...polygon.map(([u, v]) => Math.hypot(x - u, y - v)));

/** Corners equal to rounding: d3 has a corner of several triangles on one circle several times. Thin triangles have centres far
 * away, where d3 computes with few digits. */
function compareCells(cells, theirs, n, tolerance) {
  let compared = 0;
  for (let i = 0; i < n; i++) {
    const [ours, other] = [cells.cellPolygon(i), theirs.cellPolygon(i)];
    assert.equal(ours === null, other === null);
    if (ours === null) continue;
    for (const corner of ours) assert.ok(gap(corner, other) <= tolerance, `cell ${i}: ${ours} ${other}`);
    for (const corner of other) assert.ok(gap(corner, ours) <= tolerance, `cell ${i}: ${ours} ${other}`);
    assert.ok(Math.abs(Math.abs(area(ours)) - Math.abs(area(other))) <= tolerance * 1e3);
    compared++;
  }
  return compared;
}

test('the cells of VORONOI are those of d3-delaunay, also after edits', async () => {
  const { Delaunay } = await import(peer.resolve('d3-delaunay'));
  const client = await connect('private:');
  for (const [name, place] of Object.entries(families)) {
    const points = Array.from({ length: 200 }, (_, i) => place(i));
    await client.load(name, points);
    await client.triangulate(name);
    for (let round = 0; round < 3; round++) {
      const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
      const box = [Math.min(...xs) - 1, Math.min(...ys) - 1, Math.max(...xs) + 1, Math.max(...ys) + 1];
      const cells = await client.voronoi(name, { box });
      const compared = compareCells(cells, Delaunay.from(points).voronoi(box), points.length, 1e-6);
      assert.ok(compared > 190, `${name}: ${compared}`);
      for (let k = 0; k < 20; k++) {
        const i = (7 * k + 13 * round) % points.length;
        points[i] = place(1000 + 20 * round + k);
        await client.move(name, i, ...points[i]);
      }
    }
  }
  client.close();
});
