// The page's copy of a set, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Mesh } from '../page/data/mesh.js';
import { Gathered } from '../page/data/rings.js';

function event(...rows) {
  const gathered = new Gathered();
  gathered.add({ rows });
  return gathered;
}

const trianglesAt = (mesh, n) => mesh.corners.subarray(0, 3 * mesh.triangles).filter((corner) => corner === n).length;

/** A wheel: point 0 in the middle of n others. */
function wheel(n) {
  const rows = ['point 0 0 0', `list 0 i ${Array.from({ length: n }, (_, i) => i + 1).join(' ')}`];
  for (let i = 1; i <= n; i++) {
    const angle = (2 * Math.PI * i) / n;
    rows.push(`point ${i} ${Math.cos(angle)} ${Math.sin(angle)}`, `list ${i} b ${(i % n) + 1} 0 ${((i + n - 2) % n) + 1}`);
  }
  return rows;
}

test('rings of points on a line have no triangles, until a point leaves the line', () => {
  const mesh = new Mesh();
  mesh.loadEvent(event('point 0 0 0', 'list 0 b 1', 'point 1 1 0', 'list 1 b 2 0', 'point 2 2 0', 'list 2 b 1'));
  assert.equal(mesh.triangles, 0);
  mesh.apply(event('list 1 b 4 0', 'point 4 1.5 0', 'list 4 b 2 1', 'list 2 b 4'));
  mesh.apply(event('list 1 b 2 0', 'gone 4', 'list 2 b 1'));
  assert.deepEqual([mesh.triangles, mesh.points], [0, 3]);
  const box = mesh.apply(event('list 0 b 1 3', 'list 1 b 2 3 0', 'list 2 b 3 1', 'point 3 1 1', 'list 3 b 0 1 2'));
  assert.deepEqual([mesh.triangles, mesh.points, box], [2, 4, [0, 0, 2, 1]]);
});

test('a point with many neighbours, and its removal', () => {
  const mesh = new Mesh();
  mesh.loadEvent(event(...wheel(50000)));
  assert.deepEqual([mesh.triangles, trianglesAt(mesh, 0), trianglesAt(mesh, 7)], [50000, 50000, 2]);
  const small = new Mesh();
  small.loadEvent(event(...wheel(4)));
  small.apply(event('gone 0', 'list 1 b 2 4', 'list 2 b 3 4 1', 'list 3 b 4 2', 'list 4 b 1 2 3'));
  assert.deepEqual([small.triangles, small.points, small.hasPoint(0)], [2, 4, false]);
});

test('points and triangles of two versions, and the changes since the first of them', () => {
  const rows = Buffer.alloc(60);
  [[0, 0, 0], [1, 4, 0], [2, 0, 4]].forEach(([id, x, y], i) => {
    rows.writeUInt32LE(id, 20 * i);
    rows.writeDoubleLE(x, 20 * i + 4);
    rows.writeDoubleLE(y, 20 * i + 12);
  });
  const mesh = new Mesh();
  const triangles = Uint32Array.of(0, 1, 4, 0, 3, 5, 0, 4, 3, 0, 5, 2, 1, 2, 5, 1, 5, 4, 3, 4, 5);
  mesh.load(new Uint8Array(rows), new Uint8Array(triangles.buffer), false);
  const lists = ['list 0 b 1 4 3 5 2', 'list 1 b 2 5 4 0', 'list 2 b 0 5 1'];
  const added = ['point 3 0.5 0.5', 'list 3 i 0 4 5', 'point 4 1 0.5', 'list 4 i 0 1 5 3', 'point 5 0.5 1', 'list 5 i 0 3 4 1 2'];
  mesh.apply(event(...lists, ...added), 2);
  assert.deepEqual([mesh.triangles, mesh.points, trianglesAt(mesh, 3)], [7, 6, 3]);
});
