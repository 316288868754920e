// Sessions through redis (node-redis) and ioredis, each in its present version, which speaks RESP 3 by default, and in the one before:
// node.mjs PORT FOLDER_OF_NODE_MODULES

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';

const [port, folder] = process.argv.slice(2);
const peer = createRequire(path.join(folder, 'x.js'));

const square = Buffer.from(Float64Array.of(0, 0, 4, 0, 4, 4, 0, 4, 2, 2).buffer);

// Requests that both libraries can send; `ask` sends words.
async function converse(set, ask, typed) {
  await ask('LOADB', set, '5', square);
  const counts = await ask('TRIANGULATE', set);
  if (typed) assert.equal(counts.triangles, 4);
  else assert.match(counts, /^OK points=5 /);
  const lists = await ask('LISTS', set);
  assert.deepEqual(lists[0], typed ? [4, 0, 1, 2, 3] : '4 0 1 2 3');
  const near = await ask('NEAREST', set, '3', '2', '1');
  assert.deepEqual(near, typed ? [[4, 2, 2, 1]] : ['4 2 2 1']);
  assert.deepEqual(await ask('WITHIN', set, '9', '9', '10', '10'), typed ? [] : 'OK');
  await assert.rejects(ask('GET', set, '99'), /NOPOINT/);
  assert.deepEqual(await Promise.all(Array.from({ length: 500 }, () => ask('EXISTS', set))), Array(500).fill(1));
}

// Calls that users of the libraries expect to work, and the errors' texts.
async function behave(client, set, names) {
  assert.equal(await client.expire(set, 1000), 1);
  assert.equal(await client.expire(set, 5, 'NX'), 0);
  assert.ok((await client.ttl(set)) > 900);
  assert.equal(await client.wait(0, 10), 0);
  assert.equal((await client.time()).length, 2);
  assert.match(await client.info(), /^# Server\r\nredis_version:/);
  assert.ok((await client.keys('*')).includes(set));
  assert.equal(await client.type(set), 'pointset');
  await assert.rejects(client.set('a', 'b'), /unknown command '(SET|set)', with args beginning with: 'a' 'b'/);
  await assert.rejects(client.del(set), /DROP set deletes sets/);
  assert.equal(await client[names.unlink]([set, 'none']), 1);
  assert.equal(await client.exists('tx'), 0);
}

// redis: version, and what it speaks; undefined: what it speaks by itself.
for (const [name, RESP, typed] of [['redis', undefined, true], ['redis', 2, false], ['redis5', undefined, false], ['redis5', 3, true]]) {
  const client = peer(name).createClient({ url: `redis://:any@127.0.0.1:${port}`, name: 'interop', RESP, maintNotifications: 'disabled' });
  const set = `${name}${RESP ?? ''}`;
  const ask = (...words) => client.sendCommand(words);
  await client.connect();
  assert.equal(await client.ping(), 'PONG');
  await converse(set, ask, typed);
  const stat = await ask('STAT', set);
  if (typed) assert.deepEqual([stat.triangulated, stat.tol, typeof stat.version], [true, 0, 'number']); // a boolean, a double, a map
  await ask('FSET', set, 'z', '0', '1.5');
  assert.deepEqual(await ask('FGET', set, 'z', '0', '1'), typed ? [[0, 1.5], [1, null]] : ['0 1.5', '1 nan']);
  if (typed) {
    assert.equal(typeof (await client.watch(set)).version, 'number'); // it follows the set
    await ask('ADD', set, '9', '9'); // its event is a push, which no reply is mistaken for
    assert.equal(await client.ping(), 'PONG');
    await ask('UNWATCH', set);
  } else {
    await assert.rejects(client.watch(set), /no transactions/);
    assert.equal(await client.unwatch(), 'OK');
  }
  const found = [];
  for await (const some of client.scanIterator({ MATCH: 'redis*', COUNT: 1 })) found.push(...[].concat(some));
  assert.ok(found.includes(set));
  await assert.rejects(client.multi().addCommand(['ADD', 'tx', '1', '2']).exec(), /no transactions/);
  assert.equal((await client.clientInfo()).name, 'interop');
  assert.equal((await client.role()).role, 'master');
  assert.ok('max-points' in await client.configGet('max-*'));
  await behave(client, set, { unlink: 'unlink' });
  await client.close();
}

// ioredis 6 speaks RESP 3, but shows maps as flat arrays and doubles as strings.
for (const name of ['ioredis', 'ioredis5']) {
  const io = new (peer(name).Redis)({ port: Number(port), host: '127.0.0.1', password: 'any', connectionName: 'interop', maxRetriesPerRequest: 1 });
  const ask = (...words) => io.call(...words);
  const flat = name === 'ioredis';
  assert.equal(await io.ping(), 'PONG');
  await ask('LOADB', name, '5', square);
  const counts = await ask('TRIANGULATE', name);
  assert.deepEqual(flat ? counts.slice(0, 2) : counts.slice(0, 11), flat ? ['points', 5] : 'OK points=5');
  assert.deepEqual(await ask('NEAREST', name, '3', '2', '1'), flat ? [[4, '2', '2', '1']] : ['4 2 2 1']);
  assert.deepEqual((await ask('LISTS', name))[0], flat ? [4, 0, 1, 2, 3] : '4 0 1 2 3');
  await assert.rejects(ask('GET', name, '99'), /NOPOINT/);
  assert.equal(await io.dbsize(), (await io.keys('*')).length);
  assert.deepEqual(await io.pipeline().exists(name).ttl(name).exec(), [[null, 1], [null, -1]]);
  if (flat) {
    assert.equal((await io.watch(name))[0], 'version');
    await ask('ADD', name, '9', '9');
    assert.equal(await io.ping(), 'PONG');
    await ask('UNWATCH', name);
  } else {
    await assert.rejects(io.watch(name), /no transactions/);
  }
  await assert.rejects(io.multi().call('ADD', 'tx', '1', '2').exec(), /no transactions/);
  await io.multi({ pipeline: false });
  assert.equal(await io.call('ADD', 'tx', '1', '2'), 'QUEUED');
  await assert.rejects(io.exec(), /EXECABORT/);
  assert.equal((await io.role())[0], 'master');
  await behave(io, name, { unlink: 'unlink' });
  io.disconnect();
}
