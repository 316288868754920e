// One connection: requests in lines, replies in the order of requests, events between them. A failed connection is not reused.
'use strict';

const { Disconnected, Refused } = require('./errors.js');
const { Input, parseEvent, parseStatus } = require('./framing.js');

const GRACE_MS = 1000; // the server knows a request's time limit; it should have replied this much later

class Connection {
  #socket;
  #input = new Input();
  #waiting = []; // requests without a reply, oldest first
  #reply = null; // the one that is being read, or an event
  #event = null; // the one that has just been read
  #failure = null;
  #timer = null; // of the oldest request
  #idles; // whether the process may end while no request is waiting
  #onEvent;
  #onFail;

  /** onEvent({set, version, reset, more, dropped, rows}), if there may be events; onFail(error), once. */
  constructor(socket, { unref = false, keepAlive = 0, onEvent = null, onFail = null } = {}) {
    this.#socket = socket;
    this.#idles = unref;
    this.#onEvent = onEvent;
    this.#onFail = onFail;
    if (unref) socket.unref();
    if (keepAlive > 0) socket.setKeepAlive(true, keepAlive);
    socket.on('data', (piece) => {
      this.#input.push(piece);
      this.#read();
    });
    socket.on('error', (error) => this.fail(new Disconnected(`the connection was lost: ${error.message}`, error.code, error)));
    socket.on('close', () => this.fail(new Disconnected('the connection was lost')));
  }

  get failed() {
    return this.#failure !== null;
  }

  fail(error) {
    if (this.#failure) return;
    this.#failure = error;
    clearTimeout(this.#timer);
    this.#socket.destroy();
    for (const request of this.#waiting.splice(0)) request.reject(error);
    this.#onFail?.(error);
  }

  /** request: {line, body, progress, timeout, resolve, reject}. */
  send(request) {
    if (this.#failure) {
      request.reject(this.#failure);
      return;
    }
    this.#waiting.push(request);
    if (this.#waiting.length === 1) this.#begin();
    const limited = request.timeout > 0 ? `TIMEOUT ${request.timeout / 1000} ${request.line}` : request.line;
    this.#socket.write(`${limited}\n`);
    if (request.body?.length > 0) this.#socket.write(request.body);
  }

  /** Called when the oldest request has changed. */
  #begin() {
    clearTimeout(this.#timer);
    const { timeout } = this.#waiting[0] ?? {};
    if (this.#idles) this.#waiting.length > 0 ? this.#socket.ref() : this.#socket.unref();
    if (timeout > 0) this.#watch(timeout);
  }

  /** Fails the connection if the server has neither replied nor moved bytes for longer than the limit. */
  #watch(timeout) {
    const moved = this.#socket.bytesRead + this.#socket.bytesWritten;
    this.#timer = setTimeout(() => {
      if (this.#socket.bytesRead + this.#socket.bytesWritten !== moved) this.#watch(timeout);
      else this.fail(new Disconnected(`no reply within ${timeout} ms`, 'TIMEOUT'));
    }, timeout + GRACE_MS);
  }

  #read() {
    while (this.#failure === null && (this.#waiting.length > 0 || this.#onEvent !== null) && this.#readPart());
  }

  #readPart() {
    this.#event = null;
    try {
      if (!this.#step()) return false;
    } catch (error) {
      this.fail(error);
      return false;
    }
    if (this.#event !== null) this.#onEvent(this.#event); // its errors are those of the program
    return true;
  }

  /** Reads one part of a reply or event; false if it has not arrived. */
  #step() {
    const reply = this.#reply;
    if (reply?.size !== undefined) {
      if ((reply.data = this.#input.take(reply.size)) === null) return false;
      return this.#settle();
    }
    const line = this.#input.line();
    if (line === null) return false;
    if (reply) {
      reply.rows.push(line);
      return reply.rows.length < reply.expected || this.#settle();
    }
    if (line.startsWith('EVENT ') && this.#onEvent !== null) {
      this.#reply = parseEvent(line);
      return this.#reply.expected > 0 || this.#settle();
    }
    if (this.#waiting.length === 0) throw new Error(`a reply without a request: ${line.slice(0, 80)}`);
    if (line.startsWith('#')) {
      this.#waiting[0].progress?.(line.slice(1).trim());
    } else if (line.startsWith('ERR ')) {
      this.#next().reject(new Refused(line));
    } else {
      this.#reply = parseStatus(line);
      if (this.#reply.expected === 0) {
        if (this.#reply.keys.bytes === undefined) return this.#settle();
        this.#reply.size = Number(this.#reply.keys.bytes);
      }
    }
    return true;
  }

  #settle() {
    const { keys, rows, data, event } = this.#reply;
    this.#reply = null;
    if (event !== undefined) {
      this.#event = { ...event, rows };
      return true;
    }
    this.#next().resolve({ keys, rows, data });
    return true;
  }

  #next() {
    const done = this.#waiting.shift();
    this.#begin();
    return done;
  }
}

module.exports = { Connection };
