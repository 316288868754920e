// Conversations of the page with the daemon, without a browser: a WebSocket that does what the test says.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';

class Socket {
  static OPEN = 1;
  readyState = 0;
  sent = [];

  constructor() {
    Socket.last = this;
  }

  send(line) {
    this.sent.push(line);
  }

  open() {
    this.readyState = Socket.OPEN;
    this.onopen();
  }

  say(text) {
    this.onmessage({ data: new TextEncoder().encode(text).buffer });
  }

  close() {
    this.readyState = 3;
    this.onclose();
  }
}

globalThis.WebSocket = Socket;
const { Connection, countWaits } = await import('../page/data/connection.js');
const lost = { code: 'LOST' };
let connection, ends;

beforeEach(() => {
  ends = 0;
  connection = new Connection('ws://page/daemon', { onEvent: () => {}, onEnd: () => ends++ });
  connection.opened.catch(() => {});
});

test('a request before the connection is open is lost, and takes no reply of another one', async () => {
  await assert.rejects(connection.request('STAT a'), lost);
  Socket.last.open();
  await connection.opened;
  const reply = connection.request('STAT b');
  Socket.last.say('OK 0 points=7\n');
  assert.deepEqual([(await reply).keys, Socket.last.sent], [{ points: '7' }, ['STAT b\n']]);
  connection.close();
});

test('a connection that is lost before it is open says so', async () => {
  Socket.last.close();
  await assert.rejects(connection.opened, lost);
  assert.equal(ends, 1);
});

test('a line with an error before any request, from a daemon that takes no more clients', async () => {
  Socket.last.open();
  Socket.last.say('ERR BUSY too many clients\n');
  Socket.last.close();
  assert.equal(ends, 1);
});

test('what is waited for has a name, and a connection without a byte for a minute ends', async () => {
  Socket.last.open();
  const [slow, next] = [connection.request('STAT slow'), connection.request('SETS')];
  slow.catch(() => {});
  for (let k = 1; k <= 50; k++) assert.deepEqual([countWaits().what, ends], ['STAT slow', 0]);
  Socket.last.say('OK 0 points=1\n');
  await slow;
  for (let k = 1; k < 60; k++) assert.equal(countWaits().what, 'SETS');
  assert.equal(ends, 0);
  countWaits();
  await assert.rejects(next, lost);
  assert.deepEqual([ends, countWaits()], [1, null]);
});

test('a connection in which nothing is waited for may be silent', async () => {
  Socket.last.open();
  await connection.opened;
  for (let k = 0; k < 200; k++) assert.equal(countWaits(), null);
  assert.equal(ends, 0);
  connection.close();
});
