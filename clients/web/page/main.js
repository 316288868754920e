// The page: follows one set of the daemon and shows it. Start reading here; follow.js decides what of the set is shown, mesh.js has the
// copy of it, scene.js the drawing.
import { Connection, countWaits, fetchReplies } from './connection.js';
import { Follower } from './follow.js';
import { Hands } from './hands.js';
import { Mesh } from './mesh.js';
import { Overlay } from './overlay.js';
import { Scene } from './scene.js';
import { View } from './view.js';

const MOST_POINTS = 4e6; // of a set that is mirrored whole; `most` in the address
const RETRY_MS = 1000;
const REFRESH_MS = 400; // layers of the overlay are asked for so long after the last change
const REFUSAL_MS = 4000; // that the message about a refused request stays
const SETS_MS = 3000;
const LONG_S = 4; // what is waited for longer is named
const NOT_NOW = ['LOADING', 'BUSY', 'NOMEM', 'TIMEOUT']; // errors of a daemon that may answer later

const $ = (id) => document.getElementById(id);
const canvas = { mesh: $('mesh'), overlay: $('overlay') };

const mesh = new Mesh();
const view = new View();
const overlay = new Overlay(canvas.overlay);
const scene = newScene();
let connection = null;
let access = 'unknown'; // to the daemon; 'given' or 'refused'
let refusedAt = 0; // when a request was refused last
let totals = null; // STAT of the set

/** Reads the address behind `#`: set=NAME, token=TOKEN, most=POINTS. */
const given = (name) => new URLSearchParams(location.hash.slice(1)).get(name);

/* ---- drawing ---- */

function newScene() {
  try {
    return new Scene(canvas.mesh, () => requestDraw());
  } catch (error) {
    say(error.message);
    throw error;
  }
}

let drawRequested = false;
function requestDraw() {
  if (drawRequested) return;
  drawRequested = true;
  requestAnimationFrame(() => {
    drawRequested = false;
    if (follower.set === null) scene.clear();
    else if (follower.kind !== null) scene.draw(view);
    overlay.draw(view);
  });
}

function resize() {
  const { clientWidth, clientHeight } = canvas.mesh.parentElement;
  view.resize(clientWidth, clientHeight);
  for (const c of Object.values(canvas)) {
    c.width = Math.max(1, Math.round(clientWidth * devicePixelRatio));
    c.height = Math.max(1, Math.round(clientHeight * devicePixelRatio));
  }
  scene.stale();
}

const THEMES = {
  light: { fill: [0.16, 0.44, 0.69, 0.08], edge: [0.16, 0.4, 0.65, 0.85] },
  dark: { fill: [0.35, 0.6, 0.9, 0.1], edge: [0.5, 0.72, 0.95, 0.85] },
};

function applyStyle() {
  const field = follower.field;
  const theme = THEMES[document.documentElement.dataset.theme];
  Object.assign(scene.style, theme, {
    coloured: field !== null && $('coloured').checked,
    edged: $('triangles').checked,
    range: field === null ? [0, 1] : [field.min, field.max],
  });
  if (!$('triangles').checked) scene.style.fill = [0, 0, 0, 0];
  scene.stale();
}

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  localStorage.setItem('theme', name);
  applyStyle();
}

/* ---- texts ---- */

function say(text) {
  if ($('message').textContent !== text) $('message').textContent = text;
}

function list(id, facts) {
  $(id).replaceChildren(
    ...Object.entries(facts).flatMap(([name, value]) => {
      const [dt, dd] = [document.createElement('dt'), document.createElement('dd')];
      dt.textContent = name;
      dd.textContent = value;
      return [dt, dd];
    }),
  );
}

function showFacts(perSecond = 0) {
  if (follower.set === null) {
    list('facts', {});
    return;
  }
  const number = new Intl.NumberFormat();
  const { points, triangles } = follower.kind === 'whole' || totals === null ? mesh : totals;
  list('facts', {
    points: number.format(points),
    triangles: number.format(triangles),
    'events / s': number.format(perSecond),
    version: mesh.version,
  });
}

function showWaits() {
  const wait = countWaits();
  let text = scene.isLost ? 'waiting for WebGL' : '';
  if (wait !== null && wait.seconds >= LONG_S) {
    const [what, set = ''] = wait.what.split(' ');
    text = `waiting for ${what === 'AUTH' ? what : `${what} ${set}`}, ${wait.seconds} s, ${(wait.bytes / 1e6).toFixed(1)} MB so far`;
  }
  if ($('waiting').textContent !== text) $('waiting').textContent = text;
}

/* ---- the set ---- */

/** Calls an asynchronous function; while it runs, only the newest of the calls that fall due is kept for later. */
function latest(act) {
  let [busy, next] = [false, null];
  return async function run(...words) {
    if (busy) {
      next = words;
      return;
    }
    busy = true;
    try {
      await act(...words);
    } catch (error) {
      report(error);
    }
    busy = false;
    if (next !== null) {
      const again = next;
      next = null;
      run(...again);
    }
  };
}

/** The replies to requests whose replies may be large. */
async function fetchAll(requests, most) {
  const auth = given('token') === null ? [] : [`AUTH ${given('token')}`];
  const replies = await Promise.all(fetchReplies('daemon', [...auth, ...requests], most));
  return replies.slice(auth.length);
}

const follower = new Follower({
  connection: () => connection,
  fetchAll,
  mesh,
  view,
  most: Number(given('most') ?? MOST_POINTS),
  onShow: (box, dots) => {
    if (fitNext && follower.kind === 'whole') view.fit(box);
    if (follower.kind === 'whole') fitNext = false;
    scene.show(mesh, box, dots);
    applyStyle();
    refreshSoon();
  },
  onChange: (changes) => {
    if (changes !== null) scene.update(changes);
    refreshSoon();
  },
  onDropped: (name) => {
    say(`${name} has been dropped`);
    overlay.clear();
    list('pointer', {});
    requestDraw();
    refreshSets();
  },
});

function fillSelect(select, names, chosen) {
  const now = [...select.options].map((o) => o.value).join('\n');
  if (now !== names.join('\n')) select.replaceChildren(...names.map((name) => new Option(name === '' ? 'none' : name, name)));
  select.value = chosen ?? '';
}

/** The field to be shown of a set: the one that is chosen, or the first. */
async function chosenField(set) {
  const { rows } = await connection.request(`FIELDS ${set}`);
  const fields = rows.map((row) => row.split(' ')).map(([name, , min, max]) => ({ name, min: Number(min), max: Number(max) }));
  const wanted = $('field').dataset.set === set ? $('field').value : fields[0]?.name;
  const field = fields.find(({ name }) => name === wanted) ?? null;
  $('field').dataset.set = set;
  fillSelect($('field'), ['', ...fields.map(({ name }) => name)], field?.name);
  return field;
}

let fitNext = false; // the view is to show all of the next mesh

async function follow(set, { keepView = false } = {}) {
  say(`loading ${set} ...`);
  overlay.clear();
  fitNext = !keepView;
  try {
    await follower.follow(set, () => chosenField(set));
    if (fitNext) await acts.fit();
  } catch (error) {
    if (follower.set === set) follower.set = null; // refreshSets tries again
    if (error.code === 'LOST' && !connection.isLost) say(`the replies about ${set} were lost; trying again ...`);
    throw error;
  }
  fitNext = false;
  if (follower.kind === 'whole') say('');
  refreshSoon();
}

const refreshSets = latest(async () => {
  const { rows } = await connection.request('SETS');
  const names = rows.map((row) => row.slice(0, row.indexOf(' ')));
  if (!names.includes(follower.set)) follower.set = null;
  if (follower.set === null && names.length > 0) {
    const wanted = [$('set').value, given('set'), names[0]];
    await follow(wanted.find((name) => names.includes(name)));
  }
  if (names.length === 0) say('the daemon has no sets yet');
  fillSelect($('set'), names, follower.set);
});

/** Brings what is shown up to date with the set and the view, as far as events do not. */
const refresh = latest(async () => {
  const { set, kind } = follower;
  if (set === null || follower.isLoading || connection.isLost) return;
  const { keys } = await connection.request(`STAT ${set}`);
  totals = keys;
  if (keys.triangulated !== 'yes') {
    say(`${set} is not triangulated`);
    return;
  }
  const isDone = await follower.look();
  const missing = await overlay.refresh(fetchAll, set, view, layersOf(keys));
  const isRead = Date.now() - refusedAt >= REFUSAL_MS;
  if (isRead) say([follower.kind === 'sample' ? 'a sample of the triangles; zoom in to see all' : '', missing].filter(Boolean).join('; '));
  requestDraw();
  if (!isDone || kind !== follower.kind) refreshSoon();
});

function layersOf({ hull }) {
  const { kind, field } = follower;
  const [x0, y0, x1, y1] = view.box();
  let points = 0;
  for (let k = 0; k < 2 * mesh.ids; k += 2) {
    if (mesh.xy[k] >= x0 && mesh.xy[k] <= x1 && mesh.xy[k + 1] >= y0 && mesh.xy[k + 1] <= y1) points++;
  }
  return {
    field,
    points: kind === 'sample' ? Infinity : points,
    hull: Number(hull),
    isLarge: kind !== 'whole',
    mesh: kind === 'box' ? mesh : null,
  };
}

let refreshTimer = 0;
function refreshSoon() {
  if (refreshTimer !== 0) return;
  refreshTimer = setTimeout(() => {
    refreshTimer = 0;
    refresh();
  }, REFRESH_MS);
}

/* ---- what hands do ---- */

function pointNear(px, py, pixels) {
  if (follower.kind === 'sample') return null;
  const [x, y] = view.toPlane(px, py);
  let [best, nearest] = [(pixels / view.scale) ** 2, null];
  for (let id = 0; id < mesh.ids; id++) {
    const d = (mesh.xy[2 * id] - x) ** 2 + (mesh.xy[2 * id + 1] - y) ** 2;
    if (d <= best) [best, nearest] = [d, id];
  }
  return nearest === null ? null : mesh.idOf(nearest);
}

const moveLatest = latest((id, x, y) => connection.request(`MOVE ${follower.set} ${id} ${x} ${y}`));

const lookLatest = latest(async (px, py) => {
  const { set, kind } = follower;
  if (kind === null || mesh.triangles === 0) return;
  const [x, y] = view.toPlane(px, py);
  const [near, where] = await Promise.all([
    connection.request(`NEAREST ${set} ${x} ${y}`),
    connection.request(`LOCATE ${set} ${x} ${y}`),
  ]);
  const [id, nx, ny] = near.rows[0].split(' ').map(Number);
  const corners = where.keys.where === 'inside' ? where.rows[0].split(' ').map(Number) : null;
  const numbers = corners?.map((id) => mesh.numberOf(id));
  const triangle = numbers?.every((n) => mesh.hasPoint(n)) ? numbers.map((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]) : null;
  overlay.mark = { place: [nx, ny], triangle };
  list('pointer', { x: x.toPrecision(8), y: y.toPrecision(8), nearest: id, triangle: corners?.join(' ') ?? where.keys.where });
  requestDraw();
});

const moved = () => {
  requestDraw();
  refreshSoon();
};

const acts = {
  pan: (dx, dy) => {
    view.pan(dx, dy);
    moved();
  },
  zoom: (factor, px, py) => {
    view.zoom(factor, px, py);
    moved();
  },
  fit: async () => {
    if (follower.set === null) return;
    view.fit(await follower.around());
    moved();
  },
  pointNear,
  move: (id, px, py) => moveLatest(id, ...view.toPlane(px, py)),
  add: (px, py) => {
    if (follower.set !== null) connection.request(`ADD ${follower.set} ${view.toPlane(px, py).join(' ')}`).catch(report);
  },
  remove: (id) => connection.request(`DEL ${follower.set} ${id}`).catch(report),
  hover: (px, py) => lookLatest(px, py),
  theme: () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'),
};

function report(error) {
  if (error.code === 'LOST') return;
  say(error.message);
  refusedAt = Date.now();
  setTimeout(refreshSoon, REFUSAL_MS);
}

/* ---- start ---- */

async function enter() {
  try {
    if (given('token') !== null) await connection.request(`AUTH ${given('token')}`);
    await connection.request('SETS');
    access = 'given';
  } catch (error) {
    if (error.code === 'LOST' || NOT_NOW.includes(error.code)) throw error;
    access = 'refused';
    throw new Error(`${error.message}; the address should end with #token=TOKEN, or &token=TOKEN`, { cause: error });
  }
}

/** Continues to follow the set, if it still exists. */
async function resume() {
  try {
    await follower.resume();
  } catch (error) {
    if (error.code !== 'NOSET') throw error;
    Object.assign(follower, { set: null, kind: null });
  }
}

async function start() {
  const url = new URL('daemon', location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  let reason = 'the connection is lost';
  connection = new Connection(url, {
    onEvent: (event) => follower.onEvent(event),
    onEnd: () => {
      if (access === 'refused') return;
      say(`${reason}; trying again ...`);
      setTimeout(start, RETRY_MS);
    },
  });
  try {
    await connection.opened;
    await enter();
    await resume();
    refreshSoon();
    await refreshSets();
  } catch (error) {
    if (error.code === 'LOST' || access === 'refused') {
      report(error);
    } else {
      reason = error.message;
      connection.close();
    }
  }
}

function listen() {
  const hands = new Hands(canvas.overlay, acts);
  $('set').addEventListener('change', () => follow($('set').value).catch(report));
  $('field').addEventListener('change', () => follow(follower.set, { keepView: true }).catch(report));
  for (const id of ['triangles', 'coloured']) $(id).addEventListener('change', applyStyle);
  for (const layer of ['hull', 'cells', 'contours']) {
    $(layer).addEventListener('change', () => {
      overlay.layers[layer] = $(layer).checked;
      requestDraw();
      refreshSoon();
    });
  }
  for (const input of document.querySelectorAll('input[name=tool]')) {
    input.addEventListener('change', () => {
      hands.tool = input.value;
    });
  }
  $('fit').addEventListener('click', acts.fit);
  $('theme').addEventListener('click', acts.theme);
  new ResizeObserver(resize).observe(canvas.mesh.parentElement);
  setInterval(() => {
    showFacts(follower.events);
    follower.events = 0;
  }, 1000);
  setInterval(() => access === 'given' && refreshSets(), SETS_MS);
  setInterval(showWaits, 1000);
  addEventListener('hashchange', () => location.reload());
}

setTheme(localStorage.getItem('theme') ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
resize();
listen();
start();
export { follower, mesh, scene, view }; // for tests
