// Milliseconds of processor time beside earcut: the large polygons of its own tests, and random stars. A time is the least of runs that
// alternate. The last columns are the relative difference between the areas of triangles and polygon. Exits with 1 if a goal is missed.
//
//     node beside_earcut.mjs PACKAGES        a folder where npm has installed earcut, and as earcut_fixtures version 1.4.2, which has its tests
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import earcut from '../../clients/js/earcut.mjs';

const [packages] = process.argv.slice(2);
const peer = createRequire(path.join(path.resolve(packages), 'x.js'));
const theirs = await import(peer.resolve('earcut'));
const GOAL = 1.5;
const RUNS = 9;

function fixture(name) {
  return theirs.flatten(JSON.parse(readFileSync(path.join(packages, 'node_modules', 'earcut_fixtures', 'test', 'fixtures', `${name}.json`), 'utf8')));
}

function star(corners) {
  const vertices = Array.from({ length: 2 * corners }, () => 0);
  for (let i = 0; i < corners; i++) {
    const [angle, radius] = [(2 * Math.PI * i) / corners, 100 + 900 * Math.random()];
    vertices[2 * i] = radius * Math.cos(angle);
    vertices[2 * i + 1] = radius * Math.sin(angle);
  }
  return { vertices, holes: [], dimensions: 2 };
}

function time(act, repeats) {
  const start = process.cpuUsage();
  for (let i = 0; i < repeats; i++) act();
  const { user, system } = process.cpuUsage(start);
  return (user + system) / 1000 / repeats;
}

let missed = false;
function compare(name, { vertices, holes, dimensions }) {
  const repeats = Math.max(1, Math.round((20 * 5000 * dimensions) / vertices.length));
  const acts = [earcut, theirs.default].map((f) => () => f(vertices, holes, dimensions));
  const least = [Infinity, Infinity];
  for (let run = 0; run < RUNS; run++) acts.forEach((act, k) => (least[k] = Math.min(least[k], time(act, repeats))));
  const off = acts.map((act) => theirs.deviation(vertices, holes, dimensions, act()).toPrecision(2));
  const ratio = least[0] / least[1];
  console.log(`| ${name} | ${vertices.length / dimensions} | ${least[0].toFixed(3)} | ${least[1].toFixed(3)} | ${ratio.toFixed(2)} | ${GOAL} | ${off[0]} | ${off[1]} |`);
  missed ||= ratio > GOAL;
}

console.log('| polygon | corners | ours, ms | earcut, ms | ratio | goal | ours is off by | earcut |\n|---|---|---|---|---|---|---|---|');
for (const name of ['water-huge', 'water-huge2', 'water', 'water2', 'water4', 'water3']) compare(name, fixture(name));
for (const corners of [1000, 10000]) compare('random star', star(corners));
process.exit(missed ? 1 : 0);
