// Tests compare screenshots of the first view by regions: on a desk and on a phone, light and dark.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { serveFolder } from './folder.mjs';
import { screenshotOf } from './regions.mjs';
import { closePages, start, stop, visit, waitFor } from './stage.mjs';

let server;

before(async () => {
  await start();
  server = await serveFolder(process.env.SITE);
});
afterEach(closePages);
after(async () => {
  server.close();
  await stop();
});

const SIZES = { desk: { width: 1280, height: 800 }, phone: { width: 390, height: 844, isMobile: true, hasTouch: true } };

for (const [name, size] of Object.entries(SIZES)) {
  for (const theme of ['light', 'dark']) {
    test(`the first view on a ${name} in ${theme} colours: soft cells, lines, names that can be read, a plain panel`, async () => {
      const page = await visit(`#theme=${theme}`, { at: server.port, size });
      await waitFor(page, () => window.app.mesh.points === 485 && window.app.overlay.labels.length > 10 && window.app.overlay.lines.cells.length > 400);
      await waitFor(page, () => /points/.test(document.getElementById('facts').textContent)); // the panel is as high as it will be
      const places = await page.evaluate(async () => {
        await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
        const { mesh, overlay, view } = window.app;
        const at = (x, y) => view.toScreen(x, y);
        const [x, y] = at(-10, 0); // about the middle of Ireland
        const { left, top, width } = document.querySelector('aside').getBoundingClientRect();
        const isSeen = (px, py) => document.elementFromPoint(px, py)?.id === 'map'; // nothing covers it
        const seen = overlay.labels.filter(([x0, y0, x1, y1]) => isSeen(x0, y0) && isSeen(x1, y0) && isSeen(x0, y1) && isSeen(x1, y1));
        const labels = seen.slice(0, 5).map(([x0, y0, x1, y1]) => [x0, y0, x1 - x0, y1 - y0]);
        const [red, green, blue] = getComputedStyle(document.querySelector('aside')).backgroundColor.match(/\d+/g).map(Number);
        const west = Math.min(...Array.from({ length: mesh.ids }, (_, n) => mesh.xy[2 * n]));
        return { middle: [x - 50, y - 50, 100, 100], sea: [4, at(west, 0)[1] + 3, 12, 12], labels, panel: [left + width / 2, top + 3, 8, 3], colour: [red, green, blue] };
      });
      const { regionOf } = await screenshotOf(page);
      const [sea, middle, panel] = [places.sea, places.middle, places.panel].map(regionOf);
      const isLight = theme === 'light';
      assert.ok(isLight ? sea.mean > 190 : sea.mean < 110, `the sea: ${JSON.stringify(sea)}`);
      assert.ok(sea.deviation < 12, `the sea has one soft colour: ${JSON.stringify(sea)}`);
      assert.ok(middle.deviation > 12 && Math.abs(middle.mean - sea.mean) < 70, `cells, lines and points: ${JSON.stringify(middle)}`);
      assert.equal(places.labels.length, 5);
      for (const label of places.labels.map(regionOf)) assert.ok(label.contrast > 140, `a name can be read: ${JSON.stringify(label)}`);
      for (const k of [0, 1, 2]) assert.ok(Math.abs(panel.colour[k] - places.colour[k]) <= 2, `the panel: ${JSON.stringify(panel)}`);
      await page.close();
    });
  }
}
