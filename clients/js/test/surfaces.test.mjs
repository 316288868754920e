// Surfaces against a real daemon, $DELAUNAYD.

import assert from 'node:assert/strict';
import { after, before, beforeEach, describe, it as test } from 'node:test';
import { connect, Refused } from '../index.mjs';
import { startDaemon } from './daemon.mjs';

let daemon;
let client;

const area = (polygon) => {
  let sum = 0;
  for (let i = 1; i < polygon.length; i++) sum += polygon[i - 1][0] * polygon[i][1] - polygon[i][0] * polygon[i - 1][1];
  return sum / 2;
};

describe('surfaces', () => {
  before(async () => {
    daemon = await startDaemon();
    client = await connect(daemon.url);
  });

  after(async () => {
    client.close();
    assert.equal(await daemon.end(), 0);
  });

  beforeEach(async () => {
    for (const set of await client.sets()) await client.drop(set);
  });

  test('are polygons as those of d3', async () => {
    await client.load('t', [0, 0, 4, 0, 4, 4, 0, 4, 2, 2]);
    await client.triangulate('t');
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
    await client.load('t', [0, 0, 4, 0, 4, 4, 0, 4, 2, 2]);
    await client.triangulate('t');
    assert.deepEqual([...(await client.weights('t', 2, 1))], [[0, 0.25], [1, 0.25], [4, 0.5]]);
    await client.request('FSET t z 0 1.5 4 -2');
    await client.request('FSET t none 0 nan');
    assert.deepEqual(await client.fields('t'), { none: { count: 0, least: NaN, most: NaN }, z: { count: 2, least: -2, most: 1.5 } });
    await client.dropField('t', 'none');
    assert.deepEqual(Object.keys(await client.fields('t')), ['z']);
    await assert.rejects(client.dropField('t', '2 z'), TypeError);
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
