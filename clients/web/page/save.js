// The picture that is shown, saved as a file.
import { canvas, drawNow, mesh, overlay, scene, view } from './stage.js';
import { make } from './panel.js';
import { SvgContext, drawTriangles } from './drawing/svg.js';

function save(blob, name) {
  const href = URL.createObjectURL(blob);
  make('a', { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 10000);
}

const ground = () => getComputedStyle(document.body).backgroundColor;

export async function savePNG(name) {
  drawNow();
  const { width, height } = canvas.mesh;
  const picture = new OffscreenCanvas(width, height);
  const context = picture.getContext('2d');
  context.fillStyle = ground();
  context.fillRect(0, 0, width, height);
  for (const layer of [canvas.mesh, canvas.overlay]) context.drawImage(layer, 0, 0);
  save(await picture.convertToBlob(), `${name}.png`);
}

export function saveSVG(name) {
  const context = new SvgContext(view, ground());
  drawTriangles(context, view, mesh, scene.style);
  overlay.paint(context, view, mesh);
  save(new Blob([String(context)], { type: 'image/svg+xml' }), `${name}.svg`);
}
