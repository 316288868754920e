// The parts of the page share the copy of the set, the part of the plane that is shown, and the canvases. The canvases are drawn when
// something has changed. While the map moves, the browser moves the canvases with it; they are drawn for the new view as often as there
// is time for it.
import { Marks } from './drawing/marks.js';
import { Mesh } from './data/mesh.js';
import { Overlay } from './drawing/overlay.js';
import { $, say } from './panel.js';
import { Scene } from './drawing/scene.js';
import { View } from './drawing/view.js';

const REST = 6; // how much longer the canvases are only moved than drawing them took

export const canvas = { mesh: $('mesh'), overlay: $('overlay') };
export const mesh = new Mesh();
export const view = new View();
export const overlay = new Overlay(canvas.overlay);
export const marks = new Marks($('marks'));
export const scene = newScene();

let shown = { set: null, kind: null };
let drawn = view.copy(); // the view that the canvases show
let rested = 0; // the time from which on they may be drawn for another one
let isRequested = false;
let timer = 0;

function newScene() {
  try {
    return new Scene(canvas.mesh, () => draw());
  } catch (error) {
    say(error.message);
    throw error;
  }
}

/** The page shows what a Follower has from now on, or anything with its set and kind. While its kind is null its triangles stay on the screen. */
export function show(follower) {
  shown = follower;
}

/** Draws what has changed in the next frame. */
export function draw() {
  if (isRequested) return;
  isRequested = true;
  requestAnimationFrame(frame);
}

function frame() {
  isRequested = false;
  const began = performance.now();
  const isNew = !view.equals(drawn) && (began >= rested || scene.isStale);
  if (isNew) drawn = view.copy();
  drawCanvases();
  if (isNew) rested = performance.now() + REST * (performance.now() - began);
  const transform = view.equals(drawn) ? '' : view.transformOf(drawn);
  for (const { style } of Object.values(canvas)) style.transform = transform;
  marks.draw(view);
  clearTimeout(timer);
  if (transform !== '') timer = setTimeout(draw, rested - performance.now());
}

function drawCanvases() {
  if (shown.set === null) scene.clear();
  else if (shown.kind !== null) scene.draw(drawn);
  overlay.draw(drawn, shown.kind === null ? null : mesh);
}

/** Draws the canvases for the view as it is now, at once. */
export function drawNow() {
  drawn = view.copy();
  drawCanvases();
  draw();
}

/** Fits the canvases to the window. */
export function resize() {
  const { clientWidth, clientHeight } = canvas.mesh.parentElement;
  view.resize(clientWidth, clientHeight);
  for (const c of Object.values(canvas)) {
    c.width = Math.max(1, Math.round(clientWidth * devicePixelRatio));
    c.height = Math.max(1, Math.round(clientHeight * devicePixelRatio));
  }
  overlay.stale();
  scene.stale();
}
