// A set of which the page mirrors a part, in a real browser.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { sequence } from './rough.mjs';
import { ask, closePages, drawnShare, isAt, known, makeSet, onPage, open, says, settled, start, stop, until } from './stage.mjs';

before(start);
afterEach(closePages);
after(stop);

const PARTS = '&most=2000'; // the page mirrors sets of at most so many points whole, and parts of at most so many triangles

const kind = (page) => page.evaluate(() => window.app.follower.kind);
const viewOf = (page) => page.evaluate(() => window.app.view.box());

/** Zooms by the wheel at a place of the plane, until the page mirrors a box. */
async function zoomTo(page, x, y) {
  await page.mouse.move(...(await onPage(page, x, y)));
  await until(async () => {
    if ((await kind(page)) !== 'box') await page.mouse.wheel({ deltaY: -200 });
    return page.evaluate(() => window.app.follower.kind === 'box' && window.app.mesh.triangles > 0);
  });
  await says(page, 'message', '');
}

/** Compares the mesh with the set: its points are those of a box around the view, its triangles all those between them. */
async function checkPart(page, set) {
  await settled(page, set);
  const { points, triangles } = await known(page);
  const [x0, y0, x1, y1] = await viewOf(page);
  const ids = new Set(points.map(([id]) => String(id)));
  const places = new Map((await ask(`POINTS ${set}`)).slice(1).map((row) => [row.split(' ')[0], row.split(' ').slice(1).map(Number)]));
  for (const [id, ...place] of points) assert.deepEqual(place, places.get(String(id)));
  for (const [id, [x, y]] of places) if (x >= x0 && x <= x1 && y >= y0 && y <= y1) assert.ok(ids.has(id), `point ${id} is in view`);
  const stored = (await ask(`TRIANGLES ${set}`)).slice(1).filter((row) => row.split(' ').every((id) => ids.has(id)));
  assert.deepEqual(triangles, stored.sort());
}

test('a large set is shown as a sample, and exactly where one zooms in, with all edits', async () => {
  await makeSet('large', 40000);
  const page = await open('large', undefined, PARTS);
  await page.waitForFunction(() => window.app.follower.kind === 'sample');
  await says(page, 'message', 'sample');
  await until(async () => /points40,000triangles79,9/.test(await page.evaluate(() => document.getElementById('facts').textContent)));
  const share = await page.evaluate(() => window.app.view.scale ** 2 / (window.app.view.width * window.app.view.height));
  assert.ok((await drawnShare(page, ['mesh'])) > 0.9 * share, 'the sample covers the set');
  const holes = 1 - (await drawnShare(page, ['mesh'], [0.03, 0.03], [0.97, 0.97]));
  assert.ok(holes < 0.01, `${holes} of the pixels are holes`);
  const margin = 4 / (await page.evaluate(() => window.app.view.scale));
  assert.equal(await drawnShare(page, ['mesh'], [-0.1, 0.1], [-margin, 0.9]), 0, 'no pixel beyond the hull by 4');
  await zoomTo(page, 0.3, 0.6);
  await checkPart(page, 'large');
  const random = sequence(11);
  const next = (n) => Math.floor(n * random());
  const [x0, y0, x1, y1] = await viewOf(page);
  for (let round = 0; round < 5; round++) {
    const edits = Array.from({ length: 30 }, () => {
      const place = `${x0 + ((x1 - x0) * next(1000)) / 800} ${y0 + ((y1 - y0) * next(1000)) / 800}`;
      return [`ADD large ${place}`, `MOVE large ${next(40000)} ${place}`, `DEL large ${40000 + next(30)}`][next(3)];
    });
    await ask(...edits);
    await checkPart(page, 'large');
  }
});

test('a point is dragged in a part of a large set', async () => {
  await makeSet('dragged', 40000);
  const page = await open('dragged', undefined, PARTS);
  await zoomTo(page, 0.5, 0.5);
  const { points } = await known(page);
  const view = await viewOf(page);
  const [x, y] = [(view[0] + view[2]) / 2, (view[1] + view[3]) / 2];
  const far = ([, px, py]) => Math.hypot(px - x, py - y);
  const [id, ...place] = points.reduce((a, b) => (far(b) < far(a) ? b : a));
  await page.click('#edit');
  await page.mouse.move(...(await onPage(page, ...place)));
  await page.mouse.down();
  const to = [x + (view[2] - view[0]) / 5, y];
  await page.mouse.move(...(await onPage(page, ...to)), { steps: 10 });
  await page.mouse.up();
  await isAt('dragged', id, to, 0.01 * (view[2] - view[0]));
  await checkPart(page, 'dragged');
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
  await until(async () => (await known(page)).points.some(([, x, y]) => x === 5 && y === 0.5));
  await page.mouse.move(...(await onPage(page, 5, 0.5)));
  for (let k = 0; k < 4; k++) await page.mouse.wheel({ deltaY: -400 });
  await page.waitForFunction(() => window.app.follower.kind === 'box' && window.app.mesh.points === 1 && window.app.mesh.triangles === 0);
  await until(async () => (await drawnShare(page, ['overlay'])) > 0.002);
  await ask('DEL two 20500');
  await until(async () => (await known(page)).points.length === 0);
});

test('a large set that is not triangulated yet is shown when it is', async () => {
  await makeSet('some', 2500);
  const places = (await ask('POINTS some')).slice(1).map((row) => row.split(' ').slice(1).join(' '));
  await ask(...[0, 1000, 2000].map((i) => `ADD later ${places.slice(i, i + 1000).join(' ')}`));
  const page = await open('some', undefined, PARTS);
  await page.waitForSelector('#set option[value=later]');
  await page.select('#set', 'later');
  await says(page, 'notice', 'later has 2,500 points and is not triangulated');
  await ask('TRIANGULATE later');
  await page.waitForFunction(() => window.app.follower.kind === 'sample' && /sample/.test(document.getElementById('message').textContent));
});
