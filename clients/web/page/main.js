// The page: follows one set of the daemon and shows it. Start reading here; follow.js decides what of the set is shown, mesh.js has the
// copy of it, scene.js the drawing.
import { given, givenView, keep, viewText } from './address.js';
import { showAngles } from './angles.js';
import { Connection, countWaits, fetchReplies } from './connection.js';
import { Edits } from './edits.js';
import { parse } from './files.js';
import { Follower } from './follow.js';
import { Hands } from './hands.js';
import { Local } from './local.js';
import { Mesh } from './mesh.js';
import { Others } from './others.js';
import { THEMES as LINES, Overlay, stepOf } from './overlay.js';
import { explain, fillSelect, list, say, showCard, showLegend, showWait } from './panel.js';
import { Pick } from './pick.js';
import { Scene } from './scene.js';
import { SvgContext, drawTriangles, viridis } from './svg.js';
import { View } from './view.js';

const MOST_POINTS = 4e6; // of a set that is mirrored whole; `most` in the address
const RETRY_MS = 1000;
const REFRESH_MS = 400; // layers of the overlay are asked for so long after the last change
const REFUSAL_MS = 4000; // that the message about a refused request stays
const SETS_MS = 3000;
const FIRST = 'ireland'; // the set that is shown if the address names none
const SMALL = 3000; // points of a set whose layers are asked for at every change
const STEEP = 0.04; // the height of the hillshade's ground, in sizes of the set
const KEEP_MS = 300; // that the view stands still before the address has it
const NOT_NOW = ['LOADING', 'BUSY', 'NOMEM', 'TIMEOUT']; // errors of a daemon that may answer later

const $ = (id) => document.getElementById(id);
const canvas = { mesh: $('mesh'), overlay: $('overlay') };

const mesh = new Mesh();
const view = new View();
const overlay = new Overlay(canvas.overlay);
const scene = newScene();
const isLocal = document.documentElement.dataset.source === 'local'; // the sets are in this page: a site of static files
let connection = null; // or a Local
let access = 'unknown'; // to the daemon; 'given' or 'refused'
let refusedAt = 0; // when a request was refused last
let totals = null; // STAT of the set
let wanted = null; // the name of the set that is to be shown, whether it exists or not
let sizeOfSet = 1; // the longer side of the box around it
const loadedNames = new Map(); // set -> names, of files that were opened on this page
let question = null; // that is being asked
let isFirst = false; // nobody has done anything yet: the hint stays
let dropped = null; // the name of a set that was dropped while it was shown

/** Sets that come with the page: a title, the file, and whether its names are shown. */
const SAMPLES = {
  ireland: { title: 'Towns of Ireland', file: 'ireland.csv', hasNames: true, unit: 'km' },
  cities: { title: 'Cities of the world', file: 'cities.xy', unit: 'degrees' },
  terrain: { title: 'A terrain', file: 'terrain.xyz', unit: 'm' },
};

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
    overlay.draw(view, follower.kind === null ? null : mesh);
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
  refreshSoon();
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
    relief: field !== null && $('hillshade').checked ? (STEEP * sizeOfSet) / (field.max - field.min || 1) : 0,
    bands: field !== null && $('bands').checked ? stepOf(field) : 0,
  });
  if (scene.style.coloured) scene.style.edge = [0, 0, 0, 0.3];
  showLegend(scene.style.coloured ? field : null);
  if (!$('triangles').checked) scene.style.fill = [0, 0, 0, 0];
  overlay.colours = LINES[document.documentElement.dataset.theme];
  overlay.stale();
  scene.stale();
}

const dark = matchMedia('(prefers-color-scheme: dark)');

/** Shows the theme that the address or an earlier choice names, or else that of the system. */
function showTheme() {
  const name = given('theme') ?? localStorage.getItem('theme') ?? (dark.matches ? 'dark' : 'light');
  document.documentElement.dataset.theme = name === 'dark' ? 'dark' : 'light';
  applyStyle();
}

function chooseTheme(name) {
  localStorage.setItem('theme', name);
  keep({ theme: name });
  showTheme();
}

const LAYERS = ['triangles', 'hull', 'cells', 'points', 'names', 'coloured', 'hillshade', 'bands', 'contours'];
const chosenLayers = () => LAYERS.filter((layer) => $(layer).checked);

/** Shows the layers of the address, or those that are chosen on the page. */
function beginLayers() {
  const layers = given('layers')?.split(',');
  for (const layer of LAYERS) {
    if (layers !== undefined) $(layer).checked = layers.includes(layer);
    $(layer).addEventListener('change', () => {
      keep({ layers: chosenLayers().join(',') });
      showLayers();
    });
  }
  showLayers();
}

function showLayers() {
  for (const layer of Object.keys(overlay.layers)) overlay.layers[layer] = $(layer).checked;
  applyStyle();
  refreshSoon();
}

/* ---- texts ---- */

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

/* ---- files ---- */

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const ground = () => getComputedStyle(document.body).backgroundColor;

async function savePNG() {
  if (follower.set === null) return;
  const { width, height } = canvas.mesh;
  const picture = new OffscreenCanvas(width, height);
  const context = picture.getContext('2d');
  context.fillStyle = ground();
  context.fillRect(0, 0, width, height);
  for (const layer of [canvas.mesh, canvas.overlay]) context.drawImage(layer, 0, 0);
  save(await picture.convertToBlob(), `${follower.set}.png`);
}

function saveSVG() {
  if (follower.set === null) return;
  const context = new SvgContext(view, ground());
  const { coloured, edged, edge, range } = scene.style;
  const colourOf = (value) => (coloured && !Number.isNaN(value) ? viridis((value - range[0]) / (range[1] - range[0] || 1)) : null);
  const [red, green, blue] = edge.map((v) => Math.round(255 * v));
  drawTriangles(context, view, mesh, colourOf, edged ? `rgb(${red} ${green} ${blue} / ${edge[3] / 2})` : null);
  overlay.paint(context, view, mesh);
  save(new Blob([String(context)], { type: 'image/svg+xml' }), `${follower.set}.svg`);
}

/** Reads a file of points into a new set: at once if the sets are in this page, otherwise after a question. */
async function openFile(file) {
  try {
    const points = parse(file.name, await file.text());
    const { rows } = await connection.request('SETS');
    const taken = new Set(rows.map((row) => row.split(' ')[0]));
    const stem = file.name.replace(/\.[^.]*$/, '').replace(/[^A-Za-z0-9_]/g, '_').slice(0, 40) || 'file';
    let name = stem;
    for (let k = 2; taken.has(name); k++) name = `${stem}_${k}`;
    if (isLocal) {
      connection.load(name, points);
      showLoaded(name, points);
      return;
    }
    const count = new Intl.NumberFormat().format(points.xy.length / 2);
    question = `Load ${count} points of ${file.name} into the new set ${name} of the server?`;
    const done = (act) => () => {
      question = null;
      explain('');
      act();
    };
    explain(question, [['Load', done(() => upload(name, points).catch(report))], ['Cancel', done(() => refreshSoon())]]);
  } catch (error) {
    report(new Error(`${file.name}: ${error.message}`));
  }
}

async function upload(name, points) {
  const { xy, values, field } = points;
  const n = xy.length / 2;
  const rows = values === null ? xy : Float64Array.from({ length: 3 * n }, (_, k) => (k % 3 === 2 ? values[(k - 2) / 3] : xy[2 * ((k / 3) | 0) + (k % 3)]));
  await fetchAll([[`LOADB ${name} ${n}${values === null ? '' : ` FIELDS ${field}`}`, new Uint8Array(rows.buffer)]]);
  await connection.request(`TRIANGULATE ${name}`);
  showLoaded(name, points);
}

function showLoaded(name, { names }) {
  loadedNames.set(name, names);
  choose(name);
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
  if (isLocal) return connection.fetchAll(requests);
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
    edits.begin(follower.set);
    others?.point(follower.set, null);
    if (fitNext && follower.kind === 'whole') view.fit(box);
    if (follower.kind === 'whole') fitNext = false;
    if (follower.kind === 'whole') sizeOfSet = Math.max(box[2] - box[0], box[3] - box[1]);
    scene.show(mesh, box, dots);
    applyStyle();
    refreshSoon();
  },
  onChange: (changes) => {
    if (changes !== null) scene.update(changes);
    pick.again();
    refreshSoon();
  },
  onDropped: (name) => {
    dropped = name;
    clear();
    refreshSets();
  },
});

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

/** Nothing is left of the set that was shown. */
function clear() {
  overlay.clear();
  edits.begin(null);
  pick.again();
  requestDraw();
}

let fitNext = false; // the view is to show all of the next mesh

async function follow(set, { keepView = false } = {}) {
  say(`loading ${set} ...`);
  overlay.clear();
  const kept = !keepView && [set, null].includes(given('set')) ? givenView() : null;
  if (kept !== null) Object.assign(view, kept);
  fitNext = !keepView && kept === null;
  try {
    await follower.follow(set, () => chosenField(set));
    if (fitNext) await acts.fit();
  } catch (error) {
    if (follower.set === set) {
      Object.assign(follower, { set: null, kind: null }); // refreshSets tries again
      clear();
    }
    if (error.code === 'LOST' && !connection.isLost) say(`the replies about ${set} were lost; trying again ...`);
    throw error;
  }
  fitNext = false;
  if (follower.kind === 'whole') say('');
  if (!keepView) await showNames(set).catch(report);
  refreshSoon();
}

const refreshSets = latest(async () => {
  const { rows } = await connection.request('SETS');
  const names = rows.map((row) => row.slice(0, row.indexOf(' ')));
  if (wanted === null && given('set') === null && names.includes(FIRST)) beginFirst();
  wanted ??= given('set') ?? names[0] ?? null;
  if (!names.includes(follower.set) && follower.set !== null) {
    Object.assign(follower, { set: null, kind: null });
    clear();
  }
  if (follower.set === null && names.includes(wanted)) await follow(wanted);
  fillSelect($('set'), names, follower.set);
  showSamples(names);
  if (follower.set === null) explainMissing(names);
});

/** Buttons for the sets that come with the page, if it has them. */
function showSamples(names) {
  const shown = Object.keys(SAMPLES).filter((name) => names.includes(name));
  if ($('samples').children.length !== shown.length) {
    $('samples').replaceChildren(
      ...shown.map((name) => {
        const button = document.createElement('button');
        button.textContent = SAMPLES[name].title;
        button.value = name;
        button.addEventListener('click', () => choose(name));
        return button;
      }),
    );
  }
  for (const button of $('samples').children) button.setAttribute('aria-pressed', String(button.value === follower.set));
}

/** Shows the names of the points of a set that comes with the page, if the points are still mostly those of its file. */
async function showNames(set) {
  overlay.names = new Map();
  if (loadedNames.has(set)) overlay.names = loadedNames.get(set);
  overlay.unit = SAMPLES[set]?.unit ?? '';
  if (!SAMPLES[set]?.hasNames) return;
  const { names, xy } = parse(SAMPLES[set].file, await (await fetch(SAMPLES[set].file)).text());
  if (follower.set !== set) return;
  let same = 0;
  for (let k = 0; k < xy.length; k += 2) if (mesh.xy[k] === xy[k] && mesh.xy[k + 1] === xy[k + 1]) same++;
  if (same > xy.length / 4) overlay.names = names;
  overlay.stale();
  requestDraw();
}

/** The first view: towns that can be dragged at once. */
function beginFirst() {
  wanted = FIRST;
  if (given('layers') === null) Object.entries({ cells: true, hull: false }).forEach(([layer, on]) => ($(layer).checked = on));
  showLayers();
  setTool('move');
  isFirst = true;
}

function explainMissing(names) {
  if (question !== null) return;
  say('');
  const choices = names.map((name) => [name, () => choose(name)]);
  const next = names.length === 0 ? 'The daemon has no sets yet.' : 'Choose another set:';
  if (wanted === null) explain(next);
  else explain(`The set ${wanted} ${wanted === dropped ? 'has been dropped' : 'does not exist'}. ${next}`, choices);
}

function choose(name) {
  wanted = name;
  isFirst = false;
  keep({ set: name, view: null });
  return follow(name).catch(report);
}

/** Explains why there are no triangles, if there are none. */
function explainSet({ points, triangulated }) {
  const { set } = follower;
  if (question !== null) return;
  if (triangulated !== 'yes' && points > 0) {
    const act = () => connection.request(`TRIANGULATE ${set}`).then(refresh, report);
    explain(`${set} has ${new Intl.NumberFormat().format(points)} points and is not triangulated.`, [['Triangulate', act]]);
  } else if (Number(points) === 0) {
    explain(`${set} is empty. Choose Edit, then double-click on the map to add a point.`);
  } else {
    explain(isFirst ? 'Drag a town.' : '');
  }
}

/** Shows the angles of the set as it is now, if somebody wants to see them. */
async function refreshAngles(set) {
  if (!$('angles').open) return;
  const reply = await connection.request(`QUALITY ${set}`);
  if (set === follower.set) showAngles($('angles'), reply);
}

/** Brings what is shown up to date with the set and the view, as far as events do not. */
const refresh = latest(async () => {
  const { set, kind } = follower;
  if (set === null || follower.isLoading || connection.isLost) return;
  const { keys } = await connection.request(`STAT ${set}`);
  totals = keys;
  if (set !== follower.set) return;
  explainSet(keys);
  if (keys.triangulated !== 'yes') return;
  const isDone = await follower.look();
  const missing = await overlay.refresh(fetchAll, set, view, layersOf(keys));
  const isRead = Date.now() - refusedAt >= REFUSAL_MS;
  if (isRead) say([follower.kind === 'sample' ? 'a sample of the triangles; zoom in to see all' : '', missing].filter(Boolean).join('; '));
  requestDraw();
  await refreshAngles(set);
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
  const isSmall = follower.kind === 'whole' && mesh.points <= SMALL;
  refreshTimer = setTimeout(
    () => {
      refreshTimer = 0;
      refresh();
    },
    isSmall ? 0 : REFRESH_MS,
  );
}

/* ---- what hands do ---- */

const edits = new Edits({
  request: (line) => connection.request(line),
  onChange: () => {
    if (edits.canUndo && isFirst) {
      isFirst = false;
      explain('');
    }
    $('undo').disabled = !edits.canUndo;
    $('redo').disabled = !edits.canRedo;
  },
  onRenamed: (before, id) => {
    if (!overlay.names.has(before)) return;
    overlay.names.set(id, overlay.names.get(before));
    overlay.names.delete(before);
  },
  onError: (error) => report(error),
});

const pick = new Pick({
  mesh,
  view,
  state: () => follower,
  request: (line) => connection.request(line),
  nameOf: (id) => overlay.names.get(id),
  onPick: (found) => {
    overlay.mark = found;
    showCard(found, view);
    requestDraw();
  },
});

function setTool(tool) {
  hands.tool = tool;
  $('edit').setAttribute('aria-pressed', String(tool !== 'look'));
  $('tools').hidden = tool === 'look';
}

const chosenTool = () => document.querySelector('input[name=tool]:checked').value;

let keepTimer = 0;
const moved = () => {
  requestDraw();
  pick.again();
  clearTimeout(keepTimer);
  keepTimer = setTimeout(() => follower.set !== null && keep({ set: follower.set, view: viewText(view) }), KEEP_MS);
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
  pointNear: (px, py, pixels) => {
    const number = follower.kind === 'sample' ? null : pick.near(px, py, pixels);
    return number === null ? null : mesh.idOf(number);
  },
  grab: (id) => edits.grab(id, [...mesh.xy.subarray(2 * mesh.numberOf(id), 2 * mesh.numberOf(id) + 2)]),
  drag: (px, py) => edits.drag(view.toPlane(px, py)),
  drop: () => edits.drop(),
  add: (px, py) => edits.add(view.toPlane(px, py)),
  remove: (id) => edits.remove(id),
  hover: (at) => {
    pick.look(at);
    others?.point(follower.set, at === null ? null : view.toPlane(...at));
  },
  edit: () => setTool(hands.tool === 'look' ? chosenTool() : 'look'),
  theme: () => chooseTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'),
};

const others = isLocal
  ? null
  : new Others(socketURL('pointers'), () => {
      overlay.pointers = others.places;
      overlay.stale();
      requestDraw();
    });

const hands = new Hands(canvas.overlay, acts);

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

/** The address of a WebSocket of the gateway. */
function socketURL(name) {
  const url = new URL(name, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  url.hash = '';
  return url;
}

function connect(handlers) {
  if (isLocal) return new Local(Object.fromEntries(Object.entries(SAMPLES).map(([name, { file }]) => [name, file])), handlers);
  return new Connection(socketURL('daemon'), handlers);
}

async function start() {
  let reason = 'the connection is lost';
  connection = connect({
    onEvent: (event) => follower.onEvent(event),
    onEnd: () => {
      if (access === 'refused') return;
      say(`${reason}; trying again ...`);
      setTimeout(start, RETRY_MS);
    },
  });
  try {
    await connection.opened;
    if (isLocal) access = 'given';
    else await enter();
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
  $('set').addEventListener('change', () => choose($('set').value));
  $('field').addEventListener('change', () => follow(follower.set, { keepView: true }).catch(report));
  $('tools').addEventListener('change', () => setTool(chosenTool()));
  $('edit').addEventListener('click', acts.edit);
  $('undo').addEventListener('click', () => edits.undo());
  $('redo').addEventListener('click', () => edits.redo());
  addEventListener('keydown', (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || e.key.toLowerCase() !== 'z') return;
    e.preventDefault();
    if (e.shiftKey) edits.redo();
    else edits.undo();
  });
  $('fit').addEventListener('click', acts.fit);
  $('angles').addEventListener('toggle', refreshSoon);
  $('png').addEventListener('click', savePNG);
  $('svg').addEventListener('click', saveSVG);
  $('file').addEventListener('change', () => $('file').files.length > 0 && openFile($('file').files[0]));
  addEventListener('dragover', (e) => e.preventDefault());
  addEventListener('drop', (e) => {
    e.preventDefault();
    if (e.dataTransfer.files.length > 0) openFile(e.dataTransfer.files[0]);
  });
  $('sheet').addEventListener('click', () => {
    const isOpen = document.body.classList.toggle('closed') === false;
    $('sheet').textContent = isOpen ? 'Hide' : 'Show';
    $('sheet').setAttribute('aria-expanded', String(isOpen));
  });
  $('theme').addEventListener('click', acts.theme);
  dark.addEventListener('change', showTheme);
  new ResizeObserver(resize).observe(canvas.mesh.parentElement);
  setInterval(() => {
    showFacts(follower.events);
    follower.events = 0;
  }, 1000);
  setInterval(() => access === 'given' && refreshSets(), SETS_MS);
  setInterval(() => showWait(countWaits(), scene.isLost ? 'waiting for WebGL' : ''), 1000);
  addEventListener('hashchange', () => location.reload());
}

beginLayers();
showTheme();
resize();
listen();
start();
const current = () => connection;
export { current as connection, edits, follower, mesh, overlay, scene, view }; // for tests
