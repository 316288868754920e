// Follower without a browser: requests are answered when the test says so.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { setImmediate as turn } from 'node:timers/promises';
import { Follower } from '../page/data/follow.js';
import { Mesh } from '../page/data/mesh.js';
import { View } from '../page/drawing/view.js';

/** The binary reply to POINTS. */
function pointsOf(places) {
  const rows = Buffer.alloc(20 * places.length);
  places.forEach(([x, y], id) => {
    rows.writeUInt32LE(id, 20 * id);
    rows.writeDoubleLE(x, 20 * id + 4);
    rows.writeDoubleLE(y, 20 * id + 12);
  });
  return { data: new Uint8Array(rows) };
}

const trianglesOf = (...ids) => ({ data: new Uint8Array(Uint32Array.from(ids).buffer) });

test('a set that is being loaded whole is not shown as a sample meanwhile', async () => {
  const fetched = []; // {requests, answer}
  const shown = [];
  const view = new View();
  view.resize(30, 20);
  const follower = new Follower({
    connection: () => ({ request: async (line, onReply) => (onReply?.(), { keys: { points: 4, triangulated: 'yes', version: 7 }, rows: [] }) }),
    fetchAll: (requests) => new Promise((answer) => fetched.push({ requests, answer })),
    mesh: new Mesh(),
    view,
    most: 1000,
    onShow: () => shown.push(follower.kind),
  });
  const following = follower.follow('t', async () => null);
  await turn();
  const looking = follower.look();
  await turn();
  assert.deepEqual(fetched.map(({ requests }) => requests), [['POINTS t BINARY', 'TRIANGLES t BINARY']]);
  fetched[0].answer([pointsOf([[0, 0], [4, 0], [0, 4], [5, 5]]), trianglesOf(0, 1, 2, 1, 3, 2)]);
  await following;
  assert.deepEqual([await looking, await follower.look()], [true, true]);
  assert.deepEqual([follower.kind, follower.mesh.triangles, shown], ['whole', 2, ['whole']]);
});
