// What the parts of the page share: the copy of the set, the part of the plane that is shown, and the canvases, which are drawn when
// something has changed.
import { Mesh } from './mesh.js';
import { Overlay } from './overlay.js';
import { $, say } from './panel.js';
import { Scene } from './scene.js';
import { View } from './view.js';

export const canvas = { mesh: $('mesh'), overlay: $('overlay') };

export const mesh = new Mesh();
export const view = new View();
export const overlay = new Overlay(canvas.overlay);
export const scene = newScene();

let shown = { set: null, kind: null };
let isRequested = false;

function newScene() {
  try {
    return new Scene(canvas.mesh, () => draw());
  } catch (error) {
    say(error.message);
    throw error;
  }
}

/** What is shown from now on: a Follower, or anything with its set and kind. While its kind is null its triangles stay on the screen. */
export function show(follower) {
  shown = follower;
}

/** Draws what has changed in the next frame. */
export function draw() {
  if (isRequested) return;
  isRequested = true;
  requestAnimationFrame(() => {
    isRequested = false;
    if (shown.set === null) scene.clear();
    else if (shown.kind !== null) scene.draw(view);
    overlay.draw(view, shown.kind === null ? null : mesh);
  });
}

/** Fits the canvases to the window. */
export function resize() {
  const { clientWidth, clientHeight } = canvas.mesh.parentElement;
  view.resize(clientWidth, clientHeight);
  for (const c of Object.values(canvas)) {
    c.width = Math.max(1, Math.round(clientWidth * devicePixelRatio));
    c.height = Math.max(1, Math.round(clientHeight * devicePixelRatio));
  }
  scene.stale();
}
