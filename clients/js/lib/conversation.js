// A conversation with the daemon over any stream of bytes: replies in the order of their requests, events between them (PROTOCOL.md,
// sections 2 and 7). For connection.js, and for the page in clients/web: a browser has no `module`, and finds the class as a global name.
'use strict';

const LF = 10;
const utf8 = new TextDecoder('utf-8', { ignoreBOM: true });

/** Bytes that arrive in pieces and are read as lines or blocks. */
class Input {
  #pieces = [];
  #length = 0;
  #scanned = 0; // pieces without LF

  push(piece) {
    this.#pieces.push(piece);
    this.#length += piece.length;
  }

  /** The next n bytes, in memory of their own, which allocate(n) returns; null if they have not all arrived. */
  take(n, allocate = (size) => new Uint8Array(size)) {
    if (this.#length < n) return null;
    const taken = allocate(n);
    let [filled, used] = [0, 0];
    while (filled < n) {
      const piece = this.#pieces[used];
      const part = piece.subarray(0, n - filled);
      taken.set(part, filled);
      filled += part.length;
      if (part.length === piece.length) used++;
      else this.#pieces[used] = piece.subarray(part.length);
    }
    this.#pieces.splice(0, used);
    this.#length -= n;
    this.#scanned = 0;
    return taken;
  }

  /** The next line without its end; null if it has not all arrived. */
  line() {
    for (; this.#scanned < this.#pieces.length; this.#scanned++) {
      const at = this.#pieces[this.#scanned].indexOf(LF);
      if (at < 0) continue;
      const before = this.#pieces.slice(0, this.#scanned).reduce((sum, piece) => sum + piece.length, 0);
      const text = utf8.decode(this.take(before + at + 1));
      return text.slice(0, text.endsWith('\r\n') ? -2 : -1);
    }
    return null;
  }
}

/** The number and the words after OK or EVENT. */
function parseLine(line, kind) {
  const [first, count, ...words] = line.split(' ');
  if (first !== kind || !/^\d+$/.test(count)) throw new Error(`not a reply of this protocol: ${line.slice(0, 80)}`);
  const keys = {};
  for (const word of words) {
    const at = word.indexOf('=');
    if (at > 0) keys[word.slice(0, at)] = word.slice(at + 1);
  }
  return { keys, words, expected: Number(count) };
}

/** {keys, rows, data} of the status line, with `expected` rows or `size` bytes to come. */
function parseStatus(line) {
  const { keys, expected } = parseLine(line, 'OK');
  const size = expected === 0 && keys.bytes !== undefined ? Number(keys.bytes) : undefined;
  return { keys, rows: [], data: null, expected, size };
}

/** {event: {set, version, reset, more, dropped}, rows}, with `expected` rows to come. */
function parseEvent(line) {
  const { keys, words, expected } = parseLine(line, 'EVENT');
  const event = { set: keys.set, version: Number(keys.version) };
  for (const word of ['reset', 'more', 'dropped']) event[word] = words.includes(word);
  return { event, rows: [], expected };
}

class Conversation {
  #input = new Input();
  #waiting = []; // requests without a reply, oldest first
  #reply = null; // the one that is being read, or an event
  #event = null; // the one that has just been read
  #failure = null;
  #calls;

  /** refused(line) returns the error of a line ERR. allocate(n) returns memory for a binary reply.
   *
   * If there may be events, onEvent gets each, {set, version, reset, more, dropped, rows}. onOldest() is called when the oldest request is
   * another one, or there is none. onFail(error) is called once. */
  constructor({ refused, allocate, onEvent = null, onOldest = () => {}, onFail = () => {} }) {
    this.#calls = { refused, allocate, onEvent, onOldest, onFail };
  }

  get failed() {
    return this.#failure !== null;
  }

  /** The request whose reply comes next, or undefined. */
  get oldest() {
    return this.#waiting[0];
  }

  /** No more replies come. */
  fail(error) {
    if (this.#failure) return;
    this.#failure = error;
    for (const { reject } of this.#waiting.splice(0)) reject(error);
    this.#calls.onFail(error);
  }

  /** The reply to a request {resolve, reject, progress, most} is to come behind those to earlier ones. progress(text), if it is there, is
   * called with reports. A reply of more than `most` bytes, if that is there, fails the conversation with the code LARGE. False if the
   * conversation has failed: the request is rejected and must not be sent. */
  expect(request) {
    if (this.#failure) {
      request.reject(this.#failure);
      return false;
    }
    this.#waiting.push(request);
    if (this.#waiting.length === 1) this.#calls.onOldest();
    return true;
  }

  /** The reply to the oldest request is nothing: it waited for something else than bytes. */
  pass() {
    this.#next().resolve(null);
  }

  /** The next bytes have arrived. */
  push(piece) {
    this.#input.push(piece);
    while (this.#failure === null && (this.#waiting.length > 0 || this.#calls.onEvent !== null) && this.#readPart());
  }

  #readPart() {
    this.#event = null;
    try {
      if (!this.#step()) return false;
    } catch (error) {
      this.fail(error);
      return false;
    }
    if (this.#event !== null) this.#calls.onEvent(this.#event); // its errors are those of the program
    return true;
  }

  /** Reads one part of a reply or event; false if it has not arrived. */
  #step() {
    const reply = this.#reply;
    if (reply?.size !== undefined) {
      reply.data = this.#input.take(reply.size, this.#calls.allocate);
      return reply.data !== null && this.#settle();
    }
    const line = this.#input.line();
    if (line === null) return false;
    if (reply !== null) {
      reply.rows.push(line);
      return reply.rows.length < reply.expected || this.#settle();
    }
    if (line.startsWith('EVENT ') && this.#calls.onEvent !== null) {
      this.#reply = parseEvent(line);
      return this.#reply.expected > 0 || this.#settle();
    }
    if (this.oldest === undefined) throw new Error(`a reply without a request: ${line.slice(0, 80)}`);
    if (line.startsWith('#')) this.oldest.progress?.(line.slice(1).trim());
    else if (line.startsWith('ERR ')) this.#next().reject(this.#calls.refused(line));
    else return this.#begin(parseStatus(line));
    return true;
  }

  #begin(reply) {
    this.#reply = reply;
    const { expected, size } = reply;
    if (size > this.oldest.most) throw Object.assign(new Error(`a reply of ${size} bytes`), { code: 'LARGE' });
    return expected > 0 || size !== undefined || this.#settle();
  }

  #settle() {
    const { keys, rows, data, event } = this.#reply;
    this.#reply = null;
    if (event === undefined) this.#next().resolve({ keys, rows, data });
    else this.#event = { ...event, rows };
    return true;
  }

  #next() {
    const done = this.#waiting.shift();
    this.#calls.onOldest();
    return done;
  }
}

if (typeof module === 'undefined') globalThis.Conversation = Conversation;
else module.exports = { Conversation };
