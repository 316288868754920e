// Against a real daemon, $DELAUNAYD.

import assert from 'node:assert/strict';
import net from 'node:net';
import { describe, it as test } from 'node:test';
import { connect, Disconnected, NONE, Refused, Triangulation } from '../index.mjs';
import { checkHalfedges, useDaemon } from './daemon.mjs';

let client;

describe('a client', () => {
  useDaemon((c) => {
    client = c;
  });

  const square = Float64Array.of(0, 0, 4, 0, 4, 4, 0, 4, 2, 2);

  test('results of commands without methods written by hand', async () => {
    await client.load('t', square, { fields: { z: [0, 1, 2, 3, 4] } });
    assert.equal(await client.dropField('t', 'z'), undefined);
    assert.deepEqual(await client.fields('t'), {});
    assert.equal((await client.trace('t'))[0][0], 'grid');
    assert.equal(await client.wait(0, 1), 0);
    assert.equal((await client.stat('t')).triangulated, false);
    await assert.rejects(client.delete('t', [0, 99]), { code: 'NOPOINT' });
    await assert.rejects(client.drop('t u'), TypeError);
    await assert.rejects(client.snapshot(), { code: 'IO' });
  });

  test('a session', async () => {
    assert.equal(await client.load('t', square), 0);
    assert.equal((await client.triangulate('t', { method: 'divide' })).triangles, 4);
    assert.deepEqual([...(await client.triangles('t'))], [0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 3, 4]);
    assert.equal((await client.edges('t')).length, 16);
    const rings = await client.lists('t');
    assert.deepEqual([...rings.keys()], [4, 0, 1, 2, 3]);
    assert.deepEqual([...rings.get(0)], [1, 4, 3]);
    assert.deepEqual([...(await client.hull('t'))], [0, 1, 2, 3]);
    assert.deepEqual(await client.nearest('t', 3, 2), [{ id: 4, x: 2, y: 2, distance: 1 }]);
    assert.deepEqual(await client.locate('t', 2, 1), { where: 'inside', ids: [0, 1, 4] });
    assert.deepEqual(await client.locate('t', 9, 1), { where: 'outside', ids: [] });
    assert.deepEqual([...(await client.locateAll('t', [2, 1, 9, 1]))], [0, 1, 4, NONE, NONE, NONE]);
    const places = [{ lon: 3, lat: 2 }];
    const look = { getX: (p) => p.lon, getY: (p) => p.lat };
    assert.deepEqual([...(await client.nearestAll('t', places, 6, look))], [4, 1, 2, 0, 3, NONE]);
    assert.deepEqual([...(await client.nearestAll('t', [[4, 4], [0, 1]]))], [2, 0]);
    await assert.rejects(client.nearestAll('t', [0, 0], 5000), /RANGE/);
    assert.deepEqual(await client.within('t', 0, 0, 4, 2), [0, 1, 4]);
    assert.equal(await client.add('t', 1e-7, 3), 5);
    assert.equal(await client.delete('t', [0, 1]), 2);
    await client.move('t', 2, 5, 5);
    const { ids, coords } = await client.points('t');
    assert.deepEqual([...ids], [2, 3, 4, 5]);
    assert.deepEqual([...coords], [5, 5, 0, 4, 2, 2, 1e-7, 3]);
    assert.equal((await client.check('t')).delaunay, true);
    assert.equal(await client.ttl('t'), undefined);
    await client.expire('t', 1000);
    assert.ok((await client.ttl('t')) > 900);
    assert.deepEqual([await client.persist('t'), await client.persist('t')], [true, false]);
    const digest = await client.digest('t');
    assert.match(digest, /^[0-9a-f]{16}$/);
    assert.equal(await client.digest('t'), digest);
    const { points, triangulated, tol } = await client.stat('t');
    assert.deepEqual([points, triangulated, tol], [4, true, 0]);
    const { uptime_s, version } = await client.info();
    assert.deepEqual([typeof uptime_s, typeof version], ['number', 'string']);
    await client.create('tolerant', 0.5);
    await client.load('tolerant', [0, 0, 0.25, 0]);
    assert.deepEqual([...(await client.coincident('tolerant'))], [[1, 0]]);
    assert.deepEqual(await client.get('tolerant', [1, 0]), [{ id: 1, x: 0.25, y: 0 }, { id: 0, x: 0, y: 0 }]);
  });

  // Two parcels with a common side, the left one with a hole.
  const parcels = [[0, 0], [6, 0], [6, 6], [0, 6], [2, 2], [4, 2], [4, 4], [2, 4], [12, 0], [12, 6]];

  async function loadParcels() {
    await client.load('t', parcels, { fields: { z: parcels.map(([x]) => x) } });
    await client.triangulate('t');
    for (const [number, ring] of [[1, [0, 1, 2, 3]], [1, [4, 5, 6, 7]], [2, [1, 8, 9, 2]]]) {
      assert.equal((await client.constrainPath('t', ring, { closed: true, border: true, number })).added, 4);
    }
  }

  test('constraints are declared, listed and released', async () => {
    await loadParcels();
    assert.equal((await client.constrain('t', [[0, 4], [6, 2]], { number: 7 })).added, 2);
    const { ends, border, number } = await client.constraints('t', { number: 7 });
    assert.deepEqual([[...ends], [...border], [...number]], [[0, 4, 2, 6], [0, 0], [7, 7]]);
    const those = await client.constraints('t', { ids: [8] });
    assert.deepEqual([[...those.ends], [...those.border], [...those.number]], [[1, 8, 8, 9], [1, 1], [2, 2]]);
    assert.deepEqual([...(await client.edges('t', { constrained: true }))].slice(0, 4), [0, 1, 0, 3]);
    await assert.rejects(client.constrain('t', [3, 4, 0, 7]), { code: 'CROSSES' });
    await assert.rejects(client.constrain('t', [0, -1]), RangeError);
    await assert.rejects(client.constrainPath('t', [0, 1], { closed: true }), RangeError);
    await assert.rejects(client.release('t', [[0, 4]]), { code: 'NOCONSTRAINT' });
    assert.equal(await client.release('t', [[0, 4]], { number: 7 }), 1);
    assert.equal(await client.releaseAll('t', { number: 2, border: true }), 4);
    assert.equal(await client.releaseAll('t'), 9);
    assert.equal((await client.constraints('t')).ends.length, 0);
  });

  test('constraints that cross get points in common', async () => {
    await client.load('t', [0, 0, 4, 4, 0, 4, 4, 0]);
    const { first, added, split, deviation } = await client.constrain('t', [0, 1, 2, 3], { split: true });
    assert.deepEqual([first, added, split, deviation], [4, 1, 2, 0]);
    assert.deepEqual(await client.get('t', [4]), [{ id: 4, x: 2, y: 2 }]);
  });

  test('meshes are refined, and what is left is counted', async () => {
    await client.load('m', [0, 0, 8, 0, 8, 1, 0, 1]);
    await client.triangulate('m');
    const { first, hull, unrefined, angle, added } = await client.refine('m', { angle: 30, area: 0.1, limit: 1000 });
    assert.deepEqual([first, hull, unrefined], [4, 4, 0]);
    assert.ok(angle >= 30 && added > 40);
    assert.equal((await client.refine('m', { angle: 30, area: 0.1, inside: 0 })).added, 0);
    assert.equal((await client.refine('m', { length: 0.01, keep: true, limit: 3 })).added, 3);
    assert.equal((await client.refine('m')).added, 0);
    await assert.rejects(client.refine('m', { angle: 60 }), /60/);
  });

  test('the angles of all triangles, and of those inside a border', async () => {
    await client.load('q', [[0, 0], [4, 0], [4, 4], [0, 4], [3, 1]]);
    await client.triangulate('q');
    const { counts, ...sizes } = await client.quality('q');
    assert.deepEqual(sizes, {
      triangles: 4, area: 16, angle: 18.43494882292201, largest: 116.56505117707799, shortest: Math.SQRT2, longest: 4.242640687119285,
    });
    assert.deepEqual(counts, [0, 0, 0, 2, 0, 0, 0, 0, 0, 2, 0, 0]);
    await client.constrainPath('q', [0, 4, 3], { closed: true, border: true, number: 2 });
    assert.equal((await client.quality('q', { inside: 2 })).angle, 45);
    await assert.rejects(client.quality('q', { inside: 3 }), { code: 'NOREGION' });
  });

  test('regions, and nothing outside of a border', async () => {
    await loadParcels();
    const { triangles, area, borders } = await client.regions('t');
    assert.deepEqual([triangles, area, borders.get(1).area, borders.get(2)], [10, 68, 32, { closed: true, triangles: 2, area: 36 }]);
    const places = [[1, 1], [3, 3], [6, 3], [9, 3]];
    assert.deepEqual(await client.regionsAt('t', places), [[1], [], [1, 2], [2]]);
    assert.equal((await client.regionsAt('t', Array.from({ length: 2001 }, () => [9, 3]))).filter(([k]) => k === 2).length, 2001);
    assert.deepEqual(await client.regionsAt('t', []), []);
    assert.equal((await client.triangles('t', { inside: 2 })).length, 6);
    assert.equal((await client.triangles('t', { inside: true, clockwise: true })).length, 30);
    assert.equal((await client.triangles('t', { inside: false })).length, 36);
    assert.equal((await client.edges('t', { inside: 2 })).length, 10);
    assert.deepEqual([...(await client.interpolate('t', 'z', places, { inside: true }))], [1, NaN, 6, 9]);
    assert.deepEqual([...(await client.raster('t', 'z', [0, 2, 12, 4], 4, 1, { inside: 2 }))].map(Number.isNaN), [true, true, false, false]);
    assert.equal((await client.contourLines('t', 'z', { levels: [3], inside: true })).length, 2);
  });

  test('paths become points and constraints in one request', async () => {
    const ring = [[0, 0], [4, 0], [0, 4], [0, 0]];
    const fields = { z: [[1, 2, 3, 1], [NaN, 5]] };
    const facts = await client.loadPaths('t', [ring, Float64Array.of(1, 1, 2, 1)], { border: true, number: 3, fields });
    assert.deepEqual([facts.first, facts.added, facts.constraints], [0, 5, 4]);
    assert.deepEqual([...(await client.constraints('t')).number], [3, 3, 3, 4]);
    assert.deepEqual([...(await client.getField('t', 'z', [4]))], [5]);
    await client.triangulate('t');
    await assert.rejects(client.loadPaths('t', [[[-1, 1.5], [1.5, 1.5]]]), /line 3 crosses/);
    assert.equal((await client.loadPaths('t', [[-1, 1.5, 1.5, 1.5]], { split: true })).split, 2);
    await assert.rejects(client.loadPaths('t', [[[0, 0]]], { fields: { z: [[1, 2]] } }), RangeError);
  });

  test('points come in arrays of any kind', async () => {
    const kinds = [square, Float32Array.from(square), [...square], [[0, 0], [4, 0], [4, 4], [0, 4], [2, 2]], new Set([[0, 0], [4, 0], [4, 4], [0, 4], [2, 2]])];
    for (const points of kinds) {
      await client.load('k', points);
      assert.deepEqual((await client.points('k')).coords, square);
      await client.drop('k');
    }
    await client.load('k', [{ lon: 1, lat: 2 }], { getX: (p) => p.lon, getY: (p) => p.lat });
    assert.deepEqual(await client.get('k', [0]), [{ id: 0, x: 1, y: 2 }]);
  });

  test('errors leave the connection', async () => {
    await assert.rejects(client.triangulate('missing'), (e) => e instanceof Refused && e.code === 'NOSET');
    await assert.rejects(client.load('t', [[0, 0], [NaN, 1]]), { code: 'NUMBER' });
    await assert.rejects(client.load('t', Float64Array.of(1)), TypeError);
    await assert.rejects(client.load('t t', square), TypeError);
    await assert.rejects(client.request('PING\nPING'), TypeError);
    assert.deepEqual(await client.sets(), []);
  });

  test('requests need not wait for one another', async () => {
    const all = Array.from({ length: 500 }, (_, i) => client.add('t', i, 0.5));
    assert.deepEqual(await Promise.all(all), Array.from({ length: 500 }, (_, i) => i));
  });

  test('replies may come in pieces of any size', async () => {
    const text = 'OK 2 a=b\none\r\ntwo\n# progress 5 x\nOK 0 bytes=5\nab\ncdERR NOSET none\nOK 0\n';
    for (const size of [1, 2, 3, 7, 100]) {
      const server = net.createServer(async (peer) => {
        peer.on('error', () => {});
        for (let at = 0; at < text.length; at += size) {
          peer.write(text.slice(at, at + size));
          if (size < 7) await new Promise(setImmediate);
        }
        peer.end();
      });
      await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
      const c = await connect(`delaunay://127.0.0.1:${server.address().port}`);
      const said = [];
      const replies = [c.request('A'), c.request('B', { progress: (t) => said.push(t) }), c.request('C'), c.request('D'), c.request('E')];
      const done = await Promise.allSettled(replies);
      assert.deepEqual(done[0].value, { keys: { a: 'b' }, rows: ['one', 'two'], data: null });
      assert.equal(done[1].value.data.toString(), 'ab\ncd');
      assert.deepEqual(said, ['progress 5 x']);
      assert.equal(done[2].reason.code, 'NOSET');
      assert.equal(done[3].status, 'fulfilled');
      assert.match(done[4].reason.message, /lost/);
      assert.ok(done[4].reason instanceof Disconnected);
      c.close();
      server.close();
    }
  });

  test('bad URLs and closed ports are reported', async () => {
    await assert.rejects(connect('http://localhost'), TypeError);
    for (const url of ['delaunay://', 'unix://host/path', 'unix://', 'nonsense', '']) await assert.rejects(connect(url), TypeError);
    await assert.rejects(connect('delaunay://127.0.0.1:1'), { code: 'ECONNREFUSED' });
    await assert.rejects(connect('unix:///nowhere/socket'), { code: 'ENOENT' });
  });

  test('a view like Delaunator', async () => {
    const points = Array.from({ length: 1000 }, (_, i) => ({ x: Math.sin(i) * i, y: Math.cos(1.1 * i) * i }));
    for (const clockwise of [false, true]) {
      const t = await Triangulation.from(points, { client, clockwise, getX: (p) => p.x, getY: (p) => p.y });
      assert.equal(t.coords.length, 2000);
      assert.equal(t.triangles.length, 3 * (2 * 1000 - 2 - t.hull.length));
      checkHalfedges(t);
      const [a, b, c] = t.triangles;
      const area = (i, j, k) => (t.coords[2 * j] - t.coords[2 * i]) * (t.coords[2 * k + 1] - t.coords[2 * i + 1]) -
        (t.coords[2 * j + 1] - t.coords[2 * i + 1]) * (t.coords[2 * k] - t.coords[2 * i]);
      assert.ok(clockwise ? area(a, b, c) < 0 : area(a, b, c) > 0);
    }
    const flat = await Triangulation.from([0, 0, 4, 0, 4, 4, 0, 4, 2, 2], { client });
    assert.deepEqual([flat.triangles.length, ...flat.hull], [12, 0, 1, 2, 3]);
    flat.coords.set([3, 3], 8);
    assert.equal(await flat.update(), flat);
    checkHalfedges(flat);
    const line = await Triangulation.from([[0, 0], [1, 1], [2, 2]], { client });
    assert.deepEqual([line.triangles.length, ...line.hull], [0, 0, 1, 2]);
    await assert.rejects(Triangulation.from([[0, Infinity]], { client }), { code: 'RANGE' });
    assert.deepEqual(await client.sets(), []);
  });

  test('a million points', async () => {
    const coords = Float64Array.from({ length: 2000000 }, Math.random);
    const t = await Triangulation.from(coords, { client });
    assert.equal(t.triangles.length, 3 * (2 * 1000000 - 2 - t.hull.length));
    let open = 0;
    for (let e = 0; e < t.halfedges.length; e++) open += t.halfedges[e] < 0;
    assert.equal(open, t.hull.length);
  });
});
