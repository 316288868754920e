// Replies and events of bytes that arrive in any pieces.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import conversations from '../lib/conversation.js';

const { Conversation } = conversations;

const BYTES = Buffer.from(
  'OK 0 points=2\r\nEVENT 2 set=t version=7 more\npoint 0 1 2\ngone 1\n# half of it\nOK 2\n0 Gdańsk\n1 \nOK 0 bytes=3\n\n\0xERR NOSET there is no set u\nOK 0 bytes=0\n',
);

/** Returns the events and replies in BYTES, which arrive in pieces of n bytes. */
async function heard(n) {
  const said = [];
  const onEvent = (event) => said.push(event);
  const conversation = new Conversation({ refused: (line) => new Error(line), onEvent, onFail: (error) => said.push(`failed: ${error.message}`) });
  const replies = Array.from(
    { length: 5 },
    () => new Promise((resolve, reject) => conversation.expect({ resolve, reject, progress: (text) => said.push(text) })),
  );
  for (let at = 0; at < BYTES.length; at += n) conversation.push(BYTES.subarray(at, at + n));
  const settled = await Promise.allSettled(replies);
  return { said, settled: settled.map(({ value, reason }) => reason?.message ?? { ...value, data: value.data && [...value.data] }) };
}

test('bytes that come one by one, or all at once, are the same replies and events', async () => {
  const expected = {
    said: [{ set: 't', version: 7, reset: false, more: true, dropped: false, rows: ['point 0 1 2', 'gone 1'] }, 'half of it'],
    settled: [
      { keys: { points: '2' }, rows: [], data: null },
      { keys: {}, rows: ['0 Gdańsk', '1 '], data: null },
      { keys: { bytes: '3' }, rows: [], data: [10, 0, 120] },
      'ERR NOSET there is no set u',
      { keys: { bytes: '0' }, rows: [], data: [] },
    ],
  };
  for (let n = 1; n <= BYTES.length; n++) assert.deepEqual(await heard(n), expected, `${n} bytes at once`);
});

test('binary replies have memory of their own; one that is too large, or of no request, ends the conversation', async () => {
  const failures = [];
  const conversation = () => new Conversation({ refused: (line) => new Error(line), onEvent: () => {}, onFail: ({ message }) => failures.push(message) });
  const one = conversation();
  const reply = new Promise((resolve, reject) => one.expect({ resolve, reject, most: 4 }));
  one.push(Buffer.from('OK 0 bytes=4\nabcd'));
  assert.equal((await reply).data.buffer.byteLength, 4);
  const large = new Promise((resolve, reject) => one.expect({ resolve, reject, most: 4 }));
  one.push(Buffer.from('OK 0 bytes=5\n'));
  await assert.rejects(large, { code: 'LARGE' });
  await assert.rejects(new Promise((resolve, reject) => assert.equal(one.expect({ resolve, reject }), false)), { code: 'LARGE' });
  conversation().push(Buffer.from('OK 0\n'));
  assert.deepEqual(failures, ['a reply of 5 bytes', 'a reply without a request: OK 0']);
});
