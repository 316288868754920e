// Mouse, touch and keyboard move the map, pick, drag, add and delete points, and undo edits.
import { given, keep, viewText } from './address.js';
import { isLocal, request, socketURL } from './daemon.js';
import { Edits } from './edits.js';
import { Hands } from './hands.js';
import { switchTheme } from './layers.js';
import { Others } from './others.js';
import { $, report, showCard } from './panel.js';
import { Pick } from './pick.js';
import { endHint, first } from './sets.js';
import { fit, follower, on, refreshSoon, rename } from './shown.js';
import { draw, marks, mesh, overlay, view } from './stage.js';

const REST_MS = 300; // that the view stands still before the address has it and the card is shown again

export const edits = new Edits({
  request,
  onChange: () => {
    if (edits.canUndo) endHint();
    $('undo').disabled = !edits.canUndo;
    $('redo').disabled = !edits.canRedo;
  },
  onRenamed: rename,
  onRefused: (line) => {
    marks.refused = line;
    draw();
  },
  onError: report,
});

const pick = new Pick({
  mesh,
  view,
  state: () => follower,
  request,
  nameOf: (id) => overlay.names.get(id),
  onPick: (found) => {
    marks.picked = found;
    showCard(found, view);
    draw();
  },
});

const others = isLocal
  ? null
  : new Others(socketURL('pointers'), given('token'), () => {
      marks.pointers = others.places;
      draw();
    });

on({
  onSet: (set) => {
    edits.begin(set);
    others?.point(set, null);
    pick.again();
  },
  onChange: () => pick.again(),
});

let restTimer = 0;
function moved() {
  showCard(null, view);
  draw();
  refreshSoon();
  clearTimeout(restTimer);
  restTimer = setTimeout(() => {
    pick.again();
    if (follower.set !== null) keep({ set: follower.set, view: viewText(view) });
  }, REST_MS);
}

const chosenTool = () => document.querySelector('input[name=tool]:checked').value;

function setTool(tool) {
  hands.tool = tool;
  $('edit').setAttribute('aria-pressed', String(tool !== 'look'));
  $('tools').hidden = tool === 'look';
}

const acts = {
  pan: (dx, dy) => {
    view.pan(dx, dy);
    moved();
  },
  zoom: (factor, px, py) => {
    view.zoom(factor, px, py);
    moved();
  },
  fit: () => fit().then(moved, report),
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
  theme: switchTheme,
};

const hands = new Hands($('map'), acts);

first.start = () => setTool('move');

/** Listens to the buttons and keys of the page that edit or move. */
export function listen() {
  $('tools').addEventListener('change', () => setTool(chosenTool()));
  for (const [button, act] of Object.entries({ edit: acts.edit, undo: () => edits.undo(), redo: () => edits.redo(), fit: acts.fit, theme: switchTheme })) {
    $(button).addEventListener('click', act);
  }
  addEventListener('keydown', (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || e.key.toLowerCase() !== 'z') return;
    e.preventDefault();
    if (e.shiftKey) edits.redo();
    else edits.undo();
  });
}
