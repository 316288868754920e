// The page in a real browser, beside the daemon: what it draws, what it knows, and that two of them see the same.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { sequence } from './rough.mjs';
import { ask, browser, closePages, drag, drawnShare, isAt, killGateway, known, listen, makeSet, onPage, open, pagePort, picture, placeOf, says, settled, start, stop, until, visit, waitFor } from './stage.mjs';

before(start);
afterEach(closePages);
after(stop);

async function stored(set) {
  const [points, triangles] = await Promise.all([ask(`POINTS ${set}`), ask(`TRIANGLES ${set}`)]);
  return {
    points: points.slice(1).map((row) => row.split(' ').map(Number)),
    triangles: triangles.slice(1).sort(),
  };
}

async function checkEqual(page, set) {
  await settled(page, set);
  const expected = await stored(set);
  assert.deepEqual(await known(page), expected);
  assert.deepEqual(await page.evaluate(() => [window.app.mesh.points, window.app.mesh.triangles]), [expected.points.length, expected.triangles.length]);
}

/** Counts the pixels of two pictures that differ by more than rounding. */
function different({ data: a }, { data: b }) {
  assert.equal(a.length, b.length);
  let n = 0;
  for (let i = 0; i < a.length; i += 4) {
    if ([0, 1, 2, 3].some((k) => Math.abs(a[i + k] - b[i + k]) > 8)) n++;
  }
  return n;
}

test('the page has a WebGL 2 context', async () => {
  const page = await browser.newPage();
  assert.match(await page.evaluate(() => document.createElement('canvas').getContext('webgl2')?.getParameter(0x1f02) ?? 'none'), /WebGL 2/);
  await page.close();
});

test('the gateway passes requests of its own pages on, and refuses those of others', async () => {
  await makeSet('posted', 10);
  const post = (origin) => fetch(`http://127.0.0.1:${pagePort}/daemon`, { method: 'POST', headers: { origin }, body: 'GET posted 3\nPING\n' });
  const own = await post(`http://127.0.0.1:${pagePort}`);
  assert.deepEqual([own.status, (await own.text()).split('\n')], [200, [...(await ask('GET posted 3')), 'OK 0', '']]);
  const other = await post('http://elsewhere.example');
  assert.deepEqual([other.status, /posted|OK/.test(await other.text())], [403, false]);
});

test('the page knows what the daemon has, and draws its triangles', async () => {
  await makeSet('drawn', 60);
  const page = await open('drawn');
  await checkEqual(page, 'drawn');
  const { width, height, data: drawn } = await picture(page, 'mesh');
  const { points, triangles } = await known(page);
  const places = await page.evaluate((all) => all.map(([, x, y]) => window.app.view.toScreen(x, y)), points);
  const path = triangles.map((ids) => `M${ids.split(' ').map((id) => places[id].join(' ')).join('L')}z`).join('');
  const reader = await browser.newPage();
  await reader.setViewport({ width, height });
  await reader.setContent(`<body style="margin: 0"><svg width="${width}" height="${height}"><path d="${path}" fill="none" stroke="black"/></svg>`);
  const { data: lines } = PNG.sync.read(Buffer.from(await reader.screenshot()));
  await reader.close();
  const isNear = (isSet, i) => [-1, 0, 1].some((dy) => [-1, 0, 1].some((dx) => isSet(i + dy * width + dx)));
  const isLine = (i) => lines[4 * i] < 195;
  const found = { lines: 0, missing: 0, drawn: 0, wrong: 0 };
  for (let i = 0; i < width * height; i++) {
    if (lines[4 * i] < 95) {
      found.lines++;
      if (!isNear((k) => drawn[4 * k + 3] > 40, i)) found.missing++;
    }
    if (drawn[4 * i + 3] > 120) {
      found.drawn++;
      if (!isNear(isLine, i)) found.wrong++;
    }
  }
  assert.ok(found.lines > 2000 && found.drawn > 2000, JSON.stringify(found));
  assert.ok(found.missing < 0.01 * found.lines && found.wrong < 0.01 * found.drawn, JSON.stringify(found));
});

test('a set of huge or tiny coordinates is drawn as the same set in units is, and its address keeps the view', async () => {
  await makeSet('units', 60);
  const places = (await ask('POINTS units')).slice(1).map((row) => row.split(' ').slice(1).map(Number));
  const pictures = [];
  for (const power of [0, 190, -100]) {
    await ask(`ADD scaled${power} ${places.flat().map((v) => v * 2 ** power).join(' ')}`, `TRIANGULATE scaled${power}`);
    const page = await open(`scaled${power}`);
    pictures.push(await picture(page, 'mesh'));
    await page.focus('#map');
    await page.keyboard.press('+');
    await until(() => page.url().includes('view='));
    const other = await visit(new URL(page.url()).hash);
    await waitFor(other, () => window.app.mesh.points === 60);
    const [a, b] = await Promise.all([page, other].map((p) => p.evaluate(() => ({ ...window.app.view }))));
    assert.ok(['x', 'y'].every((k) => Math.abs(a[k] - b[k]) * a.scale < 1) && Math.abs(a.scale / b.scale - 1) < 1e-5, JSON.stringify([a, b]));
    for (const p of [page, other]) await p.close();
  }
  for (const scaled of pictures.slice(1)) assert.ok(different(pictures[0], scaled) < 100);
});

test('many triangles for each pixel are drawn everywhere', async () => {
  await makeSet('dense', 100000);
  const page = await open('dense', { width: 400, height: 100 });
  assert.ok((await drawnShare(page, ['mesh'], [0.02, 0.02], [0.98, 0.98])) > 0.9);
});

test('large triangles among many small ones are drawn', async () => {
  await makeSet('sites', 400);
  const towns = (await ask('POINTS sites')).slice(1).map((row) => row.split(' ').slice(1).map(Number));
  const around = ([x, y], i) => Array.from({ length: 200 }, (_, k) => `${x + ((k * 31 + i) % 199) * 1e-5} ${y + ((k * 17 + i) % 197) * 1e-5}`);
  await ask(...towns.map((town, i) => `ADD towns ${around(town, i).join(' ')}`), 'TRIANGULATE towns');
  const page = await open('towns');
  const share = await drawnShare(page, ['mesh'], [0.1, 0.1], [0.9, 0.9]);
  assert.ok(share > 0.97, `${share} is drawn`);
});

test('a point dragged on one page moves on the other, and both draw what a new page draws', async () => {
  await makeSet('shared', 300);
  const [one, two] = [await open('shared'), await open('shared')];
  await one.click('#edit');
  const before = await picture(two, 'mesh');
  const counts = () => two.evaluate(() => window.app.scene.counts);
  const { whole } = await counts();
  await drag(one, await onPage(one, ...(await placeOf('shared', 17))), await onPage(one, 0.5, 0.5));
  await isAt('shared', 17, [0.5, 0.5]);
  await checkEqual(one, 'shared');
  await checkEqual(two, 'shared');
  const after = await picture(two, 'mesh');
  assert.ok(different(before, after) > 100);
  assert.equal(different(await picture(one, 'mesh'), after), 0);
  const fresh = await open('shared');
  assert.ok(different(await picture(fresh, 'mesh'), after) <= 40, 'parts that were drawn again differ from the whole');
  const now = await counts();
  assert.ok(now.part > 0 && now.triangles < 200 * now.part, `${now.part} parts, ${now.triangles} triangles of them`);
  assert.ok(now.whole <= whole + 1, `${now.whole - whole} whole pictures`);
});

test('points are added and deleted by mouse, keyboard and touch', async () => {
  await makeSet('hands', 100);
  const page = await open('hands');
  await page.click('#edit');
  const has = (n) => until(async () => (await ask('STAT hands'))[0].includes(` points=${n} `));
  await page.mouse.click(...(await onPage(page, 0.31, 0.33)), { count: 2 });
  await has(101);
  await page.mouse.move(...(await onPage(page, 0.7, 0.2)));
  await page.focus('#map');
  await page.keyboard.press('a');
  await has(102);
  await settled(page, 'hands');
  await page.keyboard.press('Delete');
  await has(101);
  await page.click('input[value=add]');
  await page.touchscreen.tap(...(await onPage(page, 0.42, 0.61)));
  await has(102);
  await checkEqual(page, 'hands');
});

test('where points are everywhere, the map is moved by the right button, or when nothing is edited', async () => {
  await makeSet('crowd', 20000);
  const page = await open('crowd');
  await page.click('#edit');
  const centre = () => page.evaluate(() => window.app.view.x);
  const version = async () => /version=(\d+)/.exec((await ask('STAT crowd'))[0])[1];
  const before = await version();
  const [from, to] = [await onPage(page, 0.5, 0.5), await onPage(page, 0.6, 0.5)];
  await page.mouse.move(...from);
  await page.mouse.down({ button: 'right' });
  await page.mouse.move(...to, { steps: 3 });
  await page.mouse.up({ button: 'right' });
  assert.ok(Math.abs((await centre()) - 0.4) < 0.01, 'right button');
  await page.click('#edit');
  await drag(page, to, from);
  assert.ok(Math.abs((await centre()) - 0.5) < 0.01, 'nothing is edited');
  assert.equal(await version(), before);
});

test('a page without WebGL says so', async () => {
  const page = await browser.newPage();
  await page.evaluateOnNewDocument(() => {
    HTMLCanvasElement.prototype.getContext = () => null;
  });
  await page.goto(`http://127.0.0.1:${pagePort}/`);
  await page.waitForFunction(() => document.getElementById('message').textContent === 'this browser has no WebGL 2');
  await page.close();
});

test('a page that has lost its connection catches up', async () => {
  await makeSet('lost', 200);
  const page = await open('lost');
  killGateway();
  await says(page, 'message', 'lost');
  await ask('MOVE lost 3 0.111 0.222', 'DEL lost 5', 'ADD lost 0.9 0.05');
  await listen();
  await checkEqual(page, 'lost');
});

test('the page follows random edits of all kinds', async () => {
  await makeSet('edited', 150);
  const page = await open('edited');
  const random = sequence(7);
  const next = (n) => Math.floor(n * random());
  for (let round = 0; round < 12; round++) {
    const edits = Array.from({ length: 25 }, () => {
      const place = `${next(1000) / 1000} ${next(1000) / 1000}`;
      return [`ADD edited ${place}`, `MOVE edited ${next(150)} ${place}`, `DEL edited ${next(400)}`][next(3)];
    });
    await ask(...edits);
    await checkEqual(page, 'edited');
  }
  await ask('DROP edited');
  await says(page, 'notice', 'edited has been dropped');
});

test('values of a field come with events: of points that move, of new ones, of those whose value changes, and after a rebuild', async () => {
  await makeSet('valued', 200);
  await ask(...Array.from({ length: 200 }, (_, id) => `FSET valued z ${id} ${id / 2}`));
  const page = await open('valued');
  const values = () => page.evaluate(() => [...window.app.mesh.values.subarray(0, window.app.mesh.ids)].map((v) => (Number.isNaN(v) ? null : v)));
  const stored = async () => (await ask('POINTS valued FIELDS z')).slice(1).map((row) => JSON.parse(row.split(' ')[3].replace('nan', 'null')));
  await ask('MOVE valued 7 0.4 0.4', 'ADD valued FIELDS z 0.5 0.41 77', 'ADD valued 0.6 0.41');
  await settled(page, 'valued');
  await page.waitForFunction(() => window.app.mesh.values[200] === 77);
  assert.deepEqual(await values(), await stored());
  await ask('FSET valued z 8 -3 9 nan');
  await page.waitForFunction(() => window.app.mesh.values[8] === -3);
  assert.deepEqual(await values(), await stored());
  killGateway();
  await says(page, 'message', 'lost');
  await ask('FSET valued z 9 -4');
  await listen();
  await page.waitForFunction(() => window.app.mesh.values[9] === -4);
  await ask('FSET valued z 10 -5');
  await page.waitForFunction(() => window.app.mesh.values[10] === -5);
  assert.deepEqual(await values(), await stored());
  await ask('TRIANGULATE valued METHOD shelling');
  await checkEqual(page, 'valued');
  await page.waitForFunction(() => window.app.mesh.values[200] === 77);
  assert.deepEqual(await values(), await stored());
});
