// A TCP proxy that passes bytes on in pieces, late, or not to the end, as a random sequence decides.
import { once } from 'node:events';
import { connect, createServer } from 'node:net';
import { setTimeout as sleep } from 'node:timers/promises';

/** Numbers from 0 to 1 that a seed determines. */
export function sequence(seed) {
  let state = (seed % 2147483646) + 1;
  const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
  for (let k = 0; k < 5; k++) next(); // the first ones of seeds that are near each other are alike
  return next;
}

/** The faults of one direction of a connection. */
function faultsOf(random) {
  const kind = ['none', 'split', 'slow', 'pause', 'cut'][Math.floor(5 * random())];
  return {
    piece: kind === 'split' ? 1 + Math.floor(40 * random()) : Infinity, // bytes
    until: kind === 'split' ? 4000 : 0, // bytes that are split
    delay: kind === 'slow' ? 200 * random() : 0, // ms before each piece
    slow: 20, // pieces that are delayed
    pauseAt: kind === 'pause' ? Math.floor(3000 * random() ** 2) : Infinity, // bytes
    pause: 3000 * random(), // ms
    cutAt: kind === 'cut' ? Math.floor(10 ** (6 * random())) : Infinity, // bytes
  };
}

/** Waits until a socket takes more, or is closed. */
function room(socket) {
  return new Promise((resolve) => {
    const done = () => {
      socket.off('drain', done).off('close', done);
      resolve();
    };
    socket.on('drain', done).on('close', done);
    if (socket.destroyed) done();
  });
}

async function pass(from, to, faults) {
  let passed = 0;
  for await (const chunk of from.iterator({ destroyOnReturn: false })) {
    for (let at = 0; at < chunk.length; ) {
      let n = Math.min(chunk.length - at, passed < faults.until ? faults.piece : Infinity, faults.cutAt - passed);
      if (passed < faults.pauseAt) n = Math.min(n, faults.pauseAt - passed);
      if (faults.delay > 0 && faults.slow-- > 0) await sleep(faults.delay);
      if (!to.write(chunk.subarray(at, at + n))) await room(to);
      if (passed < faults.until) await sleep(0);
      at += n;
      passed += n;
      if (passed === faults.pauseAt) await sleep(faults.pause);
      if (passed === faults.cutAt) {
        from.destroy();
        to.destroy();
        return;
      }
    }
  }
  to.end();
}

/** Listens before a port. Returns {port, random, faulty}: the next `faulty` connections have faults, which the sequence decides. */
export async function roughly(target) {
  const proxy = { random: null, faulty: 0 };
  const server = createServer({ allowHalfOpen: true }, (near) => {
    const far = connect({ port: target, host: '127.0.0.1', noDelay: true, allowHalfOpen: true });
    near.setNoDelay(true);
    for (const socket of [near, far]) socket.on('error', () => {});
    const isFaulty = proxy.faulty-- > 0;
    for (const [from, to] of [[near, far], [far, near]]) {
      const faults = faultsOf(isFaulty ? proxy.random : () => 0);
      pass(from, to, faults).catch(() => to.destroy());
    }
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  proxy.port = server.address().port;
  return proxy;
}
