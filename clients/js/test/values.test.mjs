// Arguments that could be read in two ways, or only in part, are refused, and the set stays as it is.

import assert from 'node:assert/strict';
import { describe, it as test } from 'node:test';
import { LiveSet, Triangulation, connect, useServer } from '../index.mjs';
import framing from '../lib/framing.js';
import { useDaemon } from './daemon.mjs';

let client;
const square = [0, 0, 4, 0, 4, 4, 0, 4, 2, 2];

/** Calls with one bad argument. */
const BAD = {
  'a number': [(v) => client.add('t', v, 1), (v) => client.move('t', 0, 1, v), (v) => client.locate('t', v, 0), (v) => client.nearest('t', 0, v),
    (v) => client.alpha('t', v), (v) => client.create('u', v), (v) => client.expire('t', v), (v) => client.within('t', 0, 0, v),
    (v) => client.interpolate('t', 'z', [1, 1], { maxEdge: v }), (v) => client.contours('t', 'z', [v]), (v) => client.bands('t', 'z', { every: v }),
    (v) => client.simplify('t', 'z', v, 'u'), (v) => client.volume('t', 'z', { level: v }), (v) => client.triangles('t', { within: [0, 0, 1, v] }),
    (v) => client.load('t', [0, v]), (v) => client.load('t', [[0, v]]), (v) => client.load('t', square, { fields: { z: [0, 0, 0, 0, v] } }),
    (v) => client.setField('t', 'z', [v]), (v) => client.loadPaths('t', [[[0, 0], [1, v]]])],
  'a whole number': [(v) => client.delete('t', [v]), (v) => client.get('t', [v]), (v) => client.getField('t', 'z', [v]), (v) => client.move('t', v, 1, 1),
    (v) => client.constrain('t', [[0, v]]), (v) => client.constrainPath('t', [0, v]), (v) => client.voronoi('t', { ids: [v] }),
    (v) => client.nearest('t', 0, 0, v), (v) => client.nearestAll('t', [0, 0], v), (v) => client.constrain('t', [[0, 1]], { number: v }),
    (v) => client.setField('t', 'z', [1], { first: v }), (v) => client.raster('t', 'z', [0, 0, 1, 1], v, 1), (v) => client.refine('t', { limit: v }),
    (v) => client.constraints('t', { ids: [v] }), (v) => client.wait(v, 0)],
};
const NO_NUMBERS = ['3', '', true, [1], {}, Symbol.iterator];

describe('what methods take', () => {
  useDaemon((c) => {
    client = c;
  });

  const refused = async (ask, error, what) => {
    await client.load('t', square, { fields: { z: [0, 1, 2, 3, 4] } });
    await client.triangulate('t');
    const before = await client.digest('t');
    await assert.rejects(async () => ask(), error, what);
    assert.equal(await client.digest('t'), before, what);
    await client.drop('t');
  };

  for (const [kind, asks] of Object.entries(BAD)) {
    test(`${kind} is not what looks like one`, async () => {
      for (const ask of asks) for (const value of NO_NUMBERS) await refused(() => ask(value), TypeError, `${ask} of ${String(value)}`);
    });
  }

  test('a BigInt is no coordinate and no value', async () => {
    for (const ask of BAD['a number']) await refused(() => ask(3n), { name: 'TypeError', message: '3n is not a number' }, `${ask}`);
    await refused(() => client.load('t', BigUint64Array.of(1n, 2n)), TypeError);
  });

  test('an id has no fraction', async () => {
    for (const ask of BAD['a whole number']) for (const value of [1.5, NaN, Infinity, 2 ** 53, 2n ** 53n + 1n]) await refused(() => ask(value), RangeError, `${ask} of ${value}`);
  });

  test('text is no list, and a point has two coordinates', async () => {
    const lists = [(v) => client.delete('t', v), (v) => client.get('t', v), (v) => client.constrainPath('t', v), (v) => client.setField('t', 'z', v),
      (v) => client.contours('t', 'z', v), (v) => client.load('t', v), (v) => client.raster('t', 'z', v, 1, 1)];
    for (const ask of lists) for (const value of ['12', 12, null, {}, new DataView(new ArrayBuffer(16))]) await refused(() => ask(value), TypeError, `${ask}`);
    for (const points of [[[1]], [[[1, 2]]], [{ x: 1, y: 2 }], ['12'], ['1', '2'], [0, 1, 2], [[0, 1, 2], [3]]]) await refused(() => client.load('t', points), TypeError);
    for (const sides of [[0, 0, 1], [0, 0, 1, 1, 2], []]) await refused(() => client.areas('t', { box: sides }), RangeError);
  });

  test('an option that a method does not have is an error', async () => {
    const asks = [(o) => client.stat('t', o), (o) => client.contours('t', 'z', [1], o), (o) => client.load('t', square, o), (o) => client.triangles('t', o),
      (o) => client.delete('t', [0], o), (o) => client.constrain('t', [0, 1], o), (o) => client.interpolate('t', 'z', [1, 1], o), (o) => client.sets(o),
      (o) => client.add('t', 1, 1, o), (o) => client.info(o), (o) => client.mirror('t', o), (o) => client.request('PING', o), (o) => client.nearest('t', 0, 0, 1, o),
      (o) => Triangulation.from(square, { client, ...o }), (o) => connect('private:', o), (o) => LiveSet.from(square, o), (o) => new LiveSet().hull(o),
      (o) => new LiveSet().contours([], o), (o) => new LiveSet().constrain([], o), (o) => useServer('private:', o)];
    for (const ask of asks) await refused(() => ask({ timeot: 1 }), { name: 'TypeError', message: 'there is no option timeot' }, `${ask}`);
    await refused(() => client.stat('t', { body: Buffer.from('PING\n') }), /no option body/);
    await refused(() => client.stat('t', 5), /options are an object/);
    await refused(() => client.contourLines('t', 'z', { levels: [1], every: 2 }), /either levels or every/);
    await refused(() => client.contourLines('t', 'z', { levels: [1], base: 2 }), /a base needs every/);
    await refused(() => client.constraints('t', { ids: [1], number: 0 }), /either ids or a number/);
    await refused(() => client.releaseAll('t', { border: true }), /border needs a number/);
  });

  test('times, truth values and words', async () => {
    const times = [(timeout) => client.stat('t', { timeout }), (timeout) => client.contours('t', 'z', [1], { timeout }), (timeout) => connect('private:', { timeout }),
      (connectTimeout) => connect('private:', { connectTimeout })];
    for (const ask of times) {
      for (const value of [-1, NaN, Infinity, 2 ** 31]) await refused(() => ask(value), RangeError, `${ask} of ${value}`);
      for (const value of ['x', '5', true, [5]]) await refused(() => ask(value), TypeError, `${ask} of ${value}`);
    }
    const facts = [(v) => client.triangles('t', { clockwise: v }), (v) => client.delete('t', [0], { cascade: v }), (v) => client.constrain('t', [0, 1], { border: v }),
      (v) => client.constrainPath('t', [0, 1, 2], { closed: v }), (v) => client.create('u', 0, { temporary: v }), (v) => new LiveSet().hull({ clockwise: v })];
    for (const ask of facts) for (const value of ['no', 'false', 2, []]) await refused(() => ask(value), TypeError, `${ask} of ${value}`);
    const words = [(v) => client.triangulate('t', { method: v }), (v) => client.interpolate('t', 'z', [1, 1], { method: v }), (v) => client.backup(v)];
    for (const ask of words) for (const value of ['divide BINARY', '', 5, ['linear']]) await refused(() => ask(value), TypeError, `${ask} of ${value}`);
    for (const name of [['t'], 5, 't\n', '']) await refused(() => client.stat(name), TypeError);
  });

  test('further coordinates of a point are not read, as Delaunator does not', async () => {
    const solid = [[0, 0, 7], [4, 0, '?'], Float64Array.of(4, 4, 7, 1), [0, 4]];
    await client.load('solid', solid);
    await client.loadPaths('solid', [[[1, 1, 7], [3, 1, 8]]]);
    assert.deepEqual((await client.points('solid')).coords, Float64Array.of(0, 0, 4, 0, 4, 4, 0, 4, 1, 1, 3, 1));
    const t = await Triangulation.from(solid, { client });
    assert.equal(t.triangles.length, 6);
    assert.deepEqual(LiveSet.from(solid).point(1), [4, 0]);
  });

  test('-0 and BigInts are ids', async () => {
    await client.load('ids', square);
    const first = [{ id: 0, x: 0, y: 0 }, { id: 1, x: 4, y: 0 }];
    for (const ids of [[-0, 1], [0n, 1n], BigUint64Array.of(0n, 1n), BigInt64Array.of(0n, 1n), new Set([0n, 1])]) assert.deepEqual(await client.get('ids', ids), first);
    await client.triangulate('ids');
    for (const ends of [[0n, 4n], BigUint64Array.of(0n, 1n), [[1n, -0]], new Map([[1n, 2n]]), [-0, 3]]) await client.constrain('ids', ends, { number: 3n });
    assert.deepEqual((await client.constraints('ids', { number: -0 })).ends.length, 0);
    assert.deepEqual((await client.constraints('ids', { number: 3 })).ends, Uint32Array.of(0, 1, 0, 3, 0, 4, 1, 2));
    assert.deepEqual(await client.nearestAll('ids', [0, 0], 1n), Uint32Array.of(0));
    await refused(() => client.constrain('t', [0n, -1n]), RangeError);
    await refused(() => client.constrain('t', BigUint64Array.of(0n, 2n ** 60n)), { name: 'RangeError', message: `${2n ** 60n}n is not a whole number` });
    await refused(() => client.triangulate('t', { method: 0n }), { name: 'TypeError', message: '0n is not one word' });
  });

  test('what is left out may be undefined or null', async () => {
    await client.load('t', square);
    await client.triangulate('t', { method: null, timeout: undefined });
    assert.equal((await client.triangles('t', { inside: null, within: undefined, clockwise: 0 })).length, 12);
    await client.setField('t', 'z', Float32Array.of(1, 2, 3, 4, 5));
    assert.deepEqual(await client.getField('t', 'z', Uint8Array.of(4)), Float64Array.of(5));
    assert.deepEqual((await client.points('t', { fields: 'z' })).values.z.length, 5);
  });

  test('numbers arrive that JavaScript writes in its own way', async () => {
    assert.equal(framing.line('A', -0, [Infinity, -Infinity, NaN], 1e21, 5e-324), 'A -0 inf -inf nan 1e+21 5e-324');
    assert.deepEqual(framing.numbersOf('inf -inf nan -0 1e+21'), [Infinity, -Infinity, NaN, -0, 1e21]);
    await client.load('far', [2 ** 200, 0, 1e21, -5e21]);
    assert.deepEqual(await client.get('far', [1]), [{ id: 1, x: 1e21, y: -5e21 }]);
    await client.load('none', []);
    await client.triangulate('none');
    assert.deepEqual([(await client.quality('none')).angle, (await client.refine('none')).angle], [NaN, NaN]);
  });
});
