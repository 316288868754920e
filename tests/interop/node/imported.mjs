import assert from 'node:assert/strict';
import { connect, Delaunator as D, Delaunay as D3, Disconnected, LiveSet, Refused, Triangulation, useServer, Voronoi as V } from 'delaunayd';
import Delaunator from 'delaunayd/delaunator';
import { Delaunay, Voronoi } from 'delaunayd/d3-delaunay';

assert.deepEqual([...new Delaunator([0, 0, 1, 0, 0, 1]).triangles], [0, 2, 1]);
assert.equal(Delaunay.from([[0, 0], [9, 0], [0, 9]]).find(8, 1), 1);
assert.deepEqual([D, D3, V, typeof useServer], [Delaunator, Delaunay, Voronoi, 'function']);
assert.equal(Delaunay.from([[0, 0], [9, 0], [0, 9]]).voronoi([0, 0, 9, 9]).cellPolygon(1).length, 5);
assert.equal(LiveSet.from([[0, 0], [9, 0], [0, 9]]).nearest([8, 1])[0], 1);
assert.equal((await Triangulation.from([0, 0, 1, 0, 0, 1])).triangles.length, 3);
const client = await connect();
await assert.rejects(client.stat('none'), (e) => e instanceof Refused && !(e instanceof Disconnected));
client.close();
