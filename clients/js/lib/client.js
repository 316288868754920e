// A client: a connection, which is made again after it has been lost.
'use strict';

const { chooseAddress } = require('./address.js');
const { Connection } = require('./connection.js');
const { Commands } = require('./commands.js');
const { Disconnected } = require('./errors.js');
const { line } = require('./framing.js');
const { box, checkSet, fieldList, milliseconds, only, option } = require('./values.js');

const CONNECT_MS = 10000;

/** Made by connect(). Requests may be made without waiting for one another. */
class Client extends Commands {
  #address;
  #options;
  #connection = null;
  #opening = null;
  #queued = []; // requests made while it connects
  #closed = false;
  #mirrors = new Set();

  constructor(address, { timeout = 0, connectTimeout = CONNECT_MS, unref = false, ...others } = {}) {
    super();
    only(others);
    this.#address = address;
    this.#options = { timeout: milliseconds(timeout), connectTimeout: milliseconds(connectTimeout), unref };
  }

  /** Rejects pending requests and all later ones, and ends the mirrors. */
  close() {
    const error = new Disconnected('closed', 'CLOSED');
    this.#closed = true;
    this.#connection?.fail(error);
    for (const request of this.#queued.splice(0)) request.reject(error);
    for (const mirror of this.#mirrors) mirror.close();
  }

  /** Connects if there is no connection; concurrent calls wait for the same one. */
  open() {
    this.#opening ??= this.#open().finally(() => {
      this.#opening = null;
    });
    return this.#opening;
  }

  /** A new connection that has shown its token. */
  async #connect(options) {
    const { connectTimeout, unref } = this.#options;
    const socket = await this.#address.open(connectTimeout);
    const connection = new Connection(socket, { unref, ...options });
    if (this.#closed) connection.fail(new Disconnected('closed', 'CLOSED'));
    await this.#introduce(connection, connectTimeout);
    return connection;
  }

  async #open() {
    try {
      const connection = await this.#connect();
      this.#connection = connection;
      for (const request of this.#queued.splice(0)) connection.send(request);
    } catch (error) {
      for (const request of this.#queued.splice(0)) request.reject(error);
      throw error;
    }
  }

  /** Sends the token. A connection that is not used is closed. */
  async #introduce(connection, timeout) {
    if (!this.#address.token) return;
    try {
      await new Promise((resolve, reject) => {
        connection.send({ line: `AUTH ${this.#address.token}`, timeout, resolve, reject });
      });
    } catch (error) {
      connection.fail(error);
      throw error;
    }
  }

  /** Sends a request, and bytes that belong to it; resolves with {keys, rows, data}. timeout: in ms, 0 for none. */
  async request(line, options = {}) {
    const { body, progress, timeout } = only(options, 'body', 'progress', 'timeout');
    const limit = milliseconds(timeout ?? this.#options.timeout);
    if (typeof line !== 'string' || /[\r\n]/.test(line)) throw new TypeError('a request is one line');
    if (progress !== undefined && typeof progress !== 'function') throw new TypeError('progress is a function');
    if (this.#closed) throw new Disconnected('closed', 'CLOSED');
    return new Promise((resolve, reject) => {
      const request = { line, body, progress, timeout: limit, resolve, reject };
      if (this.#opening === null && this.#connection !== null && !this.#connection.failed) {
        this.#connection.send(request);
        return;
      }
      this.#queued.push(request);
      this.open().catch(() => {}); // all that are queued are rejected
    });
  }

  /** The same for the words of a request, and for what is left of a method's options. */
  async _ask(words, options = {}, body = undefined) {
    return this.request(line(words), { ...only(options, 'progress', 'timeout'), body });
  }

  // ---- mirrors ----

  /** A copy of the set that follows it, over a connection of its own; resolves when it is whole. within is a box [x0, y0, x1, y1].
   * Points have the values of `fields`, names, after their coordinates. */
  async mirror(set, { within, fields = [], ...others } = {}) {
    only(others);
    const { Mirror } = await import('./mirror.mjs');
    const names = fieldList(fields);
    const rest = line(option('WITHIN', within, box), names.length > 0 ? ['FIELDS', names.join(',')] : [], 'CONSTRAINTS');
    const onEnd = () => this.#mirrors.delete(mirror);
    const mirror = new Mirror(checkSet(set), { open: (options) => this.#connect(options), rest, fields: names, onEnd });
    this.#mirrors.add(mirror);
    await mirror.start();
    await mirror.reached(0);
    return mirror;
  }
}

/** Connects; resolves with a Client. Without a URL: $DELAUNAY_URL, or else localhost:6374, or else a private daemon. */
async function connect(url, options) {
  const client = new Client(chooseAddress(url), options);
  await client.open();
  return client;
}

let common = null;

/** The default client. It does not keep the process alive. */
function commonClient() {
  common ??= new Client(chooseAddress(), { unref: true });
  return common;
}

/** Sets the server of the default client for later calls, as in connect(). */
function useServer(url, options) {
  const next = new Client(chooseAddress(url), { ...options, unref: true });
  common?.close();
  common = next;
}

module.exports = { Client, commonClient, connect, useServer };
