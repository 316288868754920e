// The set in process, compared with the daemon after the same edits.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { after, test } from 'node:test';
import { Delaunator, LiveSet, NONE, connect } from '../index.mjs';
import { sequence } from './daemon.mjs';

const client = await connect('private:');
after(() => client.close());

const random = sequence(7);
const any = (n, scale = 1000) => Float64Array.from({ length: 2 * n }, () => scale * random());

/** Everything that both know is equal. */
async function compare(live, name) {
  assert.deepEqual(live.triangulation().triangles, await client.triangles(name));
  assert.deepEqual(live.triangulation({ clockwise: true }).triangles, await client.triangles(name, { clockwise: true }));
  assert.deepEqual(live.hull(), await client.hull(name));
  assert.deepEqual(live.edges(), await client.edges(name));
  assert.deepEqual(live.ids(), (await client.points(name)).ids);
  assert.equal(live.size, (await client.stat(name)).points);
  for (const [id, ring] of await client.lists(name)) assert.deepEqual(live.neighbors(id), ring);
}

test('points come, go and move as on the daemon', async () => {
  const points = any(300, 20).map(Math.round); // many coincide, are collinear or on a circle
  const live = LiveSet.from(points);
  await client.load('edits', points);
  await client.triangulate('edits');
  for (let round = 0; round < 30; round++) {
    const [id, x, y] = [random() * 300, random() * 20, random() * 20].map(Math.round);
    if (live.ids().includes(id)) {
      live.move(id, x, y);
      await client.move('edits', id, x, y);
      const gone = live.ids().slice(round, round + 3);
      assert.equal(live.delete(gone), await client.delete('edits', gone));
    }
    const more = any(3, 20);
    assert.equal(live.add(more), await client.load('edits', more));
    if (round % 10 === 9) await compare(live, 'edits');
  }
  const last = live.nextId - 1;
  const [{ x, y }] = await client.get('edits', [last]);
  assert.deepEqual(live.point(last), [x, y]);
  assert.deepEqual([...live.coincident()], [...(await client.coincident('edits'))].flat());
});

test('a large set is edited and searched as on the daemon', async () => {
  const points = any(20000);
  const live = LiveSet.from(points.subarray(0, 20000));
  await client.load('large', points.subarray(0, 20000));
  await client.triangulate('large');
  live.add(points.subarray(20000));
  await client.load('large', points.subarray(20000));
  const places = any(1000, 1100);
  assert.deepEqual(live.locate(places), await client.locateAll('large', places));
  assert.deepEqual(live.nearest(places, 5), await client.nearestAll('large', places, 5));
  assert.deepEqual(live.nearest([[1, 2]], 1), await client.nearestAll('large', [[1, 2]], 1));
  assert.deepEqual(live.triangulation().triangles, await client.triangles('large'));
});

test('values between points are those of the daemon', async () => {
  const points = any(2000);
  const values = Float64Array.from({ length: 2000 }, (_, i) => Math.sin(points[2 * i] / 100) * points[2 * i + 1]);
  values[7] = NaN;
  const live = LiveSet.from(points, { values });
  await client.load('values', points, { fields: { z: values } });
  await client.triangulate('values');
  const places = any(500, 1050);
  for (const method of ['linear', 'natural', 'laplace', 'nearest', 'smooth']) {
    assert.deepEqual(live.interpolate(places, { method }), await client.interpolate('values', 'z', places, { method }));
    const options = { method, maxEdge: 30 };
    assert.deepEqual(live.interpolate(places, options), await client.interpolate('values', 'z', places, options));
  }
  const levels = [500, -100, 0, 0];
  const { levels: of, offsets, coords, closed } = live.contours(levels);
  const lines = await client.contourLines('values', 'z', { levels });
  assert.equal(of.length, lines.length);
  lines.forEach((line, i) => {
    assert.deepEqual([of[i], closed[i] === 1], [line.level, line.closed]);
    assert.deepEqual(coords.slice(2 * offsets[i], 2 * offsets[i + 1]), line.coords);
  });
  live.setValues([NaN, 5], { first: 6 });
  assert.equal(live.interpolate(points.subarray(14, 16))[0], 5);
});

test('Voronoi cells are those of the daemon, also after deletions', async () => {
  const points = any(400);
  const live = LiveSet.from(points);
  await client.load('cells', points);
  await client.triangulate('cells');
  for (let round = 0; round < 2; round++) {
    const { ids, offsets, coords } = await client.voronoi('cells', { box: [100, 100, 800, 900] });
    const cells = live.cells([100, 100, 800, 900]);
    ids.forEach((id, i) => {
      const expected = coords.slice(2 * offsets[i], 2 * offsets[i + 1]);
      assert.deepEqual(cells.coords.slice(2 * cells.offsets[id], 2 * cells.offsets[id + 1]), expected);
    });
    assert.equal(cells.coords.length, coords.length);
    const gone = live.ids().filter((id) => id % 8 !== 3);
    if (gone.length > 0) assert.equal(live.delete(gone), await client.delete('cells', gone));
  }
});

test('what is wrong is refused, and nothing changes', () => {
  const live = LiveSet.from([0, 0, 4, 0, 0, 4]);
  const refused = (code, act) => assert.throws(act, { name: 'Refused', code });
  refused('NUMBER', () => live.add([1, NaN]));
  refused('RANGE', () => live.add([1, Infinity]));
  refused('RANGE', () => live.move(0, 1e-200, 0));
  refused('NUMBER', () => live.nearest([NaN, 0]));
  refused('RANGE', () => live.locate([1e300, 0]));
  refused('RANGE', () => live.cells([0, 0, 0, 1]));
  for (const id of [3, -1, 1.5, 2 ** 32, '0', NaN]) {
    refused('NOPOINT', () => live.move(id, 1, 1));
    refused('NOPOINT', () => live.delete([0, id]));
    refused('NOPOINT', () => live.point(id));
    refused('NOPOINT', () => live.neighbors(id));
  }
  refused('NOPOINT', () => live.setValues([1, 2, 3, 4]));
  refused('NOFIELD', () => live.interpolate([1, 1]));
  refused('NOFIELD', () => live.contours([1]));
  assert.throws(() => live.add([1]), /odd number of coordinates/);
  assert.throws(() => live.add([1, 1], { values: [1, 2] }), /2 values for 1 points/);
  assert.throws(() => live.add([1, 1], { values: [Infinity] }), RangeError);
  assert.throws(() => live.nearest([1, 1], 0), RangeError);
  assert.throws(() => live.interpolate([1, 1], { method: 'cubic' }), TypeError);
  assert.throws(() => live.contours([NaN]), RangeError);
  assert.throws(() => new LiveSet({ tolerance: -1 }), { code: 'RANGE' });
  assert.deepEqual([live.size, live.nextId, live.triangulation().triangles.length], [3, 3, 3]);
});

test('sizes that 32 bits do not hold are refused', () => {
  const live = LiveSet.from(any(20));
  assert.throws(() => live.nearest(any(20), 2 ** 30), { code: 'NOMEM' });
  assert.throws(() => live.nearest(any(16), 2 ** 26), { code: 'NOMEM' });
  assert.throws(() => live.nearest([1, 1], 2 ** 32 - 1), { code: 'NOMEM' });
  assert.equal(live.nearest([1, 1], 100).filter((id) => id !== NONE).length, 20);
});

test('an empty set has answers', () => {
  const live = new LiveSet({ tolerance: 0.5 });
  assert.deepEqual([...live.nearest([1, 1], 2), ...live.locate([1, 1])], [NONE, NONE, NONE, NONE, NONE]);
  assert.deepEqual([live.hull().length, live.triangulation().triangles.length, live.size], [0, 0, 0]);
  live.add([0, 0, 0.25, 0]);
  assert.deepEqual([...live.coincident()], [1, 0]);
});

test('the memory of many sets is given back, by free() and without', async () => {
  const points = any(50);
  const rss = () => process.memoryUsage().rss / 2 ** 20;
  const many = async () => {
    for (let k = 0; k < 10000; k++) {
      const live = LiveSet.from(points);
      if (k % 2 === 0) live.free();
      if (k % 1000 === 0) await new Promise((done) => setTimeout(done, 1));
    }
  };
  await many();
  const before = rss();
  await many();
  await many();
  assert.ok(rss() < before + 100, `${before} MiB before, ${rss()} after`);
  const freed = new LiveSet();
  freed.free();
  freed.free();
  assert.throws(() => freed.size, /has been freed/);
});

test('half edges and triangles are those of Delaunator', () => {
  const points = any(500);
  const { triangles, halfedges } = LiveSet.from(points).triangulation({ clockwise: true });
  const d = new Delaunator(points);
  assert.deepEqual([triangles, halfedges], [d.triangles, d.halfedges]);
});

test('sets that nobody has any more give their memory back', () => {
  const program = `const { LiveSet, Delaunator, Constrainautor } = require(${JSON.stringify(new URL('../index.js', import.meta.url).pathname)});
    const points = Float64Array.from({ length: 20 }, Math.random);
    const megabytes = () => process.memoryUsage().rss >> 20;
    const turn = () => new Promise((done) => setTimeout(done, 50));
    (async () => {
      for (let i = 0; i < 50000; i++) LiveSet.from(points).free();
      for (let i = 0; i < 50000; i++) new Delaunator(points);
      const freed = megabytes();
      for (let i = 0; i < 20000; i++) LiveSet.from(points);
      for (let i = 0; i < 5000; i++) new Constrainautor(new Delaunator(points), [[0, 1]]);
      const held = megabytes();
      for (let i = 0; i < 6; i++) { globalThis.gc(); await turn(); }
      console.log(JSON.stringify({ freed, held, later: megabytes() }));
    })();`;
  const { freed, held, later } = JSON.parse(execFileSync(process.execPath, ['--expose-gc', '-e', program], { encoding: 'utf8' }));
  assert.ok(freed < 150 && held > freed + 100 && later < freed + 100, JSON.stringify({ freed, held, later }));
});
