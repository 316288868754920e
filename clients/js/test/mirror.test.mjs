// Mirrors: copies of a set that follow it.
import assert from 'node:assert/strict';
import { once } from 'node:events';
import { mkdtempSync, rmSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { connect } from '../index.mjs';
import { sequence, startDaemon, useDaemon } from './daemon.mjs';

let daemon, client;

useDaemon((...both) => {
  [client, daemon] = both;
});

/** Compares a mirror with POINTS, LISTS and TRIANGLES at the version that the set has now. */
async function compare(mirror, set, from = client) {
  const { version, triangulated } = await from.stat(set);
  await mirror.reached(version);
  assert.equal(mirror.version, version);
  assert.deepEqual(mirror.points(), await from.points(set));
  assert.deepEqual([...mirror.lists()], triangulated ? [...(await from.lists(set))] : []);
  assert.deepEqual(mirror.triangles(), triangulated ? await from.triangles(set) : new Uint32Array());
  assert.deepEqual(mirror.constraints().map(rowOf), (await from.request(`CONSTRAINTS ${set}`)).rows);
}

/** A constraint as a row of CONSTRAINTS. */
const rowOf = ({ a, b, border, number }) => `${a} ${b} ${border ? 'border' : 'line'} ${number}`;

/** Keeps ids and triangles by the reports of a mirror, and checks that each report fits the state before it. */
function ledger(mirror) {
  const triangles = new Set();
  const ids = new Set(mirror.points().ids);
  const constraints = new Set(mirror.constraints().map(rowOf));
  const each = (flat, act) => {
    for (let k = 0; k < flat.length; k += 3) assert.ok(act(flat.slice(k, k + 3).join(' ')));
  };
  const add = (key) => !triangles.has(key) && triangles.add(key);
  each(mirror.triangles(), add);
  mirror.on('change', (change) => {
    each(change.trianglesRemoved, (key) => triangles.delete(key));
    each(change.trianglesAdded, add);
    for (const one of change.constraintsReleased) assert.ok(constraints.delete(rowOf(one)));
    for (const one of change.constraintsAdded) assert.ok((one.places !== undefined || !constraints.has(rowOf(one))) && constraints.add(rowOf(one)));
    for (const id of change.gone) assert.ok(ids.delete(id));
    for (const id of change.moved) assert.ok(ids.has(id));
    for (const id of change.added) assert.ok(!ids.has(id) && ids.add(id));
  });
  return () => {
    const now = new Set();
    each(mirror.triangles(), (key) => now.add(key));
    assert.deepEqual(triangles, now);
    assert.deepEqual(ids, new Set(mirror.points().ids));
    assert.deepEqual(constraints, new Set(mirror.constraints().map(rowOf)));
  };
}

/** One edit of a set with few places, so that there are coincident points and points on a line. */
function edit(random, known) {
  const place = () => `${random(6)} ${random(5)}`;
  const some = () => known[random(known.length)];
  switch (known.length < 4 ? 0 : random(15)) {
    case 1:
    case 2:
    case 3:
      return `DEL ${some()} CASCADE`;
    case 4:
    case 5:
    case 6:
      return `MOVE ${some()} ${place()}`;
    case 7:
      return 'TRIANGULATE';
    case 8:
      return `ADD ${Array.from({ length: 20 }, place).join(' ')}`;
    case 9:
    case 10:
    case 11:
      return `CONSTRAIN${random(3) === 0 ? ' BORDER' : ''} OF ${random(3)} ${some()} ${some()}`;
    case 12:
      return random(3) === 0 ? 'RELEASE ALL' : `RELEASE OF ${random(3)}`;
    default:
      return `ADD ${place()}`;
  }
}

async function change(set, random, from = client) {
  const { ids } = await from.points(set);
  const [command, ...words] = edit(random, ids).split(' ');
  await from.request([command, set, ...words].join(' ')).catch((error) => {
    if (!['CROSSES', 'NOCONSTRAINT', 'SYNTAX'].includes(error.code)) throw error; // SYNTAX: one end only
  });
}

test('a mirror is what POINTS, LISTS, TRIANGLES and CONSTRAINTS say after every edit', async () => {
  for (let seed = 1; seed <= 20; seed++) {
    const set = `m${seed}`;
    const random = sequence(seed);
    await client.create(set);
    const mirror = await client.mirror(set);
    const check = ledger(mirror);
    for (let i = 0; i < 40; i++) {
      await change(set, random);
      await compare(mirror, set);
      check();
    }
    mirror.close();
  }
});

test('a mirror of a box and of fields', async () => {
  const random = sequence(11);
  await client.load('box', [[0, 0], [5, 0], [0, 4], [5, 4]], { fields: { z: [1, 2, 3, 4], w: [5, 6, 7, 8] } });
  await client.triangulate('box');
  const within = [1, 1, 4, 3];
  const whole = await client.mirror('box', { fields: ['w', 'z'] });
  const part = await client.mirror('box', { within });
  const checks = [ledger(whole), ledger(part)];
  for (let i = 0; i < 60; i++) {
    if (i % 3 === 0) await client.setField('box', i % 2 === 0 ? 'z' : 'w', [i, NaN], { first: random(3) }).catch(() => {});
    else await change('box', random);
    const { version } = await client.stat('box');
    await Promise.all([whole.reached(version), part.reached(version)]);
    assert.deepEqual(whole.points(), await client.points('box', { fields: ['w', 'z'] }));
    assert.deepEqual([...whole.lists()], [...(await client.lists('box'))]);
    const ids = await client.within('box', ...within);
    assert.deepEqual(Array.from(part.points().ids), ids);
    for (const { id, x, y } of ids.length > 0 ? await client.get('box', ids) : []) assert.deepEqual(part.point(id), [x, y]);
    assert.deepEqual(part.lists(), await client.lists('box', { within }));
    const all = await client.triangles('box');
    assert.deepEqual([...part.triangles()], [...all].filter((_, k) => [0, 1, 2].some((j) => ids.includes(all[k - (k % 3) + j]))));
    for (const check of checks) check();
  }
  whole.close();
  part.close();
});

test('a mirror of a box has the constraints that meet it, with the places of their ends', async () => {
  await client.load('cb', [[0, 0], [9, 9], [9, 0], [8, 0]]);
  await client.request('CONSTRAIN cb OF 5 0 1 2 3');
  const mirror = await client.mirror('cb', { within: [2, 2, 4, 3] });
  const check = ledger(mirror);
  assert.deepEqual(mirror.constraints(), [{ a: 0, b: 1, border: false, number: 5, places: [0, 0, 9, 9] }]);
  for (const [line, added, released] of [
    ['MOVE cb 1 9 8.5', 1, 0],
    ['MOVE cb 3 9 1', 0, 0],
    ['CONSTRAIN cb BORDER 1 0', 1, 0],
    ['MOVE cb 1 9 0.5', 0, 2],
  ]) {
    const changed = once(mirror, 'change');
    await client.request(line);
    const [{ constraintsAdded, constraintsReleased }] = await changed;
    assert.deepEqual([constraintsAdded.length, constraintsReleased.length], [added, released], line);
    check();
  }
  mirror.close();
});

test('a mirror that lags gets everything, in fewer events', async () => {
  await client.load('lag', Float64Array.from({ length: 2000 }, (_, i) => (i * 7919) % 2003));
  await client.triangulate('lag');
  const mirror = await client.mirror('lag');
  const check = ledger(mirror);
  await Promise.all(Array.from({ length: 500 }, (_, i) => client.move('lag', i, i + 0.5, (i * 31) % 1009)));
  await compare(mirror, 'lag');
  check();
  mirror.close();
});

test('a change names the points and triangles that it is about', async () => {
  await client.load('c', [[0, 0], [4, 0], [0, 4]]);
  await client.triangulate('c');
  const mirror = await client.mirror('c');
  const changed = once(mirror, 'change');
  await client.add('c', 1, 1);
  const [{ version, reset, added, moved, gone, trianglesAdded, trianglesRemoved }] = await changed;
  assert.equal(version, mirror.version);
  assert.deepEqual([reset, [...added], [...moved], [...gone]], [false, [3], [], []]);
  assert.deepEqual([[...trianglesRemoved], trianglesAdded.length], [[0, 1, 2], 9]);
  assert.deepEqual([mirror.size, mirror.point(3), mirror.neighbors(3), mirror.point(4)], [4, [1, 1], [0, 1, 2], undefined]);
  mirror.close();
  await assert.rejects(mirror.reached(Infinity), { code: 'CLOSED' });
});

test('a reset is reported as a difference', async () => {
  await client.load('line', [[0, 0], [1, 1], [2, 2]]);
  await client.triangulate('line');
  const mirror = await client.mirror('line');
  const changed = once(mirror, 'change');
  await client.move('line', 2, 0, 2); // a point that leaves the line changes what all rings mean
  const [{ reset, added, moved, gone, trianglesAdded }] = await changed;
  assert.deepEqual([reset, [...added], [...moved], [...gone], [...trianglesAdded]], [true, [], [2], [], [0, 1, 2]]);
  mirror.close();
});

test('a mirror ends when its set is dropped, and is refused without a set', async () => {
  await client.create('short');
  const mirror = await client.mirror('short');
  const waiting = assert.rejects(mirror.reached(Infinity), { code: 'DROPPED' });
  const dropped = once(mirror, 'dropped');
  await client.drop('short');
  await dropped;
  await waiting;
  await assert.rejects(client.mirror('short'), { code: 'NOSET' });
});

/** A server before the daemon whose connections can be ended. */
async function proxy() {
  const peers = new Set();
  const server = net.createServer((peer) => {
    const inner = net.connect(daemon.port, '127.0.0.1');
    for (const socket of [peer, inner]) {
      peers.add(socket);
      socket.on('error', () => {}).on('close', () => [peer, inner].forEach((s) => s.destroy() && peers.delete(s)));
    }
    peer.pipe(inner).pipe(peer);
  });
  await once(server.listen(0, '127.0.0.1'), 'listening');
  return {
    url: `delaunay://127.0.0.1:${server.address().port}`,
    cut: () => peers.forEach((socket) => socket.destroy()),
    end: () => server.close(),
  };
}

test('a mirror whose connection is lost goes on where it was', async () => {
  const random = sequence(7);
  const between = await proxy();
  const other = await connect(between.url);
  await client.load('cut', [[0, 0], [4, 0], [0, 4], [5, 5]]);
  await client.triangulate('cut');
  const mirror = await other.mirror('cut');
  const check = ledger(mirror);
  for (let i = 0; i < 10; i++) {
    const resumed = once(mirror, 'resumed');
    between.cut();
    await change('cut', random);
    await resumed;
    await compare(mirror, 'cut');
    check();
  }
  other.close();
  await assert.rejects(mirror.reached(Infinity), { code: 'CLOSED' });
  between.end();
});

test('a mirror survives its daemon, and sees that its set is gone', async () => {
  const directory = mkdtempSync(path.join(tmpdir(), 'delaunay_mirror_'));
  const flags = ['--data', path.join(directory, 'data'), '--unix', path.join(directory, 'socket')];
  const random = sequence(3);
  let own = await startDaemon(...flags);
  const reader = await connect(path.join(directory, 'socket'));
  await reader.load('kept', [[0, 0], [4, 0], [0, 4], [5, 5]]);
  await reader.triangulate('kept');
  const mirror = await reader.mirror('kept');
  const check = ledger(mirror);
  for (let i = 0; i < 3; i++) {
    await change('kept', random, reader);
    const resumed = once(mirror, 'resumed');
    await own.end('SIGKILL');
    own = await startDaemon(...flags);
    await reader.open();
    await change('kept', random, reader);
    await resumed;
    await compare(mirror, 'kept', reader);
    check();
  }
  await own.end('SIGKILL');
  const dropped = once(mirror, 'dropped');
  own = await startDaemon('--unix', path.join(directory, 'socket'));
  await dropped;
  reader.close();
  await own.end();
  rmSync(directory, { recursive: true });
});
