// Tests share daemons ($DELAUNAYD on a free port or on the port given), random numbers that are always the same, and a check of half edges.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { after, before, beforeEach } from 'node:test';
import { connect } from '../index.mjs';

export async function startDaemon(...flags) {
  const child = spawn(process.env.DELAUNAYD, ['--port', '0', '--log-level', 'error', ...flags], { stdio: ['ignore', 'pipe', 'inherit'] });
  const [ready] = await once(child.stdout, 'data');
  const address = ready.toString().trim().split(' ').pop();
  return {
    child,
    url: `delaunay://${address}`,
    port: address.split(':').pop(),
    async end(signal = 'SIGTERM') {
      child.kill(signal);
      return (await once(child, 'exit'))[0];
    },
  };
}

/** Starts a daemon for the tests of a file, and calls take(client, daemon). Each test begins without sets. */
export function useDaemon(take) {
  let daemon, client;
  before(async () => {
    daemon = await startDaemon();
    client = await connect(daemon.url);
    take(client, daemon);
  });
  after(async () => {
    client.close();
    assert.equal(await daemon.end(), 0);
  });
  beforeEach(async () => {
    for (const set of await client.sets()) await client.drop(set);
  });
}

/** Numbers from 0 to 1, the same every time; below a limit, whole ones. */
export function sequence(seed) {
  let state = seed;
  return (limit) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return limit === undefined ? state / 2 ** 32 : Math.floor((state / 2 ** 32) * limit);
  };
}

export const next = (e) => (e % 3 === 2 ? e - 2 : e + 1);

/** Half edges are in pairs, and those without a twin run along the hull. */
export function checkHalfedges({ triangles, halfedges, hull }) {
  const border = new Map();
  assert.equal(halfedges.length, triangles.length);
  halfedges.forEach((twin, e) => {
    if (twin < 0) {
      border.set(triangles[e], triangles[next(e)]);
      return;
    }
    assert.equal(halfedges[twin], e);
    assert.equal(triangles[twin], triangles[next(e)]);
  });
  assert.equal(border.size, triangles.length > 0 ? hull.length : 0);
  if (border.size > 0) hull.forEach((p, i) => assert.equal(border.get(p), hull[(i + 1) % hull.length]));
}
