// The page follows a set: a copy of it, a field and names. The layers are asked for again when the set or the view has changed.
import { showAngles } from './angles.js';
import { given, givenView } from './address.js';
import { connection, fetchAll, isLocal, isOpen, request } from './daemon.js';
import { parse } from './data/files.js';
import { Follower } from './data/follow.js';
import { showField } from './layers.js';
import { $, fillSelect, list, report, say } from './panel.js';
import { draw, mesh, overlay, scene, show, view } from './stage.js';

const MOST_POINTS = 250000; // of a daemon's set that is mirrored whole; `most` in the address
const REFRESH_MS = 400; // layers of the overlay are asked for so long after the last change
const SMALL = 3000; // points of a set whose layers are asked for at every change

/** Sets that come with the page: a title, the file, and whether its names are shown. */
export const SAMPLES = {
  ireland: { title: 'Towns of Ireland', file: 'ireland.csv', hasNames: true, unit: 'km' },
  cities: { title: 'Cities of the world', file: 'cities.xy', unit: 'degrees' },
  terrain: { title: 'A terrain', file: 'terrain.xyz', unit: 'm' },
};

/** set -> names of its points by id, of files that were opened on this page. */
export const loadedNames = new Map();
let totals = null; // STAT of the set
let fitNext = false; // the view is to show all of the next mesh
const handlers = {};

/** Sets the functions that are called: onSet(set) when another mesh is shown, or null when none is. onChange() when the set has changed.
 * onDropped(set) when the set that is shown was dropped. onStat(keys) when its counts are known, with the keys of STAT. */
export function on(calls) {
  Object.assign(handlers, calls);
}

export const follower = new Follower({
  connection,
  fetchAll,
  mesh,
  view,
  most: isLocal ? Infinity : Number(given('most') ?? MOST_POINTS),
  onShow: (squares) => {
    handlers.onSet(follower.set);
    const box = follower.kind === 'whole' ? mesh.box() : null;
    if (fitNext && box !== null) view.fit(box);
    if (box !== null) fitNext = false;
    scene.show(mesh, squares);
    overlay.lines.forget();
    showField(follower.field, box === null ? undefined : Math.max(box[2] - box[0], box[3] - box[1]));
    refreshSoon();
  },
  onChange: (box) => {
    if (box !== null) scene.update(box);
    overlay.stale();
    handlers.onChange();
    refreshSoon();
  },
  onDropped: (name) => {
    forget();
    handlers.onDropped(name);
  },
});
show(follower);

/** Nothing is left of the set that was shown. */
export function forget() {
  Object.assign(follower, { set: null, kind: null });
  overlay.clear();
  handlers.onSet(null);
  draw();
}

/** Fits the view to the whole set. */
export async function fit() {
  if (follower.set !== null) view.fit(await follower.around());
}

/** The field to be shown of a set: the one that is chosen, or the first. */
async function chosenField(set) {
  const { rows } = await request(`FIELDS ${set}`);
  const fields = rows.map((row) => row.split(' ')).map(([name, , min, max]) => ({ name, min: Number(min), max: Number(max) }));
  const name = $('field').dataset.set === set ? $('field').value : fields[0]?.name;
  const field = fields.find((other) => other.name === name) ?? null;
  $('field').dataset.set = set;
  fillSelect($('field'), ['', ...fields.map((other) => other.name)], field?.name);
  return field;
}

export async function follow(set, { keepView = false } = {}) {
  say(`loading ${set} ...`);
  overlay.clear();
  const kept = !keepView && [set, null].includes(given('set')) ? givenView() : null;
  if (kept !== null) Object.assign(view, kept);
  fitNext = !keepView && kept === null;
  try {
    await follower.follow(set, () => chosenField(set));
    if (fitNext) await fit();
  } catch (error) {
    if (follower.set === set) forget(); // it is tried again
    if (error.code === 'LOST' && !connection().isLost) say(`the replies about ${set} were lost; trying again ...`);
    throw error;
  }
  fitNext = false;
  if (follower.kind === 'whole') say('');
  if (!keepView) await showNames(set).catch(report);
  refreshSoon();
}

/** Continues to follow the set, if it still exists. */
export async function resume() {
  try {
    await follower.resume();
  } catch (error) {
    if (error.code !== 'NOSET') throw error;
    Object.assign(follower, { set: null, kind: null });
  }
  refreshSoon();
}

/** Shows the names of a file that was opened, or of a set that comes with the page if its points are still mostly those of its file. */
async function showNames(set) {
  overlay.names = loadedNames.get(set) ?? new Map();
  overlay.unit = SAMPLES[set]?.unit ?? '';
  if (!SAMPLES[set]?.hasNames) return;
  const response = await fetch(SAMPLES[set].file);
  if (!response.ok || follower.set !== set) return;
  const { names, xy } = parse(SAMPLES[set].file, await response.text());
  let same = 0;
  for (let k = 0; k < xy.length; k += 2) if (mesh.xy[k] === xy[k] && mesh.xy[k + 1] === xy[k + 1]) same++;
  if (same > xy.length / 4) overlay.names = names;
  overlay.stale();
  draw();
}

/** The point of a name has another id. */
export function rename(before, id) {
  if (!overlay.names.has(before)) return;
  overlay.names.set(id, overlay.names.get(before));
  overlay.names.delete(before);
}

/** Calls an asynchronous function; while it runs, only the newest of the calls that fall due is kept for later. */
export function latest(act) {
  let [isBusy, isAgain] = [false, false];
  return async function run() {
    isAgain = isBusy;
    if (isBusy) return;
    isBusy = true;
    await act().catch(report);
    isBusy = false;
    if (isAgain) run();
  };
}

/** Brings what is shown up to date with the set and the view, as far as events do not. */
const refresh = latest(async () => {
  const { set, kind } = follower;
  if (set === null || follower.isLoading || !isOpen()) return;
  totals = (await request(`STAT ${set}`)).keys;
  if (set !== follower.set) return;
  handlers.onStat(totals);
  if (totals.triangulated !== 'yes') return;
  const isDone = await follower.look();
  const about = { name: set, version: mesh.version, field: follower.field, hull: Number(totals.hull), mesh, kind: follower.kind };
  const missing = await overlay.lines.refresh(fetchAll, view, overlay.layers, about);
  say([follower.kind === 'sample' ? 'a sample of the triangles; zoom in to see all' : '', missing].filter(Boolean).join('; '));
  overlay.stale();
  draw();
  await refreshAngles(set);
  if (!isDone || kind !== follower.kind) refreshSoon();
});

let refreshTimer = 0;
export function refreshSoon() {
  if (refreshTimer !== 0) return;
  const isSmall = follower.kind === 'whole' && mesh.points <= SMALL;
  const later = () => {
    refreshTimer = 0;
    refresh();
  };
  refreshTimer = setTimeout(later, isSmall ? 0 : REFRESH_MS);
}

/** Shows the angles of the set as it is now, if somebody wants to see them. */
async function refreshAngles(set) {
  if (!$('angles').open) return;
  const reply = await request(`QUALITY ${set}`);
  if (set === follower.set) showAngles($('angles'), reply);
}

/** Shows how large the set is, and how often it has changed since the last call. */
export function showFacts() {
  const number = new Intl.NumberFormat();
  const { points, triangles } = follower.kind === 'whole' || totals === null ? mesh : totals;
  const facts = {
    points: number.format(points),
    triangles: number.format(triangles),
    'events / s': number.format(follower.events),
    version: mesh.version,
  };
  list('facts', follower.set === null ? {} : facts);
  follower.events = 0;
}
