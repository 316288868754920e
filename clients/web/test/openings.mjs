// Opens the page many times, while connections are slow, in pieces or cut, or the gateway or the daemon is stopped for a while. Each
// opening must show the set within 30 s. For `make soak-web`; a seed repeats the faults, not their times.
import { setTimeout as sleep } from 'node:timers/promises';
import { roughly, sequence } from './rough.mjs';
import { ask, listen, makeSet, pagePort, pauseDaemon, pauseGateway, port, start, stop, visit, waitFor } from './stage.mjs';

const LIMIT_MS = 30000;
const FAULTY = 4; // connections of each opening
const KINDS = ['none', 'behind', 'before', 'both', 'gateway', 'daemon'];
const PAUSES = { gateway: pauseGateway, daemon: pauseDaemon };
const { OPENINGS = '200', SEED = '1', POINTS = '1000' } = process.env;

await start();
await makeSet('opened', Number(POINTS));
const triangles = Number(/triangles=(\d+)/.exec((await ask('STAT opened'))[0])[1]);
const behind = await roughly(port); // between the gateway and the daemon
await listen(0, behind.port);
const before = await roughly(pagePort); // between the browser and the gateway

const isShown = (n) => {
  const { mesh, scene } = window.app;
  return mesh.triangles === n && scene.counts.whole > 0 && !/loading|lost/.test(document.getElementById('message').textContent);
};

/** The time of an opening, in ms. */
async function opening(kind, random) {
  behind.random = before.random = random;
  behind.faulty = ['behind', 'both'].includes(kind) ? FAULTY : 0;
  const began = Date.now();
  let paused;
  const page = await visit('#set=opened', {
    at: before.port,
    onDocument: () => {
      before.faulty = ['before', 'both'].includes(kind) ? FAULTY : 0;
      paused = PAUSES[kind] && sleep(300 * random()).then(() => PAUSES[kind](3000 * random()));
    },
  });
  try {
    await waitFor(page, isShown, { timeout: LIMIT_MS }, triangles);
    if (page.faults.length > 0) throw new Error(page.faults.join('\n'));
    return Date.now() - began;
  } finally {
    behind.faulty = before.faulty = 0;
    await paused;
    await page.browserContext().close();
  }
}

const times = [];
for (let k = 0; k < Number(OPENINGS); k++) {
  const random = sequence(100000 * Number(SEED) + k);
  const kind = KINDS[Math.floor(KINDS.length * random())];
  await opening(kind, random).then(
    (ms) => times.push(ms),
    (error) => console.log(`opening ${k} (${kind}): ${error.message}`),
  );
}
times.sort((a, b) => a - b);
console.log(`${times.length} of ${OPENINGS} openings showed the set; median ${times[times.length >> 1]} ms, longest ${times.at(-1)} ms`);
await stop();
process.exit(times.length === Number(OPENINGS) ? 0 : 1);
