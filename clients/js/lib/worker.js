// The worker thread of sync.js: triangulates the points that it receives, one set after the other.
'use strict';

const { workerData } = require('node:worker_threads');

const { chooseAddress } = require('./address.js');
const { Client } = require('./client.js');
const { triangulate } = require('./triangulation.js');

const { port, signal, url, timeout } = workerData;
const client = new Client(chooseAddress(url), { timeout });

function answer(message, transfer = []) {
  port.postMessage(message, transfer);
  Atomics.store(signal, 0, 1);
  Atomics.notify(signal, 0);
}

function fail({ name, message, code }) {
  answer({ error: { name, message, code } });
}

process.on('uncaughtException', fail);

port.on('message', async (coords) => {
  try {
    const { triangles, hull } = await triangulate(client, coords, true);
    answer({ triangles, hull }, hull === null ? [triangles.buffer] : [triangles.buffer, hull.buffer]);
  } catch (error) {
    fail(error);
  }
});
