// Processor seconds to simplify a raster of about a million cells to an error that keeps a tenth, beside delatin, in runs that alternate;
// the least of the runs counts.
//
//     node beside_delatin.mjs PACKAGES PROGRAM [SIDE [ERROR]]        a folder where npm has installed delatin; simplify.c
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [packages, program, side = 1025, error = 1.62] = process.argv.slice(2);
const folder = path.join(path.resolve(packages), 'node_modules', 'delatin');
const main = JSON.parse(readFileSync(path.join(folder, 'package.json'))).module;
const { default: Delatin } = await import(pathToFileURL(path.join(folder, main)));
const RUNS = 5;
const GOAL = 0.5;

// ---- the surface of simplify.c ----

function hash(x, y) {
  let h = (Math.imul(x, 374761393) + Math.imul(y, 668265263)) | 0;
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

const smooth = (t) => t * t * t * (t * (6 * t - 15) + 10);

function noise(x, y) {
  const i = Math.floor(x);
  const j = Math.floor(y);
  const [u, v] = [smooth(x - i), smooth(y - j)];
  const [a, b, c, d] = [hash(i, j), hash(i + 1, j), hash(i, j + 1), hash(i + 1, j + 1)];
  return a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v;
}

function height(x, y) {
  let [sum, amplitude, frequency] = [0, 500, 4 / side];
  for (let octave = 0; octave < 9; octave++) {
    sum += amplitude * noise(x * frequency + octave * 17, y * frequency + octave * 31);
    amplitude *= 0.47;
    frequency *= 2;
  }
  return sum;
}

const n = Number(side);
const heights = Float64Array.from({ length: n * n }, (_, i) => height(i % n, Math.floor(i / n)));

function theirs() {
  const start = process.cpuUsage();
  const mesh = new Delatin(heights, n, n);
  mesh.run(Number(error));
  const { user, system } = process.cpuUsage(start);
  return { points: mesh.coords.length / 2, seconds: (user + system) / 1e6 };
}

function ours(...words) {
  const [points, worst, seconds] = execFileSync(program, [n, error, 2, ...words], { encoding: 'utf8' }).split(' ').map(Number);
  if (worst > error) throw new Error(`a point is off by ${worst}`);
  return { points, seconds };
}

const best = { delatin: { seconds: Infinity }, raster: { seconds: Infinity }, random: { seconds: Infinity } };
for (let run = 0; run < RUNS; run++)
  for (const [name, got] of [['delatin', theirs()], ['raster', ours()], ['random', ours('random')]])
    if (got.seconds < best[name].seconds) best[name] = got;

console.log(`| ${n * n} points, error ${error} | kept | seconds | of delatin's | goal |\n|---|---|---|---|---|`);
for (const [name, { points, seconds }] of Object.entries(best)) {
  const ratio = seconds / best.delatin.seconds;
  const goal = name === 'delatin' ? '' : `${GOAL}, ${ratio <= GOAL ? 'met' : 'missed'}`;
  console.log(`| ${name} | ${points} | ${seconds.toFixed(3)} | ${ratio.toFixed(2)} | ${goal} |`);
}
