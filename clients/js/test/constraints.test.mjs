// Edges and polygons that a triangulation keeps: the interfaces of Constrainautor and of earcut, and of LiveSet.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import Constrainautor from '../constrainautor.mjs';
import earcut, { deviation, flatten } from '../earcut.mjs';
import { Constrainautor as same, Delaunator, LiveSet, earcut as sameEarcut } from '../index.mjs';
import { next, sequence } from './daemon.mjs';

const random = sequence(11);

/** Exact for whole numbers below 1,000. */
function orient([ax, ay], [bx, by], [cx, cy]) {
  return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

function isInCircle([ax, ay], [bx, by], [cx, cy], [px, py]) {
  const [x, y, z] = [[ax, ay], [bx, by], [cx, cy]].map(([u, v]) => [u - px, v - py, (u - px) ** 2 + (v - py) ** 2]);
  const cross = (i, j) => i[0] * j[1] - i[1] * j[0];
  return (x[2] * cross(y, z) + y[2] * cross(z, x) + z[2] * cross(x, y)) * orient([ax, ay], [bx, by], [cx, cy]) > 0;
}

/** Half edges in pairs; all triangles clockwise; every edge is constrained or Delaunay. */
function checkSound(con) {
  const { coords, triangles, halfedges } = con.del;
  const at = (p) => [coords[2 * p], coords[2 * p + 1]];
  halfedges.forEach((twin, e) => {
    const [a, b, c] = [e, next(e), next(next(e))].map((k) => at(triangles[k]));
    assert.ok(orient(a, b, c) < 0);
    if (twin < 0) return;
    assert.equal(halfedges[twin], e);
    assert.equal(triangles[twin], triangles[next(e)]);
    assert.equal(con.isConstrained(e), con.isConstrained(twin));
    assert.ok(con.isConstrained(e) || !isInCircle(a, b, c, at(triangles[next(next(twin))])));
  });
}

function cross(p, q, r, s) {
  return orient(p, q, r) * orient(p, q, s) <= 0 && orient(r, s, p) * orient(r, s, q) <= 0;
}

test('the diamond of the README of Constrainautor gets its vertical edge, in place', () => {
  const del = Delaunator.from([[150, 50], [50, 200], [150, 350], [250, 200]]);
  const { triangles, halfedges } = del;
  const con = new Constrainautor(del);
  assert.equal(con.findEdge(0, 2), Infinity);
  const e = con.constrainOne(0, 2);
  assert.ok(del.triangles === triangles && del.halfedges === halfedges && con.del === del);
  assert.deepEqual([triangles[e], triangles[next(e)]], [0, 2]);
  assert.ok(con.isConstrained(e) && con.isConstrained(halfedges[e]) && !con.isConstrained(next(e)));
  assert.equal(con.findEdge(1, 3), Infinity);
  checkSound(con);
});

test('edges at the hull are found from either end, and constrained again without effect', () => {
  const con = new Constrainautor(Delaunator.from([[0, 0], [4, 0], [4, 4], [0, 4], [2, 2]]), [[0, 1], [1, 2]]);
  const { triangles } = con.del;
  const e = Math.abs(con.findEdge(1, 2));
  assert.deepEqual(new Set([triangles[e], triangles[next(e)]]), new Set([1, 2]));
  assert.ok(con.findEdge(1, 2) + con.findEdge(2, 1) === 0 && con.isConstrained(e));
  assert.equal(con.constrainOne(2, 1), con.findEdge(2, 1));
  assert.equal(con.constrainAll([[1, 0], [0, 1]]), con);
  assert.equal(con.delaunify(true), con);
});

test('random segments that do not cross become edges, and all others are Delaunay', () => {
  for (let round = 0; round < 20; round++) {
    const points = [...new Set(Array.from({ length: 150 }, () => `${random(60)} ${random(60)}`))].map((p) => p.split(' ').map(Number));
    const edges = [];
    for (let tries = 0; tries < 300; tries++) {
      const [a, b] = [random(points.length), random(points.length)];
      const isFree = ([c, d]) => {
        const ends = [a, b].filter((p) => p === c || p === d);
        if (ends.length > 0) return ends.length === 1 && orient(points[a], points[b], points[ends[0] === c ? d : c]) !== 0;
        return !cross(points[a], points[b], points[c], points[d]);
      };
      const isClear = points.every((p, i) => i === a || i === b || orient(points[a], points[b], p) !== 0);
      if (a !== b && isClear && edges.every(isFree)) edges.push([a, b]);
    }
    const all = new Constrainautor(Delaunator.from(points), edges);
    const one = new Constrainautor(Delaunator.from(points));
    for (const [a, b] of edges.reverse()) {
      const e = one.constrainOne(a, b);
      const [from, to] = Object.is(e, Math.abs(e)) ? [a, b] : [b, a];
      assert.deepEqual([one.del.triangles[Math.abs(e)], one.del.triangles[next(Math.abs(e))]], [from, to]);
    }
    assert.deepEqual(one.del, all.del);
    checkSound(all);
    for (const [a, b] of edges) assert.ok(all.isConstrained(Math.abs(all.findEdge(a, b))));
  }
});

test('what Constrainautor refuses is refused and changes nothing', () => {
  const points = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 2], [2, 2], [1, 3], [3, 1]];
  const con = new Constrainautor(Delaunator.from(points), [[6, 7].map((p) => p - 6), [4, 6]]);
  const before = con.del.triangles.slice();
  assert.throws(() => con.constrainOne(0, 2), /^Error: Constraining edge intersects point$/);
  assert.throws(() => con.constrainOne(0, 5), /^Error: Cannot constrain between points that are not triangulated$/);
  assert.throws(() => con.constrainAll([[2, 3], [7, 2], [1, 3]]), /^Error: Constraining edge intersects point$/);
  assert.throws(() => con.constrainOne(0, 100), { code: 'NOPOINT' });
  assert.throws(() => con.constrainOne(-1, 1), { code: 'NOPOINT' });
  assert.throws(() => con.constrainOne(1, 1), { code: 'NOEDGE' });
  assert.deepEqual(con.del.triangles, before);
  assert.deepEqual(con.untriangulatedPoints(), [5]);
  assert.equal(con.isConstrained(Math.abs(con.findEdge(2, 3))), false);
  const square = new Constrainautor(Delaunator.from(points.slice(0, 4)), [[0, 2]]);
  assert.throws(() => square.constrainOne(1, 3), /^Error: Edge intersects already constrained edge$/);
  assert.throws(() => new Constrainautor(Delaunator.from([[0, 0], [1, 1]])), /No edges in triangulation/);
  assert.throws(() => new Constrainautor(null), /Expected an object with Delaunator output/);
  assert.ok(same === Constrainautor && sameEarcut === earcut);
});

test('a set keeps constraints through edits until they are released', () => {
  const set = LiveSet.from([0, 0, 4, 0, 4, 4, 0, 4, 1, 2]);
  assert.equal(set.constrain([[0, 2], [0, 2]]), 1);
  assert.throws(() => set.constrain([3, 1]), { code: 'CROSSES', message: /1 3 crosses 0 2|3 1 crosses 0 2/ });
  assert.throws(() => set.delete([2]), { code: 'CONSTRAINED' });
  assert.throws(() => set.cells([0, 0, 4, 4]), { code: 'NOTDELAUNAY' });
  set.add([3, 1.5, 2, 2]);
  assert.deepEqual([...set.constrainedEdges()], [0, 6, 2, 6]); // through the new point
  assert.throws(() => set.release([1, 2]), { code: 'NOCONSTRAINT' });
  set.release([[2, 0]]);
  assert.equal(set.constrainedEdges().length, 0);
  assert.deepEqual(set.triangulation().triangles, LiveSet.from([0, 0, 4, 0, 4, 4, 0, 4, 1, 2, 3, 1.5, 2, 2]).triangulation().triangles);
  set.free();
});

test('what is enclosed an odd number of times is inside', () => {
  const set = LiveSet.from([0, 0, 9, 0, 0, 9, 1, 1, 4, 1, 1, 4, 2, 2, 2.5, 2, 2, 2.5]);
  assert.equal(set.inside().length, 0);
  set.constrain([0, 1, 1, 2, 2, 0, 3, 4, 4, 5, 5, 3, 6, 7, 7, 8], { border: true });
  assert.equal(set.inside().length, 0); // it is not closed
  set.constrain([8, 6], { border: true });
  assert.deepEqual([...set.inside()].slice(-3), [6, 7, 8]);
  assert.equal(set.inside().length, set.inside({ clockwise: true }).length);
});

test('the examples of earcut', () => {
  const area = (data, triangles, dim = 2) => {
    let sum = 0;
    for (let i = 0; i < triangles.length; i += 3) sum += orient(...[0, 1, 2].map((k) => data.slice(dim * triangles[i + k], dim * triangles[i + k] + 2)));
    return sum / 2;
  };
  const quad = [10, 0, 0, 50, 60, 60, 70, 10];
  assert.equal(area(quad, earcut(quad)), 3100);
  assert.equal(earcut(quad).length, 6);
  const holed = [0, 0, 100, 0, 100, 100, 0, 100, 20, 20, 80, 20, 80, 80, 20, 80];
  assert.equal(earcut(holed, [4]).length, 24);
  assert.equal(area(holed, earcut(holed, [4])), 6400);
  const spatial = [10, 0, 1, 0, 50, 2, 60, 60, 3, 70, 10, 4];
  assert.deepEqual(earcut(spatial, null, 3), earcut(quad));
  const { vertices, holes, dimensions } = flatten([[[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]], [[1, 1], [1, 3], [3, 3]]]);
  assert.deepEqual([vertices.length, holes, dimensions], [16, [5], 2]);
  assert.equal(deviation(vertices, holes, dimensions, earcut(vertices, holes, dimensions)), 0);
  assert.equal(deviation([0, 0, 1, 0, 1, 1, 0, 1], null, 2, [0, 1, 2]), 0.5);
});

test('polygons that touch themselves, lie on a line or cross themselves', () => {
  assert.deepEqual([earcut([]), earcut([1, 2, 3, 4]), earcut([0, 0, 1, 1, 2, 2])], [[], [], []]);
  const touching = [0, 0, 4, 0, 4, 4, 2, 0, 0, 4]; // a corner on another side
  assert.equal(deviation(touching, null, 2, earcut(touching)), 0);
  assert.throws(() => earcut([0, 0, 1, NaN, 1, 1]), { code: 'NUMBER' });
  assert.throws(() => earcut([0, 0, 1, 1e300, 1, 1]), { code: 'RANGE' });
});

test('a polygon that crosses itself has the triangles whose centroid is enclosed', () => {
  const bow = [0, 0, 9, 8, 9, 0, 0, 9]; // the sides cross near (4.8, 4.2)
  assert.deepEqual(earcut(bow), [0, 1, 3]);
  const data = [0, 0, 100, 0, 100, 100, 50, 100, 50.5, 101, 49.5, 101, 50, 99, 0, 100]; // a small loop at a side
  assert.ok(deviation(data, null, 2, earcut(data)) < 0.01);
  assert.equal(earcut(data).length > 0, true);
});

test('a hole of one corner is a vertex of the triangles', () => {
  const square = [0, 0, 4, 0, 4, 4, 0, 4, 1, 2];
  const triangles = earcut(square, [4]);
  assert.ok(triangles.length === 12 && triangles.filter((i) => i === 4).length === 4);
});

test('arguments of earcut may be arrays of any kind, with more coordinates than corners need', () => {
  const data = [0, 0, 7, 9, 0, 7, 9, 9, 7, 0, 9, 7, 2, 2, 7, 7, 2, 7, 7, 7, 7, 2, 7, 7];
  const want = earcut(data, [4], 3);
  assert.equal(want.length, 24);
  assert.deepEqual(earcut(Float32Array.from(data), Uint32Array.of(4), 3), want);
  assert.deepEqual(earcut([...data, 5], [4], 3), want);
  const flat = data.filter((_, i) => i % 3 < 2);
  assert.deepEqual(earcut([...flat, 5], [4]), want);
  assert.deepEqual(earcut(Float64Array.from(flat), [4]), want);
  assert.equal(earcut.refine(want, flat), undefined);
});

test('random stars are covered', () => {
  for (let round = 0; round < 50; round++) {
    const corners = 3 + random(60);
    const data = Array.from({ length: corners }, (_, i) => {
      const [angle, r] = [(2 * Math.PI * i) / corners, 100 + random(900)];
      return [r * Math.cos(angle), r * Math.sin(angle)];
    }).flat();
    const triangles = earcut(data);
    assert.equal(triangles.length, 3 * (corners - 2));
    assert.ok(deviation(data, null, 2, triangles) < 1e-12);
  }
});
