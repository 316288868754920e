// Conversations with the daemon through the gateway. A Connection is a WebSocket. Large replies are fetched by HTTP, which browsers read
// in less than half the time.
import * as shared from './conversation.js';

const { Conversation } = shared.default ?? globalThis; // in Node, and in a browser

const SILENT_S = 60; // without a byte while a reply is waited for: the conversation ends

/** The error of an ERR line, or of a lost connection (code LOST). */
export class Refused extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}

const lost = () => new Refused('LOST', 'the connection is lost');

function refused(line) {
  const [, code, ...words] = line.split(' ');
  return new Refused(code, words.join(' '));
}

let seconds = 0; // that countWaits() has counted
const waiting = new Set(); // Talks in which something is waited for

/** To be called once a second. Ends conversations in which nothing comes. Returns what has been waited for longest, {what, seconds, bytes};
 * null: nothing. bytes: that have come in that conversation. Seconds are counted by the calls, so that a page that had no time does not take that for silence. */
export function countWaits() {
  seconds++;
  const waits = [...waiting].map((talk) => talk.wait()).filter((wait) => wait !== null);
  return waits.sort((a, b) => b.seconds - a.seconds)[0] ?? null;
}

/** A conversation that ends when nothing comes for long. */
class Talk extends Conversation {
  #heard = seconds; // when the last bytes came, or when they were first waited for
  #bytes = 0;

  constructor(calls) {
    super({ refused, ...calls });
  }

  push(piece) {
    this.#heard = seconds;
    this.#bytes += piece.length;
    super.push(piece);
  }

  /** Resolves to the reply to a request that is being sent, {keys, rows, data}. Calls onReply() when it has come, before any event behind
   * it. */
  reply(what, { onReply = () => {}, most } = {}) {
    if (this.oldest === undefined) this.#heard = seconds;
    waiting.add(this);
    return new Promise((resolve, reject) => {
      const answer = (reply) => {
        onReply();
        resolve(reply);
      };
      this.expect({ what, since: seconds, most, resolve: answer, reject });
    });
  }

  /** The longest wait; null: nothing is waited for. */
  wait() {
    if (seconds - this.#heard >= SILENT_S) this.fail(lost());
    if (this.oldest !== undefined) return { what: this.oldest.what, seconds: seconds - this.oldest.since, bytes: this.#bytes };
    waiting.delete(this);
    return null;
  }
}

export class Connection {
  #socket;
  #talk;

  /** onEvent({set, version, rows, reset, more, dropped}); onEnd() once, when the connection is lost or closed. */
  constructor(url, { onEvent, onEnd }) {
    this.#socket = new WebSocket(url);
    this.#socket.binaryType = 'arraybuffer';
    this.#talk = new Talk({
      onEvent,
      onFail: () => {
        this.#socket.close();
        onEnd();
      },
    });
    /** Rejects with Refused. */
    this.opened = this.#talk.reply('connection');
    this.#socket.onopen = () => this.#talk.pass();
    this.#socket.onmessage = ({ data }) => this.#talk.push(new Uint8Array(data));
    this.#socket.onclose = () => this.close();
  }

  get isLost() {
    return this.#socket.readyState !== WebSocket.OPEN;
  }

  close() {
    this.#talk.fail(lost());
  }

  /** Resolves to {keys, rows, data}, and calls onReply, as Talk.reply does. */
  async request(line, onReply) {
    if (this.isLost) throw lost(); // also before it is open: only replies to requests that were sent are waited for
    this.#socket.send(`${line}\n`);
    return this.#talk.reply(line, { onReply });
  }
}

/** Sends requests in a conversation of their own: lines, or [line, bytes that follow it]. Returns the promises of their replies. With
 * `most`, a binary reply of more bytes is not read but ends the conversation, with the code LARGE. */
export function fetchReplies(url, requests, most) {
  const stop = new AbortController();
  const talk = new Talk({ onFail: () => stop.abort() });
  const replies = requests.map((request) => talk.reply([request].flat()[0], { most }));
  const read = async () => {
    const body = new Blob(requests.flat().map((piece) => (typeof piece === 'string' ? `${piece}\n` : piece)));
    const response = await fetch(url, { method: 'POST', body, signal: stop.signal });
    if (!response.ok) return;
    const pieces = response.body.getReader();
    for (let piece = await pieces.read(); !piece.done; piece = await pieces.read()) talk.push(piece.value);
  };
  read().catch(() => {}).finally(() => talk.fail(lost()));
  return replies;
}
