// Triangles in process, in the order of the daemon's, of all families of points.
//
//     node families.mjs POINTS_PROGRAM URL
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { Delaunator, LiveSet, connect } from '../../../clients/js/index.mjs';

const [points, url] = process.argv.slice(2);
const N = 20000;
const names = spawnSync(points, { encoding: 'utf8' }).stdout.trim().split('\n').map((line) => line.split(' ')[0]);
const client = await connect(url);

assert.ok(names.length > 20);
for (const name of names) {
  const bytes = execFileSync(points, ['--binary', name, String(N)], { maxBuffer: 1 << 28 });
  const coords = new Float64Array(new Uint8Array(bytes).buffer);
  const set = `js.${name}`;
  await client.load(set, coords);
  await client.triangulate(set);
  const d = new Delaunator(coords);
  assert.deepEqual(d.triangles, await client.triangles(set, { clockwise: true }), name);
  if (d.triangles.length > 0) assert.deepEqual(d.hull, await client.hull(set, { clockwise: true }), name);
  const live = LiveSet.from(coords.subarray(0, 400));
  for (let i = 200; i < 400; i++) live.add(coords.subarray(2 * i, 2 * i + 2));
  live.add(coords.subarray(800));
  assert.deepEqual(live.triangulation().triangles, await client.triangles(set), name);
  await client.drop(set);
}
client.close();
