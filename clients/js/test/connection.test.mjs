// Connections that are lost, time limits, tokens, Unix sockets.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { connect, Disconnected } from '../index.mjs';
import address from '../lib/address.js';
import { startDaemon } from './daemon.mjs';

const directory = () => mkdtempSync(path.join(tmpdir(), 'delaunay_js_'));

test('a client connects again after its daemon has been replaced', async () => {
  const first = await startDaemon();
  const client = await connect(first.url);
  await client.add('t', 0, 0);
  await first.end('SIGKILL');
  const refused = await client.add('t', 1, 1).catch((e) => e);
  assert.ok(refused instanceof Disconnected);
  await assert.rejects(client.sets(), { code: 'ECONNREFUSED' });
  const second = await startDaemon('--port', first.port);
  assert.deepEqual(await Promise.all([client.sets(), client.add('u', 1, 1), client.sets()]), [[], 0, ['u']]);
  client.close();
  await assert.rejects(client.sets(), { code: 'CLOSED' });
  assert.equal(await second.end(), 0);
});

test('what is under way when a connection is lost is not sent again', async () => {
  let connections = 0;
  const requests = [];
  const server = net.createServer((peer) => {
    const mine = ++connections;
    peer.on('error', () => {});
    peer.on('data', (bytes) => {
      requests.push(`${mine}:${bytes.toString().trim()}`);
      if (mine === 1) peer.destroy();
      else peer.write('OK 0\n');
    });
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  const client = await connect(`delaunay://127.0.0.1:${server.address().port}`);
  await assert.rejects(client.request('ADD t 0 0'), Disconnected);
  await client.request('PING');
  assert.deepEqual(requests, ['1:ADD t 0 0', '2:PING']);
  client.close();
  server.close();
});

test('a time limit ends a slow request and leaves the connection', async () => {
  const daemon = await startDaemon();
  const client = await connect(daemon.url, { timeout: 60000 });
  await client.load('t', Float64Array.from({ length: 1000000 }, Math.random));
  await assert.rejects(client.triangulate('t', { timeout: 1 }), { name: 'Refused', code: 'TIMEOUT' });
  assert.deepEqual(await client.sets(), ['t']);
  client.close();
  await daemon.end();
});

test('a time limit ends a request to a server that is silent', async () => {
  const daemon = await startDaemon();
  const client = await connect(daemon.url);
  daemon.child.kill('SIGSTOP');
  const both = await Promise.allSettled([client.request('PING', { timeout: 10 }), client.request('PING')]);
  assert.deepEqual(both.map((r) => r.reason.code), ['TIMEOUT', 'TIMEOUT']);
  daemon.child.kill('SIGCONT');
  assert.equal((await client.request('PING')).rows.length, 0);
  client.close();
  await daemon.end();
});

test('no set is left behind by a client that is killed', async () => {
  const daemon = await startDaemon();
  const script = `const d = require(${JSON.stringify(fileURLToPath(new URL('../index.js', import.meta.url)))});
    d.connect().then(async (c) => { await c.create('t', 0, { temporary: true }); console.log('made'); });`;
  const killed = spawn(process.execPath, ['-e', script], { stdio: ['ignore', 'pipe', 'inherit'], env: { ...process.env, DELAUNAY_URL: daemon.url } });
  await once(killed.stdout, 'data');
  const client = await connect(daemon.url);
  assert.deepEqual(await client.sets(), ['t']);
  killed.kill('SIGKILL');
  await once(killed, 'exit');
  for (let i = 0; i < 4000 && (await client.sets()).length > 0; i++) await new Promise((resolve) => setTimeout(resolve, 10));
  assert.deepEqual(await client.sets(), []);
  client.close();
  await daemon.end();
});

test('connecting has a time limit', async () => {
  const server = net.createServer().listen(0, '127.0.0.1'); // it never replies to the token
  await once(server, 'listening');
  const url = `delaunay://:secret@127.0.0.1:${server.address().port}`;
  await assert.rejects(connect(url, { connectTimeout: 10 }), { code: 'TIMEOUT' });
  server.close();
});

test('URLs are read as in all clients', async () => {
  const rows = readFileSync(new URL('../../../tests/data/urls.txt', import.meta.url), 'utf8').split('\n');
  const urls = rows.filter((row) => row && row[0] !== '#').map((row) => row.split(' '));
  assert.ok(urls.length > 30);
  for (const [url, host, ...others] of urls) {
    if (host === 'malformed') {
      assert.throws(() => address.parseUrl(url), TypeError, url);
    } else if (host !== 'private') {
      const [port, token] = others.map((word) => word.replace('-', ''));
      assert.deepEqual(address.parseUrl(url), { where: port ? { host, port: Number(port) } : { path: host }, token }, url);
    }
  }
});

test('a port that no address has is named', () => {
  assert.throws(() => address.parseUrl('delaunay://h:65536'), { name: 'TypeError', message: 'delaunay://h:65536: a port is at most 65535' });
});

test('a token that is no text is refused', () => {
  for (const url of ['delaunay://:%FF@h', 'unix://:a%C3@/s']) assert.throws(() => address.parseUrl(url), { name: 'TypeError', message: /token of the URL is not text/ });
});

test('tokens are shown on TCP and Unix sockets, again after a reconnection', async () => {
  const dir = directory();
  writeFileSync(path.join(dir, 'tokens'), 'rw a/b@c\n');
  const socket = path.join(dir, 'socket');
  const flags = ['--auth-file', path.join(dir, 'tokens'), '--unix', socket];
  const daemon = await startDaemon(...flags);
  const token = encodeURIComponent('a/b@c');
  const clients = [];
  for (const url of [daemon.url.replace('//', `//:${token}@`), `unix://:${token}@${socket}`]) {
    const client = await connect(url);
    assert.deepEqual(await client.sets(), []);
    clients.push(client);
  }
  const stranger = await connect(socket);
  await assert.rejects(stranger.sets(), { code: 'NOAUTH' });
  await assert.rejects(connect(`unix://:wrong@${socket}`), { code: 'DENIED' });
  await daemon.end('SIGKILL');
  await Promise.allSettled(clients.map((c) => c.sets()));
  const again = await startDaemon(...flags, '--port', daemon.port);
  for (const client of clients) assert.deepEqual(await client.sets(), []);
  for (const client of [...clients, stranger]) client.close();
  await again.end();
  rmSync(dir, { recursive: true });
});
