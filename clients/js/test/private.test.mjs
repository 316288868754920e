// The private daemon: it starts when it is needed, and ends with its owner.

import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync } from 'node:fs';
import net from 'node:net';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { connect } from '../index.mjs';

const index = fileURLToPath(new URL('../index.js', import.meta.url));

/** A process of Node that runs the script. */
function node(script, env = {}) {
  const child = spawn(process.execPath, ['-e', `const d = require(${JSON.stringify(index)});${script}`], {
    stdio: ['ignore', 'pipe', 'inherit'],
    env: { ...process.env, ...env },
  });
  return child;
}

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until the process has ended. */
async function gone(pid) {
  for (let i = 0; i < 2000 && existsSync(`/proc/${pid}/stat`); i++) await sleep(20);
  return !existsSync(`/proc/${pid}/stat`);
}

test('clients of one process share a private daemon', async () => {
  const [a, b] = await Promise.all([connect('private:'), connect('private:')]);
  await a.add('t', 1, 2);
  assert.deepEqual(await b.sets(), ['t']);
  a.close();
  b.close();
});

const talks = `d.connect('private:').then(async (c) => console.log((await c.info()).pid));`;

test('a private daemon ends with its owner, however the owner ends', async () => {
  for (const end of ['SIGKILL', 'SIGTERM', 'SIGINT', 'SIGHUP']) {
    const owner = node(talks);
    const [pid] = await once(owner.stdout, 'data');
    assert.ok(existsSync(`/proc/${Number(pid)}/stat`));
    owner.kill(end);
    await once(owner, 'exit');
    assert.ok(await gone(Number(pid)), `${end}: daemon ${pid} is still there`);
  }
});

test('a process ends when it has closed its clients, and one without a client at once', async () => {
  for (const script of [
    `d.connect('private:').then(async (c) => { await c.add('t', 1, 2); c.close(); });`,
    `new d.Delaunator([0, 0, 1, 0, 0, 1]); new d.LiveSet();`,
    `d.useServer('private:'); d.Triangulation.from([0, 0, 1, 0, 0, 1]);`,
  ]) {
    const [status] = await once(node(script, { DELAUNAY_URL: 'private:' }), 'exit');
    assert.equal(status, 0, script);
  }
});

test('a program that is missing is named', async () => {
  const child = node(`d.connect('private:').catch((e) => console.log(e.code, e.message));`, { DELAUNAYD: '/nowhere/delaunayd' });
  const [said] = await once(child.stdout, 'data');
  assert.match(said.toString(), /^NODAEMON cannot start \/nowhere\/delaunayd: not found/);
});

test('without a URL it is the daemon at the default address, or else a private one', async (t) => {
  const server = net.createServer((peer) => {
    peer.on('error', () => {});
    peer.on('data', () => peer.write('OK 1\npid:0\n'));
  });
  server.listen(6374, 'localhost');
  try {
    await once(server, 'listening');
  } catch {
    t.skip('port 6374 is in use');
    return;
  }
  const script = `d.connect().then(async (c) => { console.log((await c.info()).pid); c.close(); });`;
  const pid = async () => Number((await once(node(script, { DELAUNAY_URL: '' }).stdout, 'data'))[0]);
  assert.equal(await pid(), 0);
  server.close();
  await once(server, 'close');
  assert.ok((await pid()) > 0);
});
