// A conversation over a socket. A failed connection is not reused.
'use strict';

const { Conversation } = require('./conversation.js');
const { Disconnected, Refused } = require('./errors.js');

const GRACE_MS = 1000; // the server knows a request's time limit; it should have replied this much later

class Connection {
  #socket;
  #conversation;
  #timer = null; // of the oldest request
  #idles; // whether the process may end while no request is waiting

  /** onEvent({set, version, reset, more, dropped, rows}), if there may be events; onFail(error), once. */
  constructor(socket, { unref = false, keepAlive = 0, onEvent = null, onFail = () => {} } = {}) {
    this.#socket = socket;
    this.#idles = unref;
    this.#conversation = new Conversation({
      refused: (line) => new Refused(line),
      allocate: Buffer.allocUnsafeSlow,
      onEvent,
      onOldest: () => this.#begin(),
      onFail: (error) => {
        clearTimeout(this.#timer);
        socket.destroy();
        onFail(error);
      },
    });
    if (unref) socket.unref();
    if (keepAlive > 0) socket.setKeepAlive(true, keepAlive);
    socket.on('data', (piece) => this.#conversation.push(piece));
    socket.on('error', (error) => this.fail(new Disconnected(`the connection was lost: ${error.message}`, error.code, error)));
    socket.on('close', () => this.fail(new Disconnected('the connection was lost')));
  }

  get failed() {
    return this.#conversation.failed;
  }

  fail(error) {
    this.#conversation.fail(error);
  }

  /** request: {line, body, progress, timeout, resolve, reject}. */
  send(request) {
    if (!this.#conversation.expect(request)) return;
    const limited = request.timeout > 0 ? `TIMEOUT ${request.timeout / 1000} ${request.line}` : request.line;
    this.#socket.write(`${limited}\n`);
    if (request.body?.length > 0) this.#socket.write(request.body);
  }

  /** Called when the oldest request has changed. */
  #begin() {
    const { oldest } = this.#conversation;
    clearTimeout(this.#timer);
    if (this.#idles) oldest === undefined ? this.#socket.unref() : this.#socket.ref();
    if (oldest?.timeout > 0) this.#watch(oldest.timeout);
  }

  /** Fails the connection if the server has neither replied nor moved bytes for longer than the limit. */
  #watch(timeout) {
    const moved = this.#socket.bytesRead + this.#socket.bytesWritten;
    this.#timer = setTimeout(() => {
      if (this.#socket.bytesRead + this.#socket.bytesWritten !== moved) this.#watch(timeout);
      else this.fail(new Disconnected(`no reply within ${timeout} ms`, 'TIMEOUT'));
    }, timeout + GRACE_MS);
  }
}

module.exports = { Connection };
