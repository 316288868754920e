// Actions of mouse, touch and keyboard: the map moves or zooms; a point is looked at, dragged, added or deleted; edits are undone.
import { keep, viewText } from './address.js';
import { edits } from './edits.js';
import { switchTheme } from './layers.js';
import { point } from './others.js';
import { $, report, showCard } from './panel.js';
import { look, lookAgain, nearest } from './pick.js';
import { first } from './sets.js';
import { fit, follower, on, refreshSoon } from './shown.js';
import { draw, mesh, view } from './stage.js';

const CLOSE = 12; // pixels from a point that count as on it
const STILL = 4; // pixels that a click may move
const KEY_PAN = 60;
const KEY_ZOOM = 1.4;
const REST_MS = 300; // that the view stands still before the address has it and the card is shown again

const map = $('map');
const fingers = new Map(); // pointer -> [px, py]
let tool = 'look'; // or, to edit: 'move', 'add', 'delete'
let isDragging = false; // a point
let began = null; // where the only finger went down
let pointed = null; // where the pointer is on the map; null: it is elsewhere, and keys mean the middle of the map
let restTimer = 0;

on({
  onSet: (set) => {
    edits.begin(set);
    point(set, null);
    lookAgain();
  },
  onChange: lookAgain,
});

// ---- the map ----

function moved() {
  showCard(null, view);
  draw();
  refreshSoon();
  clearTimeout(restTimer);
  restTimer = setTimeout(() => {
    lookAgain();
    if (follower.set !== null) keep({ set: follower.set, view: viewText(view) });
  }, REST_MS);
}

function pan(dx, dy) {
  view.pan(dx, dy);
  moved();
}

function zoom(factor, px, py) {
  view.zoom(factor, px, py);
  moved();
}

const showAll = () => fit().then(moved, report);

/** Shows what is at a pixel, also to others; null: nothing. */
function showAt(at) {
  look(at);
  point(follower.set, at === null ? null : view.toPlane(...at));
}

/** The pointer is at a pixel, or null: it has left the map. */
function hover(at) {
  pointed = at;
  showAt(at);
}

// ---- edits ----

const chosenTool = () => document.querySelector('input[name=tool]:checked').value;
const switchEditing = () => setTool(tool === 'look' ? chosenTool() : 'look');

function setTool(name) {
  tool = name;
  $('edit').setAttribute('aria-pressed', String(tool !== 'look'));
  $('tools').hidden = tool === 'look';
}

first.start = () => setTool('move');

/** The number of the point that a pixel means, or null. */
const pointAt = (at) => (follower.kind === 'sample' ? null : nearest(...at, CLOSE));

const add = (at) => edits.add(view.toPlane(...at));

function remove(at) {
  const number = pointAt(at);
  if (number !== null) edits.remove(mesh.idOf(number));
}

function drop() {
  isDragging = false;
  edits.drop();
}

// ---- mouse and touch ----

const placeOf = (e) => [e.offsetX, e.offsetY];

function down(e) {
  const at = placeOf(e);
  map.setPointerCapture(e.pointerId);
  fingers.set(e.pointerId, at);
  pointed = at;
  began = fingers.size === 1 ? at : null;
  if (isDragging) drop(); // a second finger
  if (began === null || tool !== 'move' || e.button !== 0) return; // only the first button of a mouse drags points
  const number = pointAt(at);
  if (number === null) return;
  isDragging = true;
  edits.grab(mesh.idOf(number), [...mesh.xy.subarray(2 * number, 2 * number + 2)]);
}

function move(e) {
  const at = placeOf(e);
  const before = fingers.get(e.pointerId);
  if (before === undefined) return hover(at);
  const [one, two] = [...fingers.values()];
  fingers.set(e.pointerId, at);
  pointed = at;
  if (two !== undefined) {
    const still = before === one ? two : one;
    zoom(Math.hypot(at[0] - still[0], at[1] - still[1]) / Math.max(1, Math.hypot(before[0] - still[0], before[1] - still[1])), ...still);
  } else if (isDragging) {
    hover(at);
    edits.drag(view.toPlane(...at));
  } else {
    pan(at[0] - before[0], at[1] - before[1]);
  }
}

function up(e) {
  const at = fingers.get(e.pointerId);
  fingers.delete(e.pointerId);
  const isClick = e.type === 'pointerup' && began !== null && at !== undefined && Math.hypot(at[0] - began[0], at[1] - began[1]) < STILL;
  if (isClick && tool === 'add') add(at);
  if (isClick && tool === 'delete') remove(at);
  if (isDragging) drop();
  began = null;
}

// ---- keyboard ----

function key(e) {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  const at = pointed ?? [map.clientWidth / 2, map.clientHeight / 2];
  const keys = {
    ArrowLeft: () => pan(KEY_PAN, 0),
    ArrowRight: () => pan(-KEY_PAN, 0),
    ArrowUp: () => pan(0, KEY_PAN),
    ArrowDown: () => pan(0, -KEY_PAN),
    '+': () => zoom(KEY_ZOOM, ...at),
    '=': () => zoom(KEY_ZOOM, ...at),
    '-': () => zoom(1 / KEY_ZOOM, ...at),
    0: showAll,
    e: switchEditing,
    a: () => tool !== 'look' && add(at),
    Delete: () => tool !== 'look' && remove(at),
    t: switchTheme,
  };
  const act = keys[e.key] ?? keys[e.key.toLowerCase()];
  if (act === undefined) return;
  e.preventDefault();
  act();
  if (pointed === null) showAt(at);
}

/** Listens to the map, and to the buttons and keys of the page that edit or move. */
export function listen() {
  const onMap = {
    pointerdown: down,
    pointermove: move,
    pointerup: up,
    pointercancel: up,
    pointerleave: () => fingers.size === 0 && hover(null),
    dblclick: (e) => {
      if (tool === 'move') add(placeOf(e));
      else if (tool === 'look') zoom(2, ...placeOf(e));
    },
    wheel: (e) => {
      e.preventDefault();
      zoom(Math.exp(-e.deltaY * (e.deltaMode === 0 ? 0.0015 : 0.05)), ...placeOf(e));
    },
    contextmenu: (e) => e.preventDefault(),
    keydown: key,
  };
  for (const [kind, act] of Object.entries(onMap)) map.addEventListener(kind, act, { passive: false });
  $('tools').addEventListener('change', () => setTool(chosenTool()));
  for (const [button, act] of Object.entries({ edit: switchEditing, undo: () => edits.undo(), redo: () => edits.redo(), fit: showAll, theme: switchTheme })) {
    $(button).addEventListener('click', act);
  }
  addEventListener('keydown', (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || e.key.toLowerCase() !== 'z') return;
    e.preventDefault();
    if (e.shiftKey) edits.redo();
    else edits.undo();
  });
}
