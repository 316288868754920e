const assert = require('node:assert/strict');
const { connect, Delaunator: D, Delaunay: D3 } = require('delaunayd');
const Delaunator = require('delaunayd/delaunator');
const { Delaunay } = require('delaunayd/d3-delaunay');

assert.deepEqual([...Delaunator.from([[0, 0], [1, 0], [0, 1]]).triangles], [0, 2, 1]);
assert.deepEqual([...Delaunay.from([[0, 0], [1, 0], [0, 1]]).neighbors(0)].sort(), [1, 2]);
assert.deepEqual([D, D3], [Delaunator, Delaunay]);
connect().then(async (client) => {
  assert.equal(await client.load('t', [0, 0, 1, 0, 0, 1]), 0);
  assert.equal((await client.mirror('t')).size, 3);
  client.close();
});
