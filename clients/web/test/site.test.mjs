// The page from a folder of static files: its sets are in the page. And the first view that a visitor gets.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { serveFolder } from './folder.mjs';
import { closePages, drag, known, onPage, picture, says, start, stop, visit, waitFor } from './stage.mjs';

const { SITE } = process.env; // what `make site` has built
let server, at, folder;

before(async () => {
  await start();
  folder = mkdtempSync(join(tmpdir(), 'site-'));
  server = await serveFolder(SITE);
  at = server.port;
});
afterEach(closePages);
after(async () => {
  server.close();
  await stop();
  rmSync(folder, { recursive: true }); // not earlier: a page reads a file some time after it was chosen
});

/** The mesh has the triangles of all its points: rings sent by edits say the same as a triangulation of everything. */
async function checkWhole(page) {
  const { points, triangles } = await known(page);
  const corners = await page.evaluate((xy) => [...window.delaunayd.LiveSet.from(xy).triangulation().triangles], points.flatMap(([, x, y]) => [x, y]));
  const expected = [];
  while (corners.length > 0) {
    const c = corners.splice(-3).map((i) => points[i][0]);
    while (c[0] > c[1] || c[0] > c[2]) c.push(c.shift());
    expected.push(c.join(' '));
  }
  assert.deepEqual(triangles, expected.sort());
  assert.deepEqual(await page.evaluate(() => [window.app.mesh.points, window.app.mesh.triangles]), [points.length, triangles.length]);
}

const placeOf = (page, id) => page.evaluate((n) => [...window.app.mesh.xy.subarray(2 * n, 2 * n + 2)], id);

test('the first view has named towns, coloured cells and one hint; a drag on a town moves it, and undo takes it back', async () => {
  const page = await visit('', { at, size: { width: 1280, height: 800 } });
  await waitFor(page, () => window.app.mesh.points === 485 && window.app.overlay.labels.length > 40);
  await says(page, 'notice', 'Drag a town.');
  const home = await placeOf(page, 2);
  await page.mouse.move(...(await onPage(page, ...home)));
  await says(page, 'pointer', 'Cork');
  const to = await onPage(page, 20, 0);
  await drag(page, await onPage(page, ...home), to);
  await waitFor(page, () => Math.hypot(window.app.mesh.xy[4] - 20, window.app.mesh.xy[5]) < 1);
  await waitFor(page, () => document.getElementById('notice').hidden && /^Cork/.test(document.getElementById('pointer').innerText));
  await checkWhole(page);
  await page.click('#undo');
  await waitFor(page, (x) => window.app.mesh.xy[4] === x, {}, home[0]);
  await checkWhole(page);
});

test('names do not overlap, and where two would, the larger town has its name', async () => {
  const page = await visit('', { at, size: { width: 1280, height: 800 } });
  await waitFor(page, () => window.app.overlay.labels.length > 40);
  const boxes = await page.evaluate(() => window.app.overlay.labels);
  const overlap = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
  assert.deepEqual(boxes.filter((a, i) => boxes.some((b, k) => k < i && overlap(a, b))), []);
  const [dx, dy] = await page.evaluate(() => window.app.view.toScreen(...window.app.mesh.xy.subarray(0, 2)));
  assert.ok(Math.abs(boxes[0][0] - dx - 5) < 1 && boxes[0][1] < dy && dy < boxes[0][3], 'the first name is Dublin');
});

test('the edges of the hull are whole lines, also where the layer of the hull is off', async () => {
  const page = await visit('#set=ireland&layers=triangles&view=-120,40,12', { at, size: { width: 1280, height: 800 } });
  await waitFor(page, () => window.app.mesh.points === 485 && window.app.overlay.lines.hull.length > 0);
  const { width, height, data } = await picture(page, 'mesh', 'overlay');
  const hull = await page.evaluate(() => {
    const { overlay, view } = window.app;
    const [{ places }] = overlay.lines.hull;
    return Array.from({ length: places.length / 2 }, (_, k) => view.toScreen(places[2 * k], places[2 * k + 1]));
  });
  const near = [-1, 0, 1].flatMap((dy) => [-1, 0, 1].map((dx) => dy * width + dx));
  const alphas = []; // near each pixel of the hull in view, the largest one
  for (const [k, from] of hull.entries()) {
    const to = hull[(k + 1) % hull.length];
    const pixels = Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]));
    for (let i = 0; i <= pixels; i++) {
      const [x, y] = [0, 1].map((axis) => Math.round(from[axis] + (i / pixels) * (to[axis] - from[axis])));
      if (x < 1 || y < 1 || x > width - 2 || y > height - 2) continue;
      alphas.push(Math.max(...near.map((step) => data[4 * (y * width + x + step) + 3])));
    }
  }
  assert.ok(alphas.length > 500 && Math.min(...alphas) > 140, `${alphas.length} pixels, the faintest ${Math.min(...alphas)}`);
});

test('random edits in process give the mesh of all points, also with points in one place, on a line, and none', async () => {
  const page = await visit('#set=ireland', { at });
  await waitFor(page, () => window.app.mesh.points === 485);
  await page.evaluate(async () => {
    let state = 11;
    const next = (n) => (state = (state * 48271) % 2147483647) % n;
    const { connection } = window.app;
    for (let k = 0; k < 300; k++) {
      const place = `${next(20) * 15 - 150} ${next(20) * 15 - 150}`; // a lattice: many points on circles, some in one place
      const line = [`ADD ireland ${place}`, `MOVE ireland ${next(485)} ${place}`, `DEL ireland ${next(785)}`][next(3)];
      await connection().request(line).catch((error) => {
        if (error.code !== 'NOPOINT') throw error;
      });
    }
  });
  await checkWhole(page);
  await page.evaluate(async () => {
    const { connection, mesh } = window.app;
    for (let n = mesh.ids - 1; n >= 0; n--) if (mesh.hasPoint(n)) await connection().request(`DEL ireland ${n}`);
  });
  assert.deepEqual(await page.evaluate(() => [window.app.mesh.points, window.app.mesh.triangles]), [0, 0]);
  await says(page, 'notice', 'ireland is empty');
  await page.evaluate(async () => {
    for (const place of ['0 0', '1 1', '2 2', '2 2', '3 3', '0 3']) await window.app.connection().request(`ADD ireland ${place}`);
  });
  assert.deepEqual(await page.evaluate(() => [window.app.mesh.points, window.app.mesh.triangles]), [6, 3]);
});

test('the terrain and the cities are one click away', async () => {
  const page = await visit('', { at });
  await waitFor(page, () => window.app.mesh.points === 485);
  for (const [name, points] of [['terrain', 14976], ['cities', 171075]]) {
    await page.click(`#samples button[value=${name}]`);
    await waitFor(page, (n) => window.app.mesh.points === n && document.getElementById('notice').hidden, {}, points);
  }
  assert.match(page.url(), /set=cities/);
});

test('lines of a file become constraints, which a point cannot be dragged across: that is shown as refused', async () => {
  const page = await visit('', { at });
  await waitFor(page, () => window.app.mesh.points === 485);
  const feature = (type, coordinates) => ({ type: 'Feature', properties: {}, geometry: { type, coordinates } });
  const corners = feature('MultiPoint', [[0, 0], [4, 0], [4, 4], [0, 4]]);
  const features = [corners, feature('LineString', [[1, 2], [2, 2], [3, 2]]), feature('LineString', [[1, 1], [3, 1]])];
  writeFileSync(join(folder, 'fence.geojson'), JSON.stringify({ type: 'FeatureCollection', features }));
  await (await page.$('#file')).uploadFile(join(folder, 'fence.geojson'));
  await waitFor(page, () => window.app.mesh.points === 9 && window.app.overlay.lines.constraints.length === 3);
  await says(page, 'message', 'no Voronoi cells');
  const drag = async (from, to) => {
    await page.mouse.move(...(await onPage(page, ...from)));
    await page.mouse.down();
    await page.mouse.move(...(await onPage(page, ...to)));
  };
  const refused = (n) => waitFor(page, (k) => document.querySelectorAll('#marks polyline').length === k, {}, n);
  await drag([3, 1], [2, 3]);
  await refused(1);
  await says(page, 'message', 'cross');
  await page.mouse.up();
  await refused(0);
  assert.deepEqual(await placeOf(page, 8), [3, 1]);
  await drag([3, 1], [3.2, 1.6]);
  await page.mouse.up();
  await waitFor(page, () => Math.hypot(window.app.mesh.xy[16] - 3.2, window.app.mesh.xy[17] - 1.6) < 0.02);
  const stored = await page.evaluate(async () => [...new Uint32Array((await window.app.connection().request('TRIANGLES fence BINARY')).data.buffer)]);
  const sorted = (triangles) => triangles.map((ids) => ids.sort().join(' ')).sort();
  const { triangles } = await known(page);
  assert.deepEqual(sorted(triangles.map((ids) => ids.split(' ').map(Number))), sorted(Array.from({ length: stored.length / 3 }, (_, k) => stored.slice(3 * k, 3 * k + 3))));
});
