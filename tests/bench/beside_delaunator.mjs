// Milliseconds beside delaunator and d3-delaunay, in runs that alternate; each figure is the median of its runs, each run on other points.
// "first" is the first call in a process of its own, which includes compiling.
//
//     node beside_delaunator.mjs PACKAGES        a folder where npm has installed both
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { Delaunay, Delaunator } from '../../clients/js/index.mjs';

const [packages, ...first] = process.argv.slice(2);
const peer = createRequire(path.join(path.resolve(packages), 'x.js'));
const { default: Theirs } = await import(peer.resolve('delaunator'));
const { Delaunay: TheirDelaunay } = await import(peer.resolve('d3-delaunay'));

const uniform = (n) => Float64Array.from({ length: 2 * n }, () => 1000 * Math.random());
const triangulate = (Class) => (points) => new Class(points);
const cells = (Class) => (points) => [...new Class(points).voronoi([0, 0, 1000, 1000]).cellPolygons()];

const tasks = {
  triangles: [triangulate(Delaunator), triangulate(Theirs)],
  cells: [cells(Delaunay), cells(TheirDelaunay)],
};

function time(act, points) {
  const start = performance.now();
  act(points);
  return performance.now() - start;
}

const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/** Small sets take less than the clock's resolution and are measured many at a time. */
function measure([ours, theirs], n, runs) {
  const many = Math.max(1, Math.round(20000 / n));
  const times = [[], []];
  for (let run = 0; run < runs + 2; run++) {
    const points = Array.from({ length: many }, () => uniform(n));
    [ours, theirs].forEach((act, k) => {
      const ms = points.reduce((sum, p) => sum + time(act, p), 0) / many;
      if (run >= 2) times[k].push(ms);
    });
  }
  return times.map(median);
}

/** In processes of their own. */
function measureFirst(n, runs) {
  const self = fileURLToPath(import.meta.url);
  const once = (k) => Number(execFileSync(process.execPath, [self, packages, String(k), String(n)], { encoding: 'utf8' }));
  const times = [[], []];
  for (let run = 0; run < runs; run++) for (const k of [0, 1]) times[k].push(once(k));
  return times.map(median);
}

const row = (name, n, [ours, theirs]) => console.log(`| ${name} | ${n} | ${ours.toPrecision(3)} | ${theirs.toPrecision(3)} | ${(ours / theirs).toFixed(2)} |`);

if (first.length > 0) {
  console.log(time(tasks.triangles[Number(first[0])], uniform(Number(first[1]))));
} else {
  console.log('| task | points | ours, ms | theirs, ms | ours / theirs |\n|---|---|---|---|---|');
  row('first triangles', 1000, measureFirst(1000, 15));
  for (const [n, runs] of [[1000, 41], [10000, 31], [100000, 15], [1000000, 5]]) row('triangles', n, measure(tasks.triangles, n, runs));
  for (const [n, runs] of [[1000, 21], [100000, 7]]) row('cells', n, measure(tasks.cells, n, runs));
}
