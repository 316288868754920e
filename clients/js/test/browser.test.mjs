// The classes in process, in Chromium: a page opened from a file, a module from a static folder, and a worker.

import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { once } from 'node:events';
import { existsSync } from 'node:fs';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { Delaunay, Delaunator, LiveSet } from '../index.mjs';

const { BROWSER = '/usr/bin/chromium' } = process.env;
const skip = !existsSync(BROWSER) && 'this machine has no Chromium';
const root = fileURLToPath(new URL('..', import.meta.url));
let scratch;

before(async () => {
  scratch = await mkdtemp(path.join(tmpdir(), 'browser-'));
});
after(() => rm(scratch, { recursive: true, force: true }));

/** The title that a page has written when it has loaded. */
async function titleOf(url) {
  const flags = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--virtual-time-budget=20000', `--user-data-dir=${scratch}/profile`];
  const { stdout } = await promisify(execFile)(BROWSER, [...flags, '--dump-dom', url], { timeout: 120000, maxBuffer: 1 << 26 });
  return /<title>([^<]*)<\/title>/.exec(stdout)?.[1];
}

/** Runs in Node and in the browser: a number of everything that the classes answer about points that are the same everywhere. */
function summary(Delaunator, Delaunay, LiveSet) {
  let state = 7;
  const next = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 22;
  };
  let sum = 0;
  const take = (numbers) => {
    for (const bits of new Uint32Array(numbers.slice().buffer)) sum = (Math.imul(sum, 31) + bits) >>> 0;
  };
  for (const points of [Float64Array.from({ length: 20000 }, next), Float64Array.from({ length: 800 }, () => Math.round(next() / 50))]) {
    const { triangles, halfedges, hull } = new Delaunator(points);
    const live = LiveSet.from(points, { values: points.subarray(0, points.length / 2) });
    live.move(3, 5, 7);
    const { coords } = live.cells([0, 0, 1000, 1000]);
    const places = Float64Array.from({ length: 200 }, next);
    [triangles, halfedges, hull, live.triangulation().triangles, coords].forEach(take);
    [live.nearest(places, 3), live.interpolate(places, { method: 'natural' }), live.contours([100]).coords].forEach(take);
    take(Float64Array.from(new Delaunay(points).voronoi([0, 0, 1000, 1000]).cellPolygon(1).flat()));
  }
  return String(sum);
}

const expected = summary(Delaunator, Delaunay, LiveSet);

test('a page that is opened from a file has the same answers', { skip }, async () => {
  const page = path.join(scratch, 'page.html');
  const script = pathToFileURL(path.join(root, 'browser.js'));
  const call = '(d) => summary(d.Delaunator, d.Delaunay, d.LiveSet)';
  await writeFile(page, `<title>no</title><script src="${script}"></script><script>${summary}; document.title = (${call})(delaunayd)</script>`);
  assert.equal(await titleOf(pathToFileURL(page).href), expected);
});

test('a module from a static folder has the same answers, also in a worker', { skip }, async () => {
  const types = { '.mjs': 'text/javascript', '.js': 'text/javascript', '.html': 'text/html' };
  const worker = `import { Delaunator, Delaunay, LiveSet } from '/browser.mjs'; ${summary}; postMessage(summary(Delaunator, Delaunay, LiveSet));`;
  const page = `<title>no</title><script type="module">
    import Delaunator, { Delaunay, LiveSet } from '/browser.mjs';
    ${summary}
    new Worker('/worker.mjs', { type: 'module' }).onmessage = ({ data }) => { document.title = summary(Delaunator, Delaunay, LiveSet) + ' ' + data; };
  </script>`;
  const made = { '/page.html': page, '/worker.mjs': worker };
  const server = createServer(async ({ url }, answer) => {
    answer.setHeader('content-type', types[path.extname(url)] ?? 'text/plain');
    answer.end(made[url] ?? (await readFile(path.join(root, url)).catch(() => '')));
  }).listen(0);
  await once(server, 'listening');
  const { port } = server.address();
  try {
    assert.equal(await titleOf(`http://localhost:${port}/page.html`), `${expected} ${expected}`);
    assert.equal(await titleOf(`http://localhost:${port}/example.html`), 'Delaunay in the browser');
  } finally {
    server.closeAllConnections();
    server.close();
  }
});
