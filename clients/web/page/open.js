// A file of points that is opened becomes a new set: at once if the sets are in this page, otherwise after a question. Lines in it become
// constraints.
import { connection, fetchAll, isLocal, request } from './daemon.js';
import { parse } from './data/files.js';
import { ask, report } from './panel.js';
import { choose } from './sets.js';
import { loadedNames } from './shown.js';

const MOST_PAIRS = 1000; // in a line of CONSTRAIN

export async function openFile(file) {
  try {
    const points = parse(file.name, await file.text());
    const name = await freeName(file.name);
    if (isLocal) {
      connection().load(name, points);
      await show(name, points);
      return;
    }
    const count = new Intl.NumberFormat().format(points.xy.length / 2);
    ask(`Load ${count} points of ${file.name} into the new set ${name} of the server?`, [
      ['Load', () => upload(name, points).catch(report)],
      ['Cancel', () => {}],
    ]);
  } catch (error) {
    report(new Error(`${file.name}: ${error.message}`));
  }
}

/** The name of a new set for a file. */
async function freeName(fileName) {
  const { rows } = await request('SETS');
  const taken = new Set(rows.map((row) => row.split(' ')[0]));
  const stem = fileName.replace(/\.[^.]*$/, '').replace(/[^A-Za-z0-9_]/g, '_').slice(0, 40) || 'file';
  let name = stem;
  for (let k = 2; taken.has(name); k++) name = `${stem}_${k}`;
  return name;
}

async function upload(name, points) {
  const { xy, values, field } = points;
  const n = xy.length / 2;
  const rows = values === null ? xy : Float64Array.from({ length: 3 * n }, (_, k) => (k % 3 === 2 ? values[(k - 2) / 3] : xy[2 * ((k / 3) | 0) + (k % 3)]));
  await fetchAll([[`LOADB ${name} ${n}${values === null ? '' : ` FIELDS ${field}`}`, new Uint8Array(rows.buffer)]]);
  await request(`TRIANGULATE ${name}`);
  await show(name, points);
}

async function show(name, { names, constraints }) {
  loadedNames.set(name, names);
  await choose(name);
  for (let k = 0; k < constraints.length; k += MOST_PAIRS) {
    await request(`CONSTRAIN ${name} ${constraints.slice(k, k + MOST_PAIRS).flat().join(' ')}`);
  }
}
