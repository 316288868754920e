// browser.js, the file for browsers, contains the modules of this package as they are.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { runInNewContext } from 'node:vm';
import { Worker } from 'node:worker_threads';

const read = (name) => readFileSync(new URL(`../${name}`, import.meta.url), 'utf8');

test('browser.js is up to date (make bundle)', () => {
  const bundle = read('browser.js');
  for (const name of ['module', 'errors', 'points', 'core', 'line', 'mesh', 'path', 'voronoi']) assert.ok(bundle.includes(read(`lib/${name}.js`)), name);
  for (const name of ['delaunator', 'd3-delaunay', 'live', 'constrainautor', 'earcut']) assert.ok(bundle.includes(read(`${name}.js`)), name);
});

test('browser.js runs where there is nothing of Node, as a script and as a module', async () => {
  const context = { atob, WebAssembly };
  runInNewContext(`${read('browser.js')}; result = new delaunayd.Delaunator([0, 0, 1, 0, 0, 1]).triangles.join()`, context);
  assert.equal(context.result, '0,2,1');
  const { default: Delaunator, Delaunay, LiveSet, Voronoi } = await import('../browser.mjs');
  assert.deepEqual([...new Delaunator([0, 0, 1, 0, 0, 1]).triangles], [0, 2, 1]);
  assert.ok(Delaunay.from([[1, 2]]).voronoi() instanceof Voronoi);
  assert.equal(LiveSet.from([0, 0, 1, 0, 0, 1]).size, 3);
});

test('bundlers find for each entry of the package what Node finds', async () => {
  const { exports } = JSON.parse(read('package.json'));
  for (const entry of ['delaunator', 'd3-delaunay', 'constrainautor', 'earcut']) {
    const { node, default: bundled } = exports[`./${entry}`];
    const [theirs, ours] = await Promise.all([node, { default: bundled }].map((file) => import(`../${file.default}`)));
    for (const name of Object.keys(theirs)) assert.equal(ours[name]?.name, theirs[name].name, `${entry}: ${name}`);
    assert.equal(exports[`./${entry}`].require.default, `./${entry}.js`);
  }
  const { LiveSet, NONE } = await import('../browser.mjs');
  assert.deepEqual([...LiveSet.from([0, 0]).nearest([1, 1], 2)], [0, NONE]);
});

test('a worker has a core of its own', async () => {
  const program = `const { parentPort } = require('node:worker_threads');
    parentPort.postMessage([...new (require(${JSON.stringify(new URL('../delaunator.js', import.meta.url).pathname)}))([0, 0, 1, 0, 0, 1]).triangles]);`;
  const answers = [1, 2, 3].map(() => new Promise((done, fail) => new Worker(program, { eval: true }).on('message', done).on('error', fail)));
  assert.deepEqual(await Promise.all(answers), [[0, 2, 1], [0, 2, 1], [0, 2, 1]]);
});
