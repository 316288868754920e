// For tests and measurements of the page: a daemon, a gateway and Chromium, sets and pages.
// DELAUNAYD is the daemon, BROWSER is Chromium.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { connect } from 'node:net';
import { createInterface } from 'node:readline';
import { setTimeout as sleep } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';
import { PNG } from 'pngjs';
import puppeteer from 'puppeteer-core';
import { sequence } from './rough.mjs';

const { DELAUNAYD, BROWSER = '/usr/bin/chromium' } = process.env;
const GATEWAY = fileURLToPath(new URL('../gateway.mjs', import.meta.url));
const QUIET = ['disable-quic', 'no-first-run', 'disable-background-networking', 'disable-component-update', 'disable-sync'];
const SOFTWARE_WEBGL = ['use-gl=angle', 'use-angle=swiftshader', 'enable-unsafe-swiftshader'];

const PATIENCE_MS = 90000; // that a test waits: several times what a page takes when the machine has other work

let daemon, gateway;
export let port, pagePort, browser;

/** Starts everything; `options` of the daemon. */
export async function start({ options = [] } = {}) {
  daemon = spawn(DELAUNAYD, ['--port', '0', '--log-level', 'warning', ...options], { stdio: ['ignore', 'pipe', 'inherit'] });
  const [line] = await once(createInterface(daemon.stdout), 'line');
  port = Number(/:(\d+)$/.exec(line)[1]);
  await listen(0);
  browser = await puppeteer.launch({
    executablePath: BROWSER,
    args: ['no-sandbox', 'disable-dev-shm-usage', ...QUIET, ...SOFTWARE_WEBGL].map((word) => `--${word}`),
    protocolTimeout: 2 * PATIENCE_MS,
  });
}

export async function stop() {
  await browser?.close();
  gateway?.kill();
  daemon?.kill();
}

/** Starts a gateway on a port, 0: any; by default on that of the last one. */
export async function listen(at = pagePort, daemonPort = port) {
  gateway?.kill();
  gateway = spawn(process.execPath, [GATEWAY, '--daemon', String(daemonPort), '--listen', String(at)], { stdio: ['ignore', 'pipe', 'inherit'] });
  const [line] = await once(createInterface(gateway.stdout), 'line');
  pagePort = Number(/:(\d+)\/$/.exec(line)[1]);
}

export function killGateway() {
  gateway.kill('SIGKILL');
}

async function pause(program, ms) {
  program.kill('SIGSTOP');
  await sleep(ms);
  program.kill('SIGCONT');
}

export const pauseGateway = (ms) => pause(gateway, ms);
export const signalGateway = (signal) => gateway.kill(signal);
export const pauseDaemon = (ms) => pause(daemon, ms);

/** The lines of a reply; requests end with QUIT, whose reply is left out. */
export function ask(...requests) {
  return new Promise((resolve, reject) => {
    const socket = connect(port, '127.0.0.1');
    let text = '';
    socket.setEncoding('utf8').on('data', (piece) => (text += piece));
    socket.on('error', reject).on('end', () => resolve(text.split('\n').slice(0, -2)));
    socket.write(`${requests.join('\n')}\nQUIT\n`);
  });
}

/** A set of n points in the unit square, always the same. */
export async function makeSet(name, n, seed = 1) {
  const next = sequence(seed);
  const adds = [];
  for (let i = 0; i < n; i += 1000) {
    adds.push(`ADD ${name} ${Array.from({ length: 2 * Math.min(1000, n - i) }, next).join(' ')}`);
  }
  const replies = await ask(...adds, `TRIANGULATE ${name}`);
  const refused = replies.find((line) => line.startsWith('ERR'));
  if (refused !== undefined) throw new Error(refused);
}

let visited = []; // pages of this test

/** Closes the pages of a test. None may have had a fault. */
export async function closePages() {
  const pages = visited;
  visited = [];
  for (const page of pages) await page.browserContext().close();
  assert.deepEqual(pages.flatMap(({ faults }) => faults), []);
}

/** A page at an address behind `/`; before() runs in it before its scripts, onDocument(page) is called when its document exists. */
export async function visit(address, { size = { width: 900, height: 600 }, at = pagePort, before = null, onDocument = () => {} } = {}) {
  const page = await (await browser.createBrowserContext()).newPage(); // a window of its own: a hidden page does not draw
  visited.push(page);
  page.setDefaultTimeout(PATIENCE_MS);
  await page.setViewport(size);
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(error.stack ?? String(error)));
  page.on('error', (error) => page.faults.push(String(error))); // the page has crashed
  if (before !== null) await page.evaluateOnNewDocument(before);
  await page.goto(`http://127.0.0.1:${at}/${address}`, { waitUntil: 'domcontentloaded' });
  onDocument(page);
  await page.evaluate(async () => {
    window.app = await import('./main.js');
  });
  return page;
}

/** A page that shows a set; `rest` of the address. */
export async function open(set, size, rest = '') {
  const page = await visit(`#set=${set}${rest}`, { size });
  await settled(page, set);
  await waitFor(page, () => window.app.scene.counts.whole > 0 && !/loading/.test(document.getElementById('message').textContent));
  return page;
}

/** Waits until a function is true on the page. The error says what the page does instead. */
export async function waitFor(page, isTrue, { polling = 50, timeout = PATIENCE_MS } = {}, ...words) {
  try {
    await page.waitForFunction(isTrue, { polling, timeout }, ...words);
  } catch (error) {
    throw new Error(`${error.message}\n${JSON.stringify(await stateOf(page), null, 1)}`, { cause: error });
  }
}

async function stateOf(page) {
  const read = page.evaluate(() => {
    const { follower, mesh, scene } = window.app;
    const { set, kind } = follower;
    const { version, points, triangles } = mesh;
    const requests = performance.getEntriesByType('resource').slice(-6);
    const text = (id) => document.getElementById(id)?.innerText;
    return {
      texts: [text('message'), text('notice'), text('pointer'), text('waiting'), text('facts')],
      mesh: { set, kind, version, points, triangles },
      counts: scene.counts,
      document: [document.readyState, document.visibilityState],
      requests: requests.map(({ name, startTime, duration }) => `${name} at ${Math.round(startTime)} ms for ${Math.round(duration)} ms`),
    };
  });
  const late = sleep(10000, { state: 'the page does not answer' });
  return { ...(await Promise.race([read.catch((error) => ({ state: String(error) })), late])), faults: page.faults };
}

/** Waits until the text of an element contains a text; '': until it is empty. White space counts as one blank. */
export const says = (page, id, text) =>
  waitFor(
    page,
    (i, t) => {
      const now = document.getElementById(i).innerText.replace(/\s+/g, ' ').trim();
      return t === '' ? now === '' : now.includes(t);
    },
    {},
    id,
    text,
  );

/** Presses the button of the notice with this label. */
export const press = (page, label) =>
  page.evaluate((l) => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === l).click(), label);

/** The place of a point in the daemon; undefined: there is none. */
export const placeOf = async (set, id) => (await ask(`GET ${set} ${id}`))[1]?.split(' ').slice(1).map(Number);

/** Waits until a point is near a place in the daemon. */
export const isAt = (set, id, [x, y], distance = 0.01) =>
  until(async () => ((p) => p !== undefined && Math.hypot(p[0] - x, p[1] - y) <= distance)(await placeOf(set, id)));

/** The page's part of the set. points: [id, x, y]; triangles: three ids as text, the smallest first, sorted. */
export const known = (page) =>
  page.evaluate(() => {
    const { mesh } = window.app;
    const points = [];
    for (let n = 0; n < mesh.ids; n++) if (mesh.hasPoint(n)) points.push([mesh.idOf(n), mesh.xy[2 * n], mesh.xy[2 * n + 1]]);
    const triangles = [];
    for (let k = 0; k < 3 * mesh.triangles; k += 3) {
      const c = [...mesh.corners.subarray(k, k + 3)].map((n) => mesh.idOf(n));
      while (c[0] > c[1] || c[0] > c[2]) c.push(c.shift());
      triangles.push(c.join(' '));
    }
    return { points, triangles: triangles.sort() };
  });

/** The pixels of canvases, one over the other, {width, height, data}, when what has changed is drawn. */
export async function picture(page, ...ids) {
  const text = await page.evaluate(async (names) => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const { width, height } = document.getElementById('mesh');
    const copy = Object.assign(document.createElement('canvas'), { width, height });
    for (const name of names) copy.getContext('2d').drawImage(document.getElementById(name), 0, 0);
    return copy.toDataURL();
  }, ids);
  return PNG.sync.read(Buffer.from(text.split(',')[1], 'base64'));
}

/** The share of the pixels of canvases between two opposite corners in the plane, by default everywhere, that are drawn. */
export async function drawnShare(page, ids, from = null, to = null) {
  const { width, height, data } = await picture(page, ...ids);
  let [x0, y0, x1, y1] = [0, 0, width, height];
  if (from !== null) {
    const corners = await page.evaluate((...two) => two.map((place) => window.app.view.toScreen(...place)), from, to);
    [x0, y1, x1, y0] = corners.flat().map(Math.round);
  }
  let drawn = 0;
  for (let y = y0; y < y1; y++) for (let x = x0; x < x1; x++) if (data[4 * (y * width + x) + 3] > 0) drawn++;
  return drawn / ((x1 - x0) * (y1 - y0));
}

/** Waits until the page has the set as it is now. */
export async function settled(page, set) {
  const version = () => ask(`STAT ${set}`).then(([line]) => Number(/version=(\d+)/.exec(line)[1]));
  const now = await version();
  await waitFor(page, (v) => window.app.mesh.version >= v, {}, now);
}

/** Returns the position on the page of a place of the plane. */
export const onPage = (page, x, y) =>
  page.evaluate(
    ([px, py]) => {
      const { left, top } = document.getElementById('map').getBoundingClientRect();
      const [sx, sy] = window.app.view.toScreen(px, py);
      return [left + sx, top + sy];
    },
    [x, y],
  );

export async function drag(page, from, to, steps = 10) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps });
  await page.mouse.up();
}

/** Waits until the function returns something true, and returns that. */
export async function until(what) {
  for (let tries = 0; ; tries++) {
    const found = await what();
    if (found) return found;
    if (100 * tries > PATIENCE_MS) throw new Error(`never: ${what}`);
    await sleep(100);
  }
}
