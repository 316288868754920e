// Conversations with the daemon through the gateway: requests in lines, replies in their order, events between them (PROTOCOL.md,
// sections 2, 7 and WATCH). A Connection is a WebSocket. Large replies are fetched by HTTP, which browsers read in less than half
// the time.

const LF = 10;
const text = new TextDecoder();

/** The error of an ERR line, or of a lost connection (code LOST). */
export class Refused extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}

/** The words key=value of a status line. */
function keysOf(line) {
  const keys = {};
  for (const word of line.split(' ')) {
    const at = word.indexOf('=');
    if (at > 0) keys[word.slice(0, at)] = word.slice(at + 1);
  }
  return keys;
}

/** Splits bytes that arrive in pieces into lines and, where the reader asks for them, blocks. */
class Splitter {
  #rest = new Uint8Array(0); // the beginning of a line
  #block = null; // the block that is being filled, and how much of it is
  #filled = 0;

  expectBlock(size) {
    this.#block = new Uint8Array(size);
    this.#filled = 0;
  }

  push(piece, onLine, onBlock) {
    let at = 0;
    for (;;) {
      if (this.#block !== null) {
        const n = Math.min(this.#block.length - this.#filled, piece.length - at);
        this.#block.set(piece.subarray(at, at + n), this.#filled);
        at += n;
        this.#filled += n;
        if (this.#filled < this.#block.length) return;
        const block = this.#block;
        this.#block = null;
        onBlock(block);
      }
      const end = piece.indexOf(LF, at);
      if (end < 0) break;
      const line = this.#rest.length === 0 ? piece.subarray(at, end) : this.#joined(piece.subarray(at, end));
      this.#rest = this.#rest.subarray(0, 0);
      at = end + 1;
      onLine(text.decode(line));
    }
    if (at < piece.length) this.#rest = this.#joined(piece.subarray(at));
  }

  #joined(piece) {
    const both = new Uint8Array(this.#rest.length + piece.length);
    both.set(this.#rest);
    both.set(piece, this.#rest.length);
    return both;
  }
}

const SILENT_S = 60; // without a byte while a reply is waited for: the conversation ends
const waiting = new Set(); // conversations, each a Reader, in which something is waited for

/** To be called once a second. Ends conversations in which nothing comes. Returns what has been waited for longest, {what, seconds, bytes};
 * null: nothing. bytes: that have come in that conversation. Seconds are counted by the calls, so that a page that had no time does not take that for silence. */
export function countWaits() {
  let longest = null;
  for (const reader of waiting) {
    const wait = reader.countSecond();
    if (wait !== null && wait.seconds > (longest?.seconds ?? 0)) longest = wait;
  }
  return longest;
}

/** Makes replies and events of the bytes that arrive. */
class Reader {
  #splitter = new Splitter();
  #waiting = []; // {what, seconds, answer, reject}, oldest first
  #silent = 0; // seconds
  #bytes = 0;
  #open = null; // what is being read: {rows, expected, done}
  #failure = null;

  /** onSilent() is called when nothing has come for long. A binary reply of more than `most` bytes ends the conversation, with the code
   * LARGE. */
  constructor({ onEvent = () => {}, onSilent, most = Infinity }) {
    Object.assign(this, { onEvent, onSilent, most });
  }

  countSecond() {
    for (const wait of this.#waiting) wait.seconds++;
    if (++this.#silent >= SILENT_S) {
      this.#silent = 0;
      this.onSilent();
    }
    const [wait] = this.#waiting;
    return wait === undefined ? null : { what: wait.what, seconds: wait.seconds, bytes: this.#bytes };
  }

  push(piece) {
    if (this.#failure !== null) return;
    this.#silent = 0;
    this.#bytes += piece.length;
    this.#splitter.push(
      piece,
      (line) => this.#read(line),
      (block) => this.#finish(block),
    );
  }

  /** The next reply that nobody waits for yet, that to a request `what`: {keys, rows, data}, rows of a text reply, bytes of a binary one.
   * Rejects with Refused. onReply() is called when it has come, before any event behind it. */
  reply(what, onReply = () => {}) {
    return new Promise((resolve, reject) => {
      const answer = (reply) => {
        onReply();
        resolve(reply);
      };
      if (this.#failure !== null) {
        reject(this.#failure);
        return;
      }
      if (this.#waiting.length === 0) this.#silent = 0;
      this.#waiting.push({ what, seconds: 0, answer, reject });
      waiting.add(this);
    });
  }

  /** No more replies come. */
  fail(error) {
    this.#failure = error;
    waiting.delete(this);
    for (const { reject } of this.#waiting.splice(0)) reject(error);
  }

  /** The awaited reply has come, without bytes. */
  pass() {
    this.#next().answer(null);
  }

  #next() {
    if (this.#waiting.length === 1) waiting.delete(this);
    return this.#waiting.shift();
  }

  #read(line) {
    if (this.#open !== null) {
      this.#open.rows.push(line);
      if (this.#open.rows.length === this.#open.expected) this.#finish(null);
      return;
    }
    const [kind, ...words] = line.split(' ');
    if (kind === 'ERR') {
      this.#next()?.reject(new Refused(words[0], words.slice(1).join(' '))); // of no request: the end of the connection follows
    } else if (kind === 'EVENT') {
      const { set, version } = keysOf(line);
      const event = { set, version: Number(version), rows: [] };
      for (const word of ['reset', 'more', 'dropped']) event[word] = words.includes(word);
      this.#begin(Number(words[0]), event.rows, () => this.onEvent(event));
    } else if (kind === 'OK') {
      const keys = keysOf(line);
      const rows = [];
      const done = (data) => this.#next().answer({ keys, rows, data });
      if (keys.bytes === undefined) {
        this.#begin(Number(words[0]), rows, done);
      } else if (Number(keys.bytes) > this.most) {
        throw new Refused('LARGE', `a reply of ${keys.bytes} bytes`);
      } else {
        this.#open = { rows, expected: 0, done };
        this.#splitter.expectBlock(Number(keys.bytes));
      }
    }
  }

  /** This number of lines follows; the lines become rows. */
  #begin(expected, rows, done) {
    if (expected === 0) done(null);
    else this.#open = { rows, expected, done };
  }

  #finish(data) {
    const { done } = this.#open;
    this.#open = null;
    done(data);
  }
}

const lost = () => new Refused('LOST', 'the connection is lost');

export class Connection {
  #socket;
  #reader;

  /** onEvent({set, version, rows, reset, more, dropped}); onEnd() once, when the connection is lost or closed. */
  constructor(url, { onEvent, onEnd }) {
    this.#socket = new WebSocket(url);
    this.#socket.binaryType = 'arraybuffer';
    this.#reader = new Reader({ onEvent, onSilent: () => this.close() });
    /** Rejects with Refused. */
    this.opened = this.#reader.reply('connection');
    this.#socket.onopen = () => this.#reader.pass();
    this.#socket.onmessage = ({ data }) => this.#read(new Uint8Array(data));
    this.#socket.onclose = () => {
      this.#reader.fail(lost());
      onEnd();
    };
  }

  #read(piece) {
    try {
      this.#reader.push(piece);
    } catch (error) {
      this.close(); // what comes next cannot be understood
      throw error;
    }
  }

  get isLost() {
    return this.#socket.readyState !== WebSocket.OPEN;
  }

  /** onEnd() is called soon. */
  close() {
    this.#reader.fail(lost());
    this.#socket.close();
  }

  /** Resolves to {keys, rows, data}, and calls onReply, as Reader.reply does. */
  async request(line, onReply) {
    if (this.isLost) throw lost(); // also before it is open: only replies to requests that were sent are waited for
    this.#socket.send(`${line}\n`);
    return this.#reader.reply(line, onReply);
  }
}

/** Sends requests in a conversation of their own: lines, or [line, bytes that follow it]. Returns the promises of their replies. With
 * `most`, a binary reply of more bytes is not read but ends the conversation, and is Refused with the code LARGE. */
export function fetchReplies(url, requests, most) {
  const stop = new AbortController();
  const reader = new Reader({ onSilent: () => stop.abort(), most });
  const replies = requests.map((request) => reader.reply([request].flat()[0]));
  const read = async () => {
    const body = new Blob(requests.flat().map((piece) => (typeof piece === 'string' ? `${piece}\n` : piece)));
    const response = await fetch(url, { method: 'POST', body, signal: stop.signal }).catch(() => null);
    if (!response?.ok) return;
    const pieces = response.body.getReader();
    const next = () => pieces.read().catch(() => ({ done: true }));
    for (let piece = await next(); !piece.done; piece = await next()) reader.push(piece.value);
  };
  read().then(
    () => reader.fail(lost()),
    (error) => {
      reader.fail(error); // too large, or no memory for it
      stop.abort();
    },
  );
  return replies;
}
