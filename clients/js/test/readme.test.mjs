// The examples of README.md run. The examples of a client need $DELAUNAYD.

import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { promisify } from 'node:util';

const home = new URL('../', import.meta.url);
const readme = readFileSync(new URL('README.md', home), 'utf8');
const FILES = { delaunayd: 'index', 'delaunayd/delaunator': 'delaunator', 'delaunayd/d3-delaunay': 'd3-delaunay', 'delaunayd/constrainautor': 'constrainautor', 'delaunayd/earcut': 'earcut' };

/** The indented code of a section that begins with an import; what follows without one belongs to it. */
function examplesOf(heading) {
  const section = readme.split(`\n## ${heading}\n`)[1].split('\n## ')[0];
  const blocks = section.match(/(?:^ {4}.*\n|^\n(?= {4}))+/gm).map((block) => block.replace(/^ {4}/gm, ''));
  return blocks.filter((block) => block.includes('import ')).map((block) => {
    return block.replace(/from '(delaunayd[^']*)'/g, (_, name) => `from '${new URL(`${FILES[name]}.mjs`, home)}'`);
  });
}

async function run(code) {
  const { stdout } = await promisify(execFile)(process.execPath, ['--input-type=module', '-e', code]);
  return stdout;
}

test('the examples of what computes in process run', async () => {
  const [delaunator, d3, polygons, live] = examplesOf('In process');
  assert.match(await run(delaunator), /Uint32Array/);
  const points = 'const points = [[0, 0], [960, 0], [960, 500], [0, 500], [100, 70]].map(([x, y]) => ({ x, y }));\n';
  assert.match(await run(points + d3), /M|Z/);
  const names = "import Delaunator from '" + new URL('delaunator.mjs', home) + "';\n";
  assert.equal(await run(`${names}${polygons}\nconsole.log(edge, triangles.length);`).then((said) => / 24\n$/.test(said)), true);
  assert.match(await run(live), /levels|coords/);
});

test('the examples of a client run', async () => {
  const [session, constraints] = examplesOf('Client of the daemon');
  assert.match(await run(session.replace('delaunay://localhost:6374', 'private:')), /distance: 1/);
  const said = await run(constraints);
  assert.match(said, /closed: true, triangles: 2, area: 18/);
  assert.match(said, /\[ \[ 1 \], \[ 1, 2 \] \]/);
});
