// Triangulates synchronously: Delaunator and d3-delaunay have no promises. A worker thread communicates with the daemon, and
// the caller's thread sleeps until it has the result.
'use strict';

const path = require('node:path');
const { MessageChannel, Worker, receiveMessageOnPort } = require('node:worker_threads');

const errors = require('./errors.js');

let chosen = {};
let worker = null; // {port, signal, thread}

function start() {
  const { port1, port2 } = new MessageChannel();
  const signal = new Int32Array(new SharedArrayBuffer(4));
  const url = chosen.url ?? (process.env.DELAUNAY_URL || undefined);
  const thread = new Worker(path.join(__dirname, 'worker.js'), {
    workerData: { port: port2, signal, url, timeout: chosen.timeout },
    transferList: [port2],
    execArgv: [],
  });
  thread.unref(); // it does not keep the process alive
  port1.unref();
  return { port: port1, signal, thread };
}

/** Sets the server of Delaunator and Delaunay for later calls, as in connect(). */
function useServer(url, { timeout = 0 } = {}) {
  worker?.thread.terminate();
  worker = null;
  chosen = { url, timeout };
}

/** {triangles, hull} of x, y one after the other, as triangulate() gives them, clockwise. */
function triangulateSync(coords) {
  worker ??= start();
  const { port, signal } = worker;
  const sent = Float64Array.from(coords); // a copy, which moves to the other thread
  Atomics.store(signal, 0, 0);
  port.postMessage(sent, [sent.buffer]);
  Atomics.wait(signal, 0, 0);
  const { error, triangles, hull } = receiveMessageOnPort(port).message;
  if (error) throw revive(error);
  return { triangles, hull };
}

function revive({ name, message, code }) {
  const error = name === 'Refused' ? new errors.Refused(message) : new Error(message);
  if (name === 'Disconnected') return new errors.Disconnected(message, code);
  return Object.assign(error, { name, code });
}

module.exports = { triangulateSync, useServer };
