// Surfaces against a real daemon, $DELAUNAYD.

import assert from 'node:assert/strict';
import { describe, it as test } from 'node:test';
import { connect, Refused } from '../index.mjs';
import { useDaemon } from './daemon.mjs';

let client;

/** The set t: a square with a point in the middle, triangulated. */
async function loadSquare(fields) {
  await client.load('t', [0, 0, 4, 0, 4, 4, 0, 4, 2, 2], { fields });
  await client.triangulate('t');
}

const area = (polygon) => {
  let sum = 0;
  for (let i = 1; i < polygon.length; i++) sum += polygon[i - 1][0] * polygon[i][1] - polygon[i][0] * polygon[i - 1][1];
  return sum / 2;
};

describe('surfaces', () => {
  useDaemon((c) => {
    client = c;
  });

  test('are polygons as those of d3', async () => {
    await loadSquare();
    const cells = await client.voronoi('t');
    assert.deepEqual(cells.box, [-2, -2, 6, 6]);
    assert.deepEqual(cells.cellPolygon(4), [[0, 2], [2, 0], [4, 2], [2, 4], [0, 2]]);
    assert.deepEqual([...cells.cellPolygons()].map((polygon) => [polygon.index, area(polygon)]), [[0, 14], [1, 14], [2, 14], [3, 14], [4, 8]]);
    assert.equal(cells.cellPolygon(5), null);
    const some = await client.voronoi('t', { ids: [4, 0], box: [0, 0, 1, 1] });
    assert.deepEqual([...some.ids], [0, 4]);
    assert.deepEqual([...some.offsets], [0, 4, 4]);
    assert.equal(some.cellPolygon(4), null);
    assert.deepEqual([...some.cellPolygons()].map((polygon) => polygon.index), [0]);
    await assert.rejects(client.voronoi('t', { ids: [9] }), (error) => error instanceof Refused && error.code === 'NOPOINT');
  });

  test('weights and facts about fields are objects', async () => {
    await loadSquare();
    assert.deepEqual([...(await client.weights('t', 2, 1))], [[0, 0.25], [1, 0.25], [4, 0.5]]);
    await client.request('FSET t z 0 1.5 4 -2');
    await client.request('FSET t none 0 nan');
    assert.deepEqual(await client.fields('t'), { none: { count: 0, least: NaN, most: NaN }, z: { count: 2, least: -2, most: 1.5 } });
    await client.dropField('t', 'none');
    assert.deepEqual(Object.keys(await client.fields('t')), ['z']);
    await assert.rejects(client.dropField('t', '2 z'), TypeError);
  });

  test('values of any number of places are one request', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 8] });
    const calls = async () => {
      const row = (await client.request('INFO commands')).rows.find((text) => text.startsWith('command_INTERPOLATEB:'));
      return Number(/calls=(\d+)/.exec(row ?? 'calls=0')[1]);
    };
    const before = await calls();
    const places = Float64Array.from({ length: 6000 }, (_, i) => (i % 7) / 2);
    const values = await client.interpolate('t', 'z', places, { method: 'natural' });
    assert.equal(values.length, 3000);
    assert.equal(await calls(), before + 1);
    for (const i of [0, 999, 1000, 2999]) {
      const { rows } = await client.request(`INTERPOLATE t z ${places[2 * i]} ${places[2 * i + 1]} METHOD natural`);
      assert.equal(values[i], Number(rows[0]));
    }
    assert.deepEqual(await client.interpolate('t', 'z', [[2, 2], [2, 1], [9, 9]]), Float64Array.of(8, 4, NaN));
    assert.equal((await client.interpolate('t', 'z', [])).length, 0);
    await assert.rejects(client.interpolate('t', 'z', [1]), TypeError);
  });

  test('values of a set come with their points', async () => {
    await client.load('t', [0, 0, 4, 0, 4, 4, 0, 4, 2, 2], { fields: { z: [0, 0, 0, 0, 8], t: [1, 2, NaN, 4, 5] } });
    await client.delete('t', [1]);
    const { ids, coords, values } = await client.points('t', { fields: ['t', 'z'] });
    assert.deepEqual([...ids], [0, 2, 3, 4]);
    assert.deepEqual([...coords], [0, 0, 4, 4, 0, 4, 2, 2]);
    assert.deepEqual(values, { t: Float64Array.of(1, NaN, 4, 5), z: Float64Array.of(0, 0, 0, 8) });
    assert.deepEqual(await client.field('t', 'z'), { ids, values: values.z });
    assert.deepEqual(Object.keys(await client.points('t')), ['ids', 'coords']);
    await assert.rejects(client.field('t', 'none'), (error) => error instanceof Refused && error.code === 'NOFIELD');
    await assert.rejects(client.field('t', 't,z'), TypeError);
  });

  test('alpha shapes, lists and triangles of a box', async () => {
    await loadSquare();
    assert.deepEqual(await client.alpha('t', 2), [{ hole: false, ids: Uint32Array.of(0, 1, 2, 3) }]);
    assert.deepEqual(await client.alpha('t', 1.5), []);
    await assert.rejects(client.alpha('t', -1), Refused);
    const all = await client.lists('t');
    assert.deepEqual([...(await client.lists('t', { within: [0, 0, 2, 2] }))], [[4, all.get(4)], [0, all.get(0)]]);
    assert.deepEqual([...(await client.triangles('t', { within: [3, 1.5, 3, 1.75] }))], [1, 2, 4]);
    assert.deepEqual([...(await client.triangles('t', { within: [3, 1.5, 3, 1.75], clockwise: true }))], [1, 4, 2]);
  });

  test('values go on beyond the hull, and are clipped by another set', async () => {
    await client.load('t', [0, 0, 4, 0, 4, 4, 0, 4], { fields: { z: [1, 5, 5, 1] } });
    await client.triangulate('t');
    assert.deepEqual(await client.interpolate('t', 'z', [2, -3, 9, -1], { outside: 'nearest' }), Float64Array.of(3, 5));
    assert.deepEqual(await client.raster('t', 'z', [0, -4, 4, 0], 2, 1, { outside: 'nearest' }), Float64Array.of(2, 4));
    await client.load('field', [0, 0, 2, 0, 2, 9, 0, 9]);
    await client.constrainPath('field', [0, 1, 2, 3], { closed: true, border: true });
    await client.triangulate('field');
    assert.deepEqual(await client.raster('t', 'z', [0, 0, 4, 4], 2, 1, { clip: 'field' }), Float64Array.of(2, NaN));
    await assert.rejects(client.raster('t', 'z', [0, 0, 4, 4], 2, 1, { clip: 'none' }), Refused);
  });

  test('missing values are skipped, and several fields are side by side', async () => {
    await loadSquare({ z: [0, 0, 8, 8, NaN], s: [1, 2, 3, 4, 5] });
    const missing = 'skip';
    assert.deepEqual(await client.interpolate('t', 'z', [2, 2]), Float64Array.of(NaN));
    assert.deepEqual(await client.interpolate('t', 'z', [2, 2, 2, 1], { missing }), Float64Array.of(4, 2));
    assert.deepEqual(await client.gradient('t', 'z', [1, 1], { missing }), Float64Array.of(0, 2));
    assert.deepEqual(await client.raster('t', 'z', [0, 0, 4, 4], 1, 2, { missing }), Float64Array.of(6, 2));
    assert.deepEqual(await client.volume('t', 'z', { missing }), { above: 64, below: 0, area: 16 });
    assert.equal((await client.contourLines('t', 'z', { levels: [2], missing })).length, 1);
    assert.equal((await client.bands('t', 'z', { levels: [2, 6], missing })).length, 1);
    assert.equal((await client.profile('t', 'z', [0, 1, 0, 2], { missing }))[7], 4);
    assert.equal((await client.contourLines('t', 'z', { levels: [2], missing: 'nan' })).length, 0);
    assert.deepEqual(await client.interpolate('t', ['z', 's'], [0, 0, 2, 2]), Float64Array.of(0, 1, NaN, 5));
    assert.deepEqual(await client.raster('t', ['s', 'z'], [0, 0, 4, 4], 1, 1), Float64Array.of(5, NaN));
    await assert.rejects(client.interpolate('t', ['z', 's'], [0, 0], { missing }), Refused);
    await assert.rejects(client.interpolate('t', ['z', 's,z'], [0, 0]), TypeError);
  });

  test('the automatic radius gives one piece, and a simplified set is within the error', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 3] });
    assert.deepEqual(await client.alphaAuto('t'), { radius: 2, loops: [{ hole: false, ids: Uint32Array.of(0, 1, 2, 3) }] });
    assert.deepEqual(await client.simplify('t', 'z', 3, 'few'), { points: 4, constraints: 0, error: 3 });
    assert.deepEqual(await client.simplify('t', 'z', 1, 'all', { points: 9, ids: 'old' }), { points: 5, constraints: 0, error: 0 });
    await assert.rejects(client.simplify('t', 'z', 1, 'few'), Refused);
  });

  test('volumes are between a surface and a level, or another surface', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 3], low: [1, 1, 1, 1, 1] });
    assert.deepEqual(await client.volume('t', 'z'), { above: 16, below: 0, area: 16 });
    const { above, below } = await client.volume('t', 'z', { level: 1 });
    assert.ok(Math.abs(above - 128 / 27) < 1e-12 && Math.abs(below - 128 / 27) < 1e-12);
    assert.equal((await client.volume('t', 'z', { minus: 'low' })).above, above);
    assert.deepEqual(await client.volume('t', 'z', { box: [0, 0, 4, 2] }), { above: 8, below: 0, area: 8 });
    await client.constrain('t', [0, 1, 1, 4, 4, 0], { border: true, number: 7 });
    assert.deepEqual(await client.volume('t', 'z', { inside: 7 }), { above: 4, below: 0, area: 4 });
    await assert.rejects(client.volume('t', 'none'), Refused);
  });

  test('bands are polygons with holes', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 4] });
    const top = [[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]];
    assert.deepEqual(await client.bands('t', 'z', { levels: [-Infinity, 2, Infinity] }), [
      { type: 'Polygon', low: -Infinity, high: 2, coordinates: [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], top.toReversed()] },
      { type: 'Polygon', low: 2, high: Infinity, coordinates: [top] },
    ]);
    assert.deepEqual((await client.bands('t', 'z', { every: 3, base: 1 })).map(({ low, high }) => [low, high]), [[-2, 1], [1, 4]]);
    assert.deepEqual(await client.bands('t', 'z', { levels: [2] }), []);
    await assert.rejects(client.bands('t', 'none', { every: 1 }), Refused);
  });

  test('profiles have places and the edges between', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 2] });
    const want = Float64Array.of(0, 0, 1, 0, 1, 1, 1, 1, 2, 2, 1, 1, 3, 2, 2, 2, 5, 2, 4, 0, 6, 2, 5, NaN);
    assert.deepEqual(await client.profile('t', 'z', [[0, 1], [2, 1], [2, 5]]), want);
    const places = [{ x: 1, y: 1 }, { x: 3, y: 1 }];
    const options = { getX: (p) => p.x, getY: (p) => p.y, maxEdge: 4 };
    assert.deepEqual([...(await client.profile('t', 'z', places, options))].filter((_, i) => i % 4 === 3), [1, 1]);
    await assert.rejects(client.profile('t', 'z', [[0, 1]]), Refused);
  });

  test('gradients and rasters of slopes', async () => {
    await loadSquare({ z: [0, 0, 0, 0, 2] });
    assert.deepEqual(await client.gradient('t', 'z', [[2, 1], [1, 2], [9, 9]]), Float64Array.of(0, 1, 1, 0, NaN, NaN));
    assert.deepEqual(await client.raster('t', 'z', [0, 0, 4, 4], 2, 2, { quantity: 'slope' }), Float64Array.of(45, 45, 45, 45));
    assert.deepEqual(await client.raster('t', 'z', [1, 0, 3, 4], 1, 4, { quantity: 'aspect' }), Float64Array.of(0, 0, 180, 180));
    await assert.rejects(client.raster('t', 'z', [0, 0, 4, 4], 2, 2, { quantity: 'slope', method: 'natural' }), Refused);
  });

  test('contours leave out the triangles of missing values', async () => {
    await loadSquare({ z: [9, 9, NaN, 9, 1] });
    const [{ coordinates }] = await client.contours('t', 'z', [5]);
    assert.deepEqual(coordinates, [[[[0, 0], [4, 0], [3, 1], [1, 1], [1, 3], [0, 4], [0, 0]]]]);
  });

  test('contours are the ground at or above a level: summits, hollows, slopes, all or nothing', async () => {
    const [all, inner] = [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], [[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]]];
    for (const [z, level, coordinates] of [
      [[0, 0, 0, 0, 8], 4, [[inner]]],
      [[8, 8, 8, 8, 0], 4, [[all, inner.toReversed()]]],
      [[8, 0, 0, 8, 4], 4, [[[[0, 0], [2, 0], [2, 2], [2, 4], [0, 4], [0, 0]]]]],
      [[5, 5, 5, 5, 5], 5, [[all]]],
      [[4, 4, 4, 4, 4], 5, []],
      [[5, 0, 0, 0, 0], 5, []], // a line of one place
    ]) {
      await loadSquare({ z });
      assert.deepEqual(await client.contours('t', 'z', [level]), [{ type: 'MultiPolygon', value: level, coordinates }]);
      await client.drop('t');
    }
    await loadSquare({ z: [0, 8, 0, 8, 0] }); // two summits at the hull
    const [low, high] = await client.contours('t', 'z', [0, 4]);
    assert.deepEqual([low.coordinates, high.coordinates.length], [[[all]], 2]);
  });

  test('contours go along hulls of many points', async () => {
    const coords = Float64Array.from({ length: 40000 }, (_, i) => (i % 2 === 0 ? i / 2 : ((i - 1) / 2) ** 2));
    await client.load('t', coords, { fields: { z: coords.filter((_, i) => i % 2 === 0) } });
    await client.triangulate('t');
    const [{ coordinates }] = await client.contours('t', 'z', [9999.5]);
    assert.equal(coordinates.length, 1);
    assert.ok(coordinates[0][0].some(([x]) => x === 19999));
  });

  test('contours are of one state of the set', async () => {
    await loadSquare({ z: [0, 9, 0, 0, 8] });
    const { request } = client;
    let edits = 2; // while contours are asked for
    client.request = (line, options) => { // an edit comes between two of its requests
      const reply = request.call(client, line, options);
      if (line.startsWith('CONTOUR') && edits-- > 0) request.call(client, `MOVE t 1 ${6 + (edits % 2)} 0`);
      return reply;
    };
    const polygons = await client.contours('t', 'z', [4]);
    assert.deepEqual(polygons, await client.contours('t', 'z', [4]));
    assert.ok(polygons[0].coordinates.flat(2).some(([x]) => x > 4));
    edits = 1000;
    await assert.rejects(client.contours('t', 'z', [4]), /edited while it is read/);
    delete client.request;
    await client.delete('t', [0, 1, 2, 4]);
    assert.deepEqual(await client.contours('t', 'z', [4]), [{ type: 'MultiPolygon', value: 4, coordinates: [] }]);
  });

  test('have areas that add up to the box', async () => {
    const points = Float64Array.from({ length: 4000 }, Math.random);
    await client.load('u', points);
    await client.triangulate('u');
    const cells = await client.voronoi('u', { box: [0, 0, 1, 1] });
    const { ids, areas } = await client.areas('u', { box: [0, 0, 1, 1] });
    let sum = 0;
    for (const [i, polygon] of [...cells.cellPolygons()].entries()) {
      assert.equal(polygon.index, i);
      assert.ok(Math.abs(area(polygon) - areas[i]) < 1e-12);
      sum += areas[i];
    }
    assert.deepEqual([...ids], [...ids.keys()]);
    assert.ok(Math.abs(sum - 1) < 1e-12);
  });
});
