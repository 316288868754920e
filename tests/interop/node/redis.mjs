// Sessions through redis (node-redis) and ioredis, in RESP 2 and 3:  node redis.mjs PORT FOLDER_OF_NODE_MODULES

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';

const [port, folder] = process.argv.slice(2);
const peer = createRequire(path.join(folder, 'x.js'));
const { createClient } = peer('redis');
const { Redis } = peer('ioredis');

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

for (const RESP of [2, 3]) {
  const client = createClient({ url: `redis://127.0.0.1:${port}`, RESP });
  await client.connect();
  assert.equal(await client.ping(), 'PONG');
  await converse(`node${RESP}`, (...words) => client.sendCommand(words), RESP === 3);
  assert.equal(await client.exists(`node${RESP}`), 1);
  assert.equal(await client.expire(`node${RESP}`, 1000), 1);
  assert.ok((await client.ttl(`node${RESP}`)) > 900);
  assert.ok((await client.keys('node*')).includes(`node${RESP}`));
  const names = [];
  for await (const some of client.scanIterator({ MATCH: 'node*', COUNT: 1 })) names.push(...[].concat(some));
  assert.ok(names.includes(`node${RESP}`));
  assert.equal(await client.type(`node${RESP}`), 'pointset');
  await assert.rejects(client.multi().addCommand(['ADD', 'tx', '1', '2']).exec(), /transaction/);
  assert.equal(await client.exists('tx'), 0);
  await client.close();
}

const io = new Redis(Number(port), '127.0.0.1', { maxRetriesPerRequest: 1 });
assert.equal(await io.ping(), 'PONG');
await converse('io', (...words) => io.call(...words), false);
assert.equal(await io.dbsize(), (await io.keys('*')).length);
const results = await io.pipeline().exists('io').ttl('io').exec();
assert.deepEqual(results, [[null, 1], [null, -1]]);
await assert.rejects(io.multi().call('ADD', 'tx', '1', '2').exec(), /transaction/);
assert.equal(await io.exists('tx'), 0);
io.disconnect();
