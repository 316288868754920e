// A set of which the page mirrors a part, in a real browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { ask, makeSet, onPage, open, settled, start, stop, until } from './stage.mjs';

before(start);
after(stop);

const PARTS = '&most=2000'; // the page mirrors sets of at most so many points whole, and parts of at most so many triangles

const kind = (page) => page.evaluate(() => window.app.follower.kind);
const message = (page) => page.evaluate(() => document.getElementById('message').textContent);

/** Zooms by the wheel at a place of the plane, until the page mirrors a box. */
async function zoomTo(page, x, y) {
  await page.mouse.move(...(await onPage(page, x, y)));
  await until(async () => {
    if ((await kind(page)) !== 'box') await page.mouse.wheel({ deltaY: -200 });
    return page.evaluate(() => window.app.follower.kind === 'box' && window.app.mesh.triangles > 0);
  });
  await page.waitForFunction(() => document.getElementById('message').textContent === '');
}

/** The triangles and points of the mesh, by ids. */
const known = (page) =>
  page.evaluate(() => {
    const { mesh, view } = window.app;
    const points = new Map();
    for (let n = 0; n < mesh.ids; n++) if (mesh.hasPoint(n)) points.set(mesh.idOf(n), [mesh.xy[2 * n], mesh.xy[2 * n + 1]]);
    const triangles = [];
    for (let slot = 0; slot < mesh.slots; slot++) {
      const c = [...mesh.corners.subarray(3 * slot, 3 * slot + 3)].map((n) => mesh.idOf(n));
      if (c[0] === c[1]) continue;
      while (c[0] > c[1] || c[0] > c[2]) c.push(c.shift());
      triangles.push(c.join(' '));
    }
    return { points: [...points], triangles: triangles.sort(), view: view.box() };
  });

/** Compares the mesh with the set: its points are those of a box around the view, its triangles all those between them. */
async function checkPart(page, set) {
  await settled(page, set);
  const { points, triangles, view } = await known(page);
  const [x0, y0, x1, y1] = view;
  const ids = new Set(points.map(([id]) => String(id)));
  const places = new Map((await ask(`POINTS ${set}`)).slice(1).map((row) => [row.split(' ')[0], row.split(' ').slice(1).map(Number)]));
  for (const [id, place] of points) assert.deepEqual(place, places.get(String(id)));
  for (const [id, [x, y]] of places) if (x >= x0 && x <= x1 && y >= y0 && y <= y1) assert.ok(ids.has(id), `point ${id} is in view`);
  const stored = (await ask(`TRIANGLES ${set}`)).slice(1).filter((row) => row.split(' ').every((id) => ids.has(id)));
  assert.deepEqual(triangles, stored.sort());
  assert.deepEqual(page.faults, []);
}

/** Returns how many pixels of a canvas in the box of the screen are drawn, and of how many. */
const drawn = (page, id) =>
  page.evaluate(async (name) => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const canvas = document.getElementById(name);
    const context = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    let n = 0;
    for (let i = 3; i < data.length; i += 4) if (data[i] > 0) n++;
    return n / (canvas.width * canvas.height);
  }, id);

test('a large set is shown as a sample, and exactly where one zooms in, with all edits', async () => {
  await makeSet('large', 40000);
  const page = await open('large', undefined, PARTS);
  await page.waitForFunction(() => window.app.follower.kind === 'sample');
  await until(async () => /sample/.test(await message(page)));
  await until(async () => /points40,000triangles79,9/.test(await page.evaluate(() => document.getElementById('facts').textContent)));
  const share = await page.evaluate(() => window.app.view.scale ** 2 / (window.app.view.width * window.app.view.height));
  assert.ok((await drawn(page, 'mesh')) > 0.9 * share, 'the sample covers the set');
  const holes = await page.evaluate(() => {
    const [x0, y1] = window.app.view.toScreen(0.03, 0.03).map(Math.round);
    const [x1, y0] = window.app.view.toScreen(0.97, 0.97).map(Math.round);
    const context = new OffscreenCanvas(x1 - x0, y1 - y0).getContext('2d');
    context.drawImage(document.getElementById('mesh'), -x0, -y0);
    const { data } = context.getImageData(0, 0, x1 - x0, y1 - y0);
    return data.filter((value, i) => i % 4 === 3 && value === 0).length / (data.length / 4);
  });
  assert.ok(holes < 0.01, `${holes} of the pixels are holes`);
  await zoomTo(page, 0.3, 0.6);
  await checkPart(page, 'large');
  let state = 11;
  const next = (n) => (state = (state * 48271) % 2147483647) % n;
  const [x0, y0, x1, y1] = (await known(page)).view;
  for (let round = 0; round < 5; round++) {
    const edits = Array.from({ length: 30 }, () => {
      const place = `${x0 + ((x1 - x0) * next(1000)) / 800} ${y0 + ((y1 - y0) * next(1000)) / 800}`;
      return [`ADD large ${place}`, `MOVE large ${next(40000)} ${place}`, `DEL large ${40000 + next(30)}`][next(3)];
    });
    await ask(...edits);
    await checkPart(page, 'large');
  }
  await page.close();
});

test('a point is dragged in a part of a large set', async () => {
  await makeSet('dragged', 40000);
  const page = await open('dragged', undefined, PARTS);
  await zoomTo(page, 0.5, 0.5);
  const { points, view } = await known(page);
  const [x, y] = [(view[0] + view[2]) / 2, (view[1] + view[3]) / 2];
  const far = ([, [px, py]]) => Math.hypot(px - x, py - y);
  const [id, place] = points.reduce((a, b) => (far(b) < far(a) ? b : a));
  await page.click('#edit');
  await page.mouse.move(...(await onPage(page, ...place)));
  await page.mouse.down();
  const to = [x + (view[2] - view[0]) / 5, y];
  await page.mouse.move(...(await onPage(page, ...to)), { steps: 10 });
  await page.mouse.up();
  await until(async () => {
    const [px, py] = (await ask(`GET dragged ${id}`))[1].split(' ').slice(1).map(Number);
    return Math.hypot(px - to[0], py - to[1]) < 0.01 * (view[2] - view[0]);
  });
  await checkPart(page, 'dragged');
  await page.close();
});

test('a sample follows the set, and so does what reaches out of a part', async () => {
  await makeSet('two', 20000); // in the unit square, and some far to the right of it
  const rows = (await ask('POINTS two')).slice(1, 501).map((row) => row.split(' ').map(Number));
  await ask(`ADD two ${rows.map(([, x, y]) => `${x + 9} ${y}`).join(' ')}`);
  const page = await open('two', undefined, PARTS);
  await page.click('#hull');
  await page.evaluate(() => document.getElementById('fit').click());
  await page.waitForFunction(() => window.app.follower.kind === 'sample');
  const before = await page.evaluate(() => window.app.mesh.version);
  await ask('ADD two 5 0.5');
  await until(() => page.evaluate((v) => window.app.mesh.version > v && window.app.follower.kind === 'sample', before));
  await until(async () => (await known(page)).points.some(([, [x, y]]) => x === 5 && y === 0.5));
  await page.mouse.move(...(await onPage(page, 5, 0.5)));
  for (let k = 0; k < 4; k++) await page.mouse.wheel({ deltaY: -400 });
  await page.waitForFunction(() => window.app.follower.kind === 'box' && window.app.mesh.points === 1 && window.app.mesh.triangles === 0);
  await until(async () => (await drawn(page, 'overlay')) > 0.002);
  await ask('DEL two 20500');
  await until(async () => (await known(page)).points.length === 0);
  assert.deepEqual(page.faults, []);
  await page.close();
});


test('a large set that is not triangulated yet is shown when it is', async () => {
  await makeSet('some', 2500);
  const places = (await ask('POINTS some')).slice(1).map((row) => row.split(' ').slice(1).join(' '));
  await ask(...[0, 1000, 2000].map((i) => `ADD later ${places.slice(i, i + 1000).join(' ')}`));
  const page = await open('some', undefined, PARTS);
  await page.waitForSelector('#set option[value=later]');
  await page.select('#set', 'later');
  await page.waitForFunction(() => /later has .* is not triangulated/.test(document.getElementById('notice').textContent));
  await ask('TRIANGULATE later');
  await page.waitForFunction(() => window.app.follower.kind === 'sample' && /sample/.test(document.getElementById('message').textContent));
  assert.deepEqual(page.faults, []);
  await page.close();
});
