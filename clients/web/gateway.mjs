// The gateway: an HTTP server with the page's files, and for each WebSocket, and each POST, of `/daemon` a TCP connection to the
// daemon. Bytes pass in both directions as they are; a slow side slows down the other one. A POST is a conversation whose requests
// are its body.
//
//     node gateway.mjs [--daemon HOST:PORT] [--listen [HOST:]PORT]
import { createServer } from 'node:http';
import { readFile, readdir } from 'node:fs/promises';
import { connect } from 'node:net';
import { extname } from 'node:path';
import { pipeline } from 'node:stream';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { WebSocketServer, createWebSocketStream } from 'ws';

const PAGE = new URL('./page/', import.meta.url);
const TYPES = { '.html': 'text/html; charset=utf-8', '.css': 'text/css', '.js': 'text/javascript', '.svg': 'image/svg+xml' };
const HEADERS = {
  'Cache-Control': 'no-cache',
  'Content-Security-Policy': "default-src 'self'; connect-src 'self' ws: wss:; frame-ancestors 'none'",
  'X-Content-Type-Options': 'nosniff',
};
const LONGEST_MESSAGE = 1 << 20; // bytes of a page's request
const LONGEST_POINTER = 1024; // bytes

async function serve(daemon, request, response) {
  const { pathname } = new URL(request.url, 'http://page');
  if (request.method === 'POST' && pathname === '/daemon') {
    converse(daemon, request, response);
    return;
  }
  const name = pathname === '/' ? 'index.html' : pathname.slice(1);
  if (!['GET', 'HEAD'].includes(request.method) || !/^([a-z]+\/)?[a-z]+\.[a-z]+$/.test(name)) {
    response.writeHead(404).end('not found\n');
    return;
  }
  try {
    const content = await readFile(fileURLToPath(new URL(name, PAGE)));
    const preloads = name === 'index.html' ? { Link: await linksOfModules() } : {};
    response.writeHead(200, { ...HEADERS, ...preloads, 'Content-Type': TYPES[extname(name)] ?? 'application/octet-stream' });
    response.end(request.method === 'HEAD' ? undefined : content);
  } catch {
    response.writeHead(404).end('not found\n');
  }
}

/** Names the modules of the page, so that a browser fetches all at once instead of one after the other as they import each other. */
async function linksOfModules() {
  const modules = (await readdir(PAGE, { recursive: true })).filter((name) => name.endsWith('.js'));
  return modules.map((name) => `<${name}>; rel=modulepreload`).join(', ');
}

function converse(daemon, request, response) {
  if (!isOwn(request)) {
    response.writeHead(403).end('only for pages of this gateway\n');
    return;
  }
  const socket = connect({ ...daemon, noDelay: true });
  socket.once('connect', () => response.writeHead(200, { ...HEADERS, 'Content-Type': 'application/octet-stream' }));
  pipeline(request, socket, () => {});
  pipeline(socket, response, () => request.destroy());
}

/** Whether the page that sends a request came from this gateway; other sites' pages must not reach the daemon. */
function isOwn({ headers: { origin, host } }) {
  try {
    return origin === undefined || new URL(origin).host === host;
  } catch {
    return false;
  }
}

/** An http.Server that is not listening yet; daemon: {host, port}. */
export function createGateway(daemon) {
  const server = createServer((request, response) => serve(daemon, request, response));
  const verifyClient = ({ req }) => isOwn(req);
  const sockets = new WebSocketServer({ noServer: true, verifyClient, maxPayload: LONGEST_MESSAGE });
  const pointers = new WebSocketServer({ noServer: true, verifyClient, maxPayload: LONGEST_POINTER });
  pointers.on('connection', (page) => passPointer(daemon, pointers, page));
  server.on('upgrade', (request, socket, head) => {
    const found = { '/daemon': sockets, '/pointers': pointers }[new URL(request.url, 'http://page').pathname];
    if (found === undefined) socket.destroy();
    else found.handleUpgrade(request, socket, head, (page) => found.emit('connection', page));
  });
  sockets.on('connection', (page) => {
    const socket = connect({ ...daemon, noDelay: true });
    const stream = createWebSocketStream(page);
    const ended = () => page.terminate();
    pipeline(socket, stream, ended);
    pipeline(stream, socket, ended);
  });
  return server;
}

let pages = 0; // that have sent a pointer

/** Whether the daemon shows a set to someone with this token; null: without one. */
async function maySee(daemon, token, set) {
  const socket = connect({ ...daemon, noDelay: true });
  socket.end(`${token === null ? '' : `AUTH ${token}\n`}STAT ${set}\n`);
  let replies = '';
  try {
    for await (const piece of socket) replies += piece;
  } catch {
    return false;
  }
  return /(^|\n)OK [^\n]*\n$/.test(replies);
}

/** Passes the pointer of a page, {set, place: [x, y] or null, token}, to the other pages that show the same set, as {number, place}. A
 * page that begins to show a set gets the pointers of the others, if the daemon shows it the set. */
function passPointer(daemon, pointers, page) {
  Object.assign(page, { number: pages++, wanted: null, shown: null, place: null });
  const others = () => [...pointers.clients].filter((other) => other !== page && other.shown === page.shown && page.shown !== null);
  const tell = (to, { number, place }) => to.send(JSON.stringify({ number, place }));
  const pass = (place) => {
    page.place = place;
    for (const other of others()) tell(other, page);
  };
  page.on('error', () => {});
  page.on('close', () => pass(null));
  page.on('message', async (data) => {
    const { set, place, token } = pointerOf(data);
    if (set === page.wanted) {
      pass(place);
    } else {
      pass(null);
      Object.assign(page, { wanted: set, shown: null, place });
      if (set === null || !(await maySee(daemon, token, set))) return;
      if (page.wanted !== set || page.readyState !== page.OPEN) return;
      page.shown = set;
      for (const other of others()) if (other.place !== null) tell(page, other);
      pass(page.place);
    }
  });
}

/** Reads a message of a page, which may say anything. The set and the token are words or null, and the place is two numbers or null. */
function pointerOf(data) {
  const wordOf = (value) => (typeof value === 'string' && /^[^\s\0]+$/.test(value) ? value : null);
  try {
    const { set, place, token } = JSON.parse(data);
    const isPlace = Array.isArray(place) && place.length === 2 && place.every(Number.isFinite);
    return { set: wordOf(set), place: isPlace ? place : null, token: wordOf(token) };
  } catch {
    return { set: null, place: null, token: null };
  }
}

/** {host, port} of `HOST:PORT`, `[HOST]:PORT` or `PORT`. */
function parseAddress(text, host) {
  const [, name = host, port] = /^(?:\[?(.*?)\]?:)?(\d+)$/.exec(text) ?? [];
  if (!(port <= 65535)) throw new Error(`not an address: ${text}`);
  return { host: name, port: Number(port) };
}

function main() {
  const { values } = parseArgs({
    options: {
      daemon: { type: 'string', default: '127.0.0.1:6374' },
      listen: { type: 'string', default: '127.0.0.1:8080' },
    },
  });
  const server = createGateway(parseAddress(values.daemon, '127.0.0.1'));
  server.on('error', (error) => {
    console.error(`gateway: ${error.message}`);
    process.exitCode = 1;
  });
  server.listen(parseAddress(values.listen, '127.0.0.1'), () => {
    const { address, family, port } = server.address();
    console.log(`open http://${family === 'IPv6' ? `[${address}]` : address}:${port}/`);
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main();
