// Beside the published earcut and Constrainautor: their examples, earcut's own test polygons, random graphs.

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { test } from 'node:test';
import Constrainautor from '../../../clients/js/constrainautor.mjs';
import Delaunator from '../../../clients/js/delaunator.mjs';
import earcut, * as ours from '../../../clients/js/earcut.mjs';

const peer = createRequire(path.join(process.cwd(), 'x.js'));
const theirs = await import(peer.resolve('earcut'));
const { default: TheirConstrainautor } = await import(peer.resolve('@kninnug/constrainautor'));
const folder = (name) => path.join(process.cwd(), 'node_modules', name);

/** Twice the signed area of each triangle. */
function areas(data, dim, triangles) {
  const at = (i) => [data[dim * i], data[dim * i + 1]];
  return Array.from({ length: triangles.length / 3 }, (_, i) => {
    const [[ax, ay], [bx, by], [cx, cy]] = [0, 1, 2].map((k) => at(triangles[3 * i + k]));
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  });
}

const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);

test('the package has everything that earcut exports', () => {
  assert.deepEqual(Object.keys(ours).sort(), Object.keys(theirs).sort());
  for (const name of Object.keys(theirs)) assert.equal(ours[name].length, theirs[name].length, name);
});

test('the examples of the README of earcut cover the same areas', () => {
  const readme = readFileSync(path.join(folder('earcut'), 'README.md'), 'utf8');
  const calls = [...readme.matchAll(/earcut\(\[[^)]*\)/g)].map(([text]) => text);
  assert.ok(calls.length >= 3);
  for (const text of calls) {
    const run = (f) => Function('earcut', `return ${text}`)((data, holes, dim = 2) => areas(data, dim, f(data, holes, dim)));
    const [mine, other] = [run(earcut), run(theirs.default)];
    assert.equal(mine.length, other.length, text);
    assert.equal(sum(mine), sum(other), text);
    assert.ok(mine.every((area) => area > 0));
  }
});

test('the examples with flatten and deviation', () => {
  const geojson = { geometry: { coordinates: [[[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]], [[2, 2], [2, 5], [5, 5], [2, 2]]] } };
  const data = ours.flatten(geojson.geometry.coordinates);
  assert.deepEqual(data, theirs.flatten(geojson.geometry.coordinates));
  const triangles = earcut(data.vertices, data.holes, data.dimensions);
  assert.equal(ours.deviation(data.vertices, data.holes, data.dimensions, triangles), 0);
  assert.equal(theirs.deviation(data.vertices, data.holes, data.dimensions, triangles), 0);
  const kept = [...triangles];
  ours.refine(triangles, data.vertices, data.dimensions);
  assert.deepEqual(triangles, kept);
});

// They cross themselves, so no triangles are exact.
const CROSSING = ['bad-hole', 'water', 'water-huge', 'water-huge2'];

test('earcut\'s own test polygons deviate no more than with earcut, and not at all if they do not cross themselves', () => {
  const fixtures = path.join(folder('earcut_fixtures'), 'test', 'fixtures');
  const names = readdirSync(fixtures).filter((name) => name.endsWith('.json'));
  assert.ok(names.length >= 16);
  for (const name of names) {
    const rings = JSON.parse(readFileSync(path.join(fixtures, name), 'utf8'));
    if (!rings[0]?.[0]?.length) continue; // no corners, which flatten does not accept
    const { vertices, holes, dimensions } = theirs.flatten(rings);
    const triangles = earcut(vertices, holes, dimensions);
    const mine = theirs.deviation(vertices, holes, dimensions, triangles);
    const other = theirs.deviation(vertices, holes, dimensions, theirs.default(vertices, holes, dimensions));
    assert.ok(mine <= (CROSSING.includes(path.parse(name).name) ? other : 1e-14), `${name}: ${mine} beside ${other}`);
    assert.ok(areas(vertices, dimensions, triangles).every((area) => area > 0), name);
    assert.ok(areas(vertices, dimensions, triangles).length > 0 || sum(areas(vertices, dimensions, theirs.default(vertices, holes, dimensions))) === 0, name);
  }
});

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

test('the example of the README of Constrainautor gives the same triangles', () => {
  const readme = readFileSync(path.join(folder('@kninnug/constrainautor'), 'README.md'), 'utf8');
  const example = readme.slice(readme.indexOf('const points'), readme.indexOf('// del now has')).replace('(points),', '(points);');
  const run = (Class) => Function('Delaunator', 'Constrainautor', `${example}; return del`)(Delaunator, Class);
  assert.deepEqual(triangleSet(run(Constrainautor).triangles), triangleSet(run(TheirConstrainautor).triangles));
});

test('Constrainautor has the same methods, which take as many arguments', () => {
  const documented = ['constrainOne', 'delaunify', 'constrainAll', 'isConstrained', 'findEdge', 'untriangulatedPoints'];
  for (const name of documented) assert.equal(Constrainautor.prototype[name].length, TheirConstrainautor.prototype[name].length, name);
});

test('random graphs have the triangles of Constrainautor, edge by edge and at once', () => {
  for (let round = 0; round < 30; round++) {
    const points = Array.from({ length: 200 }, () => [Math.random(), Math.random()]);
    const order = points.map((_, i) => i).sort((a, b) => points[a][0] + 5 * Math.floor(10 * points[a][1]) - points[b][0] - 5 * Math.floor(10 * points[b][1]));
    const edges = order.slice(1).map((b, i) => [order[i], b]).filter(([a, b]) => Math.floor(10 * points[a][1]) === Math.floor(10 * points[b][1]));
    const make = (Class) => new Class(Delaunator.from(points), edges);
    const [mine, other] = [make(Constrainautor), make(TheirConstrainautor)];
    assert.deepEqual(triangleSet(mine.del.triangles), triangleSet(other.del.triangles));
    const one = new Constrainautor(Delaunator.from(points));
    for (const [a, b] of edges.slice(0, 20)) one.constrainOne(a, b);
    one.constrainAll(edges);
    assert.deepEqual(one.del.triangles, mine.del.triangles);
    for (const [a, b] of edges) assert.ok(mine.isConstrained(Math.abs(mine.findEdge(a, b))) && other.isConstrained(Math.abs(other.findEdge(a, b))));
  }
});

test('what Constrainautor refuses is refused with the same words', () => {
  const square = [[0, 0], [4, 0], [4, 4], [0, 4]];
  const fail = (Class, points, ...edges) => {
    try {
      new Class(points && Delaunator.from(points), edges);
    } catch (error) {
      return error.message;
    }
    return null;
  };
  for (const [points, ...edges] of [[null], [[...square, [2, 2]], [0, 2]], [square, [0, 2], [1, 3]], [[...square, [2, 2.5], [2, 2.5]], [0, 5]]]) {
    const [mine, other] = [fail(Constrainautor, points, ...edges), fail(TheirConstrainautor, points, ...edges)];
    assert.ok(mine !== null && other !== null);
    assert.equal(mine, other);
  }
});
