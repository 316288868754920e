// The page while the daemon, the gateway or the graphics memory has faults, in a real browser.
import assert from 'node:assert/strict';
import { once } from 'node:events';
import { connect, createServer } from 'node:net';
import { after, afterEach, before, test } from 'node:test';
import { ask, closePages, drawnShare, listen, makeSet, open, port, says, signalGateway, start, stop, visit, waitFor } from './stage.mjs';

before(async () => {
  await start();
  await makeSet('set', 300);
});
afterEach(closePages);
after(stop);

const isWhole = (page) => waitFor(page, () => window.app.follower.kind === 'whole' && window.app.scene.counts.whole > 0);

/** A gateway whose daemon is `answer`, which gets each connection and whether it is to be passed on. */
async function behindGateway(answer) {
  const server = createServer({ allowHalfOpen: true }, (socket) => {
    socket.on('error', () => {});
    answer(socket, () => {
      const daemon = connect({ port, host: '127.0.0.1', allowHalfOpen: true });
      daemon.on('error', () => {});
      socket.pipe(daemon).pipe(socket);
    });
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  await listen(0, server.address().port);
  return server;
}

test('when the graphics memory is lost the page waits for another one, and shows what it showed, with the edits since', async () => {
  const page = await open('set');
  assert.ok((await drawnShare(page, ['mesh'])) > 0.2);
  await page.evaluate(() => {
    window.lost = document.getElementById('mesh').getContext('webgl2').getExtension('WEBGL_lose_context');
    window.lost.loseContext();
  });
  await says(page, 'waiting', 'waiting for WebGL');
  await ask('ADD set 0.5 0.5');
  await waitFor(page, () => window.app.mesh.points === 301);
  await page.evaluate(() => window.lost.restoreContext());
  await waitFor(page, () => !window.app.scene.isLost && window.app.scene.counts.whole > 1);
  const fresh = await open('set');
  const [again, expected] = [await drawnShare(page, ['mesh']), await drawnShare(fresh, ['mesh'])];
  assert.ok(Math.abs(again - expected) < 0.02 * expected && again > 0.2, `${again} and ${expected}`);
  await ask('DEL set 300');
  await waitFor(page, () => window.app.mesh.points === 300 && window.app.scene.counts.part > 0);
});

test('the page says what it waits for, as long as it does', async () => {
  const page = await open('set');
  signalGateway('SIGSTOP');
  await says(page, 'waiting', 'waiting for ');
  signalGateway('SIGCONT');
  await says(page, 'waiting', '');
});

test('a daemon that is not ready is asked again', async () => {
  let refused = 0;
  const server = await behindGateway((socket, pass) => {
    if (refused++ >= 2) pass();
    else socket.on('data', () => socket.write('ERR LOADING the server is still reading its data\n'));
  });
  const page = await visit('#set=set');
  await says(page, 'message', 'reading its data; trying again');
  await isWhole(page);
  server.close();
});

test('replies that break off while a set is loaded are asked for again', async () => {
  let connections = 0;
  const server = await behindGateway((socket, pass) => {
    if (connections++ === 1) socket.once('data', () => socket.end('OK 300 bytes=6000\n'));
    else pass();
  });
  const page = await visit('#set=set');
  await says(page, 'message', 'trying again');
  await isWhole(page);
  server.close();
});
