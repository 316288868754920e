// The page: follows one set of the daemon and shows it. Start reading here; mesh.js has the copy of the set, scene.js the drawing.
import { Connection, fetchReplies } from './connection.js';
import { Hands } from './hands.js';
import { Mesh } from './mesh.js';
import { Overlay } from './overlay.js';
import { Gathered } from './rings.js';
import { Scene } from './scene.js';
import { View } from './view.js';

const MOST_POINTS = 4e6; // of a set that the page shows
const RETRY_MS = 1000;
const REFRESH_MS = 400; // layers of the overlay are asked for so long after the last change
const SETS_MS = 3000;

const $ = (id) => document.getElementById(id);
const canvas = { mesh: $('mesh'), overlay: $('overlay') };

const mesh = new Mesh();
const view = new View();
const overlay = new Overlay(canvas.overlay);
const scene = new Scene(canvas.mesh, () => requestDraw());
let connection = null;
let set = null; // the name of the set that is followed
let field = null; // {name, min, max} that is shown
let box = [0, 0, 1, 1]; // around all points when they were loaded
let gathered = new Gathered(); // the event that is arriving in parts
let shown = false; // the mesh is that of `set`
let events = 0;

/** What the address says behind `#`: set=NAME, token=TOKEN. */
const given = (name) => new URLSearchParams(location.hash.slice(1)).get(name);

/* ---- drawing ---- */

let drawRequested = false;
function requestDraw() {
  if (drawRequested) return;
  drawRequested = true;
  requestAnimationFrame(() => {
    drawRequested = false;
    if (shown) scene.draw(view);
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
  $('message').textContent = text;
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
  const number = new Intl.NumberFormat();
  list('facts', {
    points: number.format(mesh.points),
    triangles: number.format(mesh.triangles),
    'events per second': number.format(perSecond),
    version: mesh.version,
  });
}

/* ---- the set ---- */

function boxOf({ xy, ids }) {
  const found = [Infinity, Infinity, -Infinity, -Infinity];
  for (let k = 0; k < 2 * ids; k += 2) {
    if (xy[k] < found[0]) found[0] = xy[k];
    if (xy[k] > found[2]) found[2] = xy[k];
    if (xy[k + 1] < found[1]) found[1] = xy[k + 1];
    if (xy[k + 1] > found[3]) found[3] = xy[k + 1];
  }
  return found[0] <= found[2] ? found : [0, 0, 1, 1];
}

function fillSelect(select, names, chosen) {
  const now = [...select.options].map((o) => o.value).join('\n');
  if (now !== names.join('\n')) select.replaceChildren(...names.map((name) => new Option(name === '' ? 'none' : name, name)));
  select.value = chosen ?? '';
}

async function chooseField(name) {
  const { rows } = await connection.request(`FIELDS ${name}`);
  const fields = rows.map((row) => row.split(' ')).map(([n, , min, max]) => ({ name: n, min: Number(min), max: Number(max) }));
  const wanted = $('field').dataset.set === name ? $('field').value : fields[0]?.name;
  field = fields.find((f) => f.name === wanted) ?? null;
  $('field').dataset.set = name;
  fillSelect($('field'), ['', ...fields.map((f) => f.name)], field?.name);
}

function show() {
  box = boxOf(mesh);
  scene.show(mesh, box);
  shown = true;
  applyStyle();
}

/** The replies to requests whose replies may be large. */
async function fetchAll(...lines) {
  const auth = given('token') === null ? [] : [`AUTH ${given('token')}`];
  const replies = await Promise.all(fetchReplies('daemon', [...auth, ...lines]));
  return replies.slice(auth.length);
}

/** Loads a set whole, and follows it from then on. */
async function follow(name, { keepView = false } = {}) {
  if (set !== null) await connection.request(`UNWATCH ${set}`).catch(() => {});
  set = name;
  gathered = new Gathered();
  say(`loading ${name} ...`);
  const { keys } = await connection.request(`STAT ${name}`);
  if (keys.points > MOST_POINTS) {
    shown = false;
    say(`${name} has more than ${MOST_POINTS} points`);
    return;
  }
  await chooseField(name);
  const fields = field === null ? '' : ` FIELDS ${field.name}`;
  const [points, triangles = { data: new Uint8Array(0) }] = await fetchAll(
    `POINTS ${name}${fields} BINARY`,
    ...(keys.triangulated === 'yes' ? [`TRIANGLES ${name} BINARY`] : []),
  );
  if (set !== name) return; // another one has been chosen meanwhile
  mesh.load(points.data, triangles.data, field !== null);
  mesh.version = Number(keys.version);
  show();
  if (!keepView) view.fit(box);
  overlay.clear();
  await connection.request(`WATCH ${name} SINCE ${mesh.version}${fields}`);
  say(keys.triangulated === 'yes' ? '' : `${name} is not triangulated`);
  showFacts();
  refreshSoon();
}

function onEvent(event) {
  if (event.set !== set) return;
  if (event.dropped) {
    shown = false;
    set = null;
    say(`${event.set} has been dropped`);
    refreshSets().catch(report);
    return;
  }
  events++;
  gathered.add(event);
  if (event.more) return;
  const complete = gathered;
  gathered = new Gathered();
  if (complete.reset) {
    mesh.loadEvent(complete, event.version);
    show();
  } else {
    scene.update(mesh.apply(complete, event.version));
  }
  refreshSoon();
}

async function refreshSets() {
  const { rows } = await connection.request('SETS');
  const names = rows.map((row) => row.slice(0, row.indexOf(' ')));
  if (set === null && names.length > 0) {
    const wanted = [$('set').value, given('set'), names[0]];
    await follow(wanted.find((name) => names.includes(name)));
  }
  if (names.length === 0) say('the daemon has no sets yet');
  fillSelect($('set'), names, set);
}

let refreshTimer = 0;
function refreshSoon() {
  clearTimeout(refreshTimer);
  refreshTimer = setTimeout(async () => {
    if (!shown || mesh.triangles === 0) return;
    try {
      say(await overlay.refresh(connection, set, view, { field, points: mesh.points, box }));
      requestDraw();
    } catch (error) {
      report(error);
    }
  }, REFRESH_MS);
}

/* ---- what hands do ---- */

function pointNear(px, py, pixels) {
  const [x, y] = view.toPlane(px, py);
  let [best, nearest] = [(pixels / view.scale) ** 2, null];
  for (let id = 0; id < mesh.ids; id++) {
    const d = (mesh.xy[2 * id] - x) ** 2 + (mesh.xy[2 * id + 1] - y) ** 2;
    if (d <= best) [best, nearest] = [d, id];
  }
  return nearest;
}

/** Sends the newest of the requests that fall due while one is on its way. */
function latest(send) {
  let [busy, next] = [false, null];
  return async function run(...words) {
    if (busy) {
      next = words;
      return;
    }
    busy = true;
    try {
      await send(...words);
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

const moveLatest = latest((id, x, y) => connection.request(`MOVE ${set} ${id} ${x} ${y}`));

const lookLatest = latest(async (px, py) => {
  if (!shown || mesh.triangles === 0) return;
  const [x, y] = view.toPlane(px, py);
  const [near, where] = await Promise.all([
    connection.request(`NEAREST ${set} ${x} ${y}`),
    connection.request(`LOCATE ${set} ${x} ${y}`),
  ]);
  const [id, nx, ny] = near.rows[0].split(' ').map(Number);
  const corners = where.keys.where === 'inside' ? where.rows[0].split(' ').map(Number) : null;
  const triangle = corners?.every((c) => mesh.hasPoint(c)) ? corners.map((c) => [mesh.xy[2 * c], mesh.xy[2 * c + 1]]) : null;
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
  fit: () => {
    box = boxOf(mesh);
    view.fit(box);
    moved();
  },
  pointNear,
  move: (id, px, py) => moveLatest(id, ...view.toPlane(px, py)),
  add: (px, py) => connection.request(`ADD ${set} ${view.toPlane(px, py).join(' ')}`).catch(report),
  remove: (id) => connection.request(`DEL ${set} ${id}`).catch(report),
  hover: (px, py) => lookLatest(px, py),
  theme: () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'),
};

function report(error) {
  if (error.code !== 'LOST') say(error.message);
}

/* ---- start ---- */

async function resume() {
  if (set !== null && shown) await connection.request(`WATCH ${set} SINCE ${mesh.version}`);
  say('');
}

async function start() {
  const url = new URL('daemon', location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  gathered = new Gathered();
  connection = new Connection(url, {
    onEvent,
    onEnd: () => {
      say('the connection is lost; trying again ...');
      setTimeout(start, RETRY_MS);
    },
  });
  try {
    await connection.opened;
    if (given('token') !== null) await connection.request(`AUTH ${given('token')}`);
    await resume().catch((error) => {
      if (error.code !== 'NOSET') throw error;
      set = null;
    });
    await refreshSets();
  } catch (error) {
    report(error);
  }
}

function listen() {
  const hands = new Hands(canvas.overlay, acts);
  $('set').addEventListener('change', () => follow($('set').value).catch(report));
  $('field').addEventListener('change', () => follow(set, { keepView: true }).catch(report));
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
    showFacts(events);
    events = 0;
  }, 1000);
  setInterval(() => refreshSets().catch(report), SETS_MS);
}

setTheme(localStorage.getItem('theme') ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
resize();
listen();
start();
export { mesh, scene, view }; // for tests
