// The interface of Delaunator, by import and by require.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import Delaunator from '../delaunator.mjs';
import { checkHalfedges } from './daemon.mjs';


const random = (n) => Array.from({ length: n }, () => [Math.random() * 1000, Math.random() * 1000]);

/** Triangles are clockwise. */
function checkSound(del) {
  const { coords, triangles, trianglesLen } = del;
  assert.equal(trianglesLen, triangles.length);
  checkHalfedges(del);
  for (let t = 0; t < triangles.length; t += 3) {
    const [ax, ay, bx, by, cx, cy] = [0, 1, 2].flatMap((k) => [coords[2 * triangles[t + k]], coords[2 * triangles[t + k] + 1]]);
    assert.ok((bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0);
  }
}

test('arrays of any kind give the same triangulation', () => {
  const points = random(500);
  const from = Delaunator.from(points);
  checkSound(from);
  assert.deepEqual(new Delaunator(points.flat()).triangles, from.triangles);
  assert.deepEqual(new Delaunator(Float64Array.from(points.flat())).triangles, from.triangles);
  const named = points.map(([x, y]) => ({ x, y }));
  assert.deepEqual(Delaunator.from(named, (p) => p.x, (p) => p.y).triangles, from.triangles);
  assert.ok(from.coords instanceof Float64Array && from.triangles instanceof Uint32Array);
  assert.ok(from.halfedges instanceof Int32Array && from.hull instanceof Uint32Array);
});

test('update follows a change of coords', () => {
  const d = Delaunator.from(random(300));
  const before = d.triangles;
  d.coords[0] = -500;
  d.coords[1] = -500;
  d.update();
  assert.notDeepEqual(d.triangles, before);
  checkSound(d);
  assert.ok(d.hull.includes(0));
});

test('few points and points on a line have no triangles', () => {
  const hull = (points) => {
    const d = Delaunator.from(points);
    assert.deepEqual([d.triangles.length, d.halfedges.length], [0, 0]);
    return [...d.hull];
  };
  assert.deepEqual(hull([]), []);
  assert.deepEqual(hull([[5, 5]]), [0]);
  assert.deepEqual(hull([[5, 5], [4, 4]]), [1, 0]);
  assert.deepEqual(hull([[5, 5], [5, 5]]), [0]);
  assert.deepEqual(hull([[0, 0], [1, 0], [3, 0], [2, 0]]), [0, 1, 3, 2]);
  assert.deepEqual(hull([[0, 3], [0, 1], [0, 2]]), [1, 2, 0]);
});

test('coincident points are in no triangle', () => {
  const d = Delaunator.from([[0, 0], [1, 0], [0, 1], [1, 0]]);
  checkSound(d);
  assert.deepEqual([...d.triangles].sort(), [0, 1, 2]);
});

test('input that is not an array of numbers is refused', () => {
  assert.throws(() => new Delaunator({ length: -1 }), /Invalid typed array length/);
  assert.throws(() => new Delaunator([[0, 0], [1, 1]]), /Expected coords to contain numbers/);
  assert.throws(() => new Delaunator([0, 0, NaN, 1]), { name: 'Refused', code: 'NUMBER' });
  assert.throws(() => new Delaunator([0, 0, Infinity, 1]), { code: 'RANGE' });
  checkSound(new Delaunator([0, 0, 1, 0, 0, 1])); // after an error
});

test('require gives the class itself', () => {
  const required = createRequire(import.meta.url)('../delaunator.js');
  assert.equal(required, Delaunator);
  assert.equal(required.default, Delaunator);
});

test('a server is refused with a sentence', () => {
  assert.throws(() => Delaunator.useServer('private:'), /computes in this process and uses no server/);
});

test('triangles are exact where those of doubles are not', () => {
  // A circle through many lattice points, shifted far away; and points whose last bits alone keep them from being collinear.
  const far = 2 ** 40;
  const circle = [[5, 0], [4, 3], [3, 4], [0, 5], [-3, 4], [-4, 3], [-5, 0], [-4, -3], [-3, -4], [0, -5], [3, -4], [4, -3]];
  checkSound(Delaunator.from(circle.map(([x, y]) => [far + x, far + y])));
  const nearLine = Array.from({ length: 100 }, (_, i) => [i / 10, (i / 10) * 3 + (i % 7 === 0 ? 2 ** -50 : 0)]);
  const d = Delaunator.from(nearLine);
  assert.ok(d.triangles.length > 0);
  assert.equal(new Set([...d.triangles, ...d.hull]).size, 100);
});

test('the memory of a million points is given back, and that of many small sets', () => {
  const rss = () => process.memoryUsage().rss / 2 ** 20;
  const big = Float64Array.from({ length: 600000 }, Math.random);
  const small = Float64Array.from({ length: 40 }, Math.random);
  const many = () => {
    for (let k = 0; k < 20000; k++) new Delaunator(small);
    for (let k = 0; k < 5; k++) new Delaunator(big);
  };
  many();
  const before = rss();
  many();
  many();
  assert.ok(rss() < before + 300, `${before} MiB before, ${rss()} after`);
});
