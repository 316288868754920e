// Finds a daemon: by URL, or else $DELAUNAY_URL, or else localhost:6374, or else, if no server listens there, a private
// daemon.
'use strict';

const net = require('node:net');

const { Disconnected } = require('./errors.js');
const { withPrivate } = require('./private.js');

const PORT = 6374;

const TCP = /^delaunay:\/\/(?:[^@/:]*:([^@/]*)@)?(?:\[([^\]/]+)\]|([^@/:[\]]+))(?::(\d{1,5}))?\/?$/;
const UNIX = /^unix:\/\/(?:[^@/:]*:([^@/]*)@)?(\/.+)$/;

/** A % that begins no code of a character stands for itself. */
function decode(token = '') {
  try {
    return decodeURIComponent(token.replace(/%(?![\da-fA-F]{2})/g, '%25'));
  } catch {
    throw new TypeError('the token of the URL is not text in UTF-8');
  }
}

/** {where: options of net.connect, token} of delaunay://[:token@]host[:port], unix://[:token@]/path, or /path. */
function parseUrl(url) {
  const unix = UNIX.exec(url.startsWith('/') ? `unix://${url}` : url);
  if (unix) return { where: { path: unix[2] }, token: decode(unix[1]) };
  const tcp = TCP.exec(url);
  if (tcp?.[4] > 65535) throw new TypeError(`${url}: a port is at most 65535`);
  if (!tcp) throw new TypeError('a URL is delaunay://[:token@]host[:port], unix://[:token@]/path or private:');
  return { where: { host: tcp[2] ?? tcp[3], port: Number(tcp[4] ?? PORT) }, token: decode(tcp[1]) };
}

/** A connected socket. */
function open(where, timeout) {
  return new Promise((resolve, reject) => {
    const socket = net.connect({ ...where, noDelay: true });
    const name = where.path ?? `${where.host}:${where.port}`;
    const timer = setTimeout(() => fail(new Error(`no answer within ${timeout} ms`)), timeout);
    const fail = (error) => {
      clearTimeout(timer);
      socket.destroy();
      reject(new Disconnected(`cannot connect to ${name}: ${error.message || error.code}`, error.code ?? 'TIMEOUT', error));
    };
    socket.once('error', fail);
    socket.once('connect', () => {
      clearTimeout(timer);
      socket.removeListener('error', fail);
      resolve(socket);
    });
  });
}

const openPrivate = (timeout) => withPrivate((path) => open({ path }, timeout));

const NOBODY = ['ECONNREFUSED', 'ENETUNREACH', 'EADDRNOTAVAIL'];

/** A function that opens a socket to the same daemon every time, and the token for that daemon. */
function chooseAddress(url = process.env.DELAUNAY_URL || undefined) {
  if (url === 'private:') return { token: '', open: openPrivate };
  if (url !== undefined) {
    const { where, token } = parseUrl(url);
    return { token, open: (timeout) => open(where, timeout) };
  }
  const where = { host: 'localhost', port: PORT };
  let chosen = null; // by the first success
  return {
    token: '',
    async open(timeout) {
      if (chosen) return chosen(timeout);
      let socket;
      try {
        socket = await open(where, timeout);
        chosen = (limit) => open(where, limit);
      } catch (error) {
        if (!NOBODY.includes(error.code)) throw error;
        socket = await openPrivate(timeout).catch((why) => {
          why.message = `no server at localhost:${PORT}, and ${why.message}`;
          throw why;
        });
        chosen = openPrivate;
      }
      return socket;
    },
  };
}

module.exports = { chooseAddress, parseUrl };
