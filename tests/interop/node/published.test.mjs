// The example of Delaunator's README, as published, with both packages; and code in the style of its guide.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import Ours from '../../../clients/js/delaunator.mjs';

Ours.useServer('private:');

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
