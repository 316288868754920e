// The page as people use it: what the address keeps, themes, phones, files, pictures to keep, and access for everybody.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { qualityOf } from '../page/angles.js';
import { ask, browser, closePages, drag, isAt, makeSet, onPage, open, picture, placeOf, press, says, start, stop, until, visit, waitFor } from './stage.mjs';

let folder;

before(async () => {
  await start();
  folder = mkdtempSync(join(tmpdir(), 'use-'));
  await makeSet('used', 60);
  await ask(...Array.from({ length: 60 }, (_, id) => `FSET used z ${id} ${id}`));
});
afterEach(closePages);
after(async () => {
  await stop();
  rmSync(folder, { recursive: true });
});

const themeOf = (page) => page.evaluate(() => document.documentElement.dataset.theme);
const system = (page, value) => page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value }]);

test('the address keeps the set, the view, the layers and the theme, and a page opened with it shows the same', async () => {
  const page = await open('used');
  await drag(page, [300, 300], [420, 260]);
  await page.click('#hull');
  await page.click('#contours');
  await page.click('#theme');
  const theme = await themeOf(page);
  const words = () => new URLSearchParams(new URL(page.url()).hash.slice(1));
  await until(() => ['set', 'view', 'layers', 'theme'].every((word) => words().has(word)));
  const view = await page.evaluate(() => ({ ...window.app.view }));
  const other = await visit(new URL(page.url()).hash);
  await waitFor(other, () => window.app.scene.counts.whole > 0 && window.app.mesh.points === 60);
  const seen = await other.evaluate(() => ({ ...window.app.view, layers: window.app.overlay.layers }));
  for (const k of ['x', 'y']) assert.ok(Math.abs(seen[k] - view[k]) * view.scale < 1, `${k}: ${seen[k]} and ${view[k]}`);
  assert.ok(Math.abs(seen.scale / view.scale - 1) < 1e-5);
  assert.deepEqual([seen.layers.hull, seen.layers.contours, await themeOf(other)], [false, true, theme]);
});

test('the angles of the triangles are those of QUALITY, in process, too, and follow edits', async () => {
  const page = await open('used');
  const texts = () => page.$$eval('#angles li span', (spans) => spans.map((span) => span.innerText));
  const expected = async () => {
    const [quality, points, triangles] = [await ask('QUALITY used'), await ask('POINTS used'), await ask('TRIANGLES used')].map((lines) => lines.slice(1));
    const places = new Map(points.map((row) => row.split(' ').map(Number)).map(([id, x, y]) => [id, [x, y]]));
    assert.deepEqual(qualityOf(triangles.flatMap((row) => row.split(' ').map(Number)), (id) => places.get(id)).rows, quality);
    const counts = quality.map((row) => Number(row.split(' ')[2]));
    return counts.map((n, k) => `${5 * k} to ${5 * k + 5}°: ${((100 * n) / triangles.length).toFixed(1)} %`).join();
  };
  await page.click('#angles summary');
  const first = await expected();
  await until(async () => (await texts()).join() === first);
  await ask('ADD used 0.501 0.502 0.503 0.499 0.52 0.53');
  const second = await expected();
  assert.notEqual(second, first);
  await until(async () => (await texts()).join() === second);
  await ask('DEL used 60 61 62');
});

test('the theme is the system’s, also when it changes, until one is chosen', async () => {
  const page = await visit('#set=used');
  await system(page, 'dark');
  await until(async () => (await themeOf(page)) === 'dark');
  await system(page, 'light');
  await until(async () => (await themeOf(page)) === 'light');
  await page.click('#theme');
  assert.equal(await themeOf(page), 'dark');
  await system(page, 'dark');
  await system(page, 'light');
  assert.equal(await themeOf(page), 'dark');
});

test('on a phone the panel has at most a third of the screen, and can be closed', async () => {
  const page = await open('used', { width: 390, height: 844, isMobile: true, hasTouch: true });
  const height = () => page.evaluate(() => document.querySelector('aside').getBoundingClientRect().height);
  assert.ok((await height()) <= 844 / 3, String(await height()));
  await page.tap('#sheet');
  assert.ok((await height()) < 80, String(await height()));
  await waitFor(page, () => document.getElementById('mesh').clientHeight > 760);
  const home = await placeOf('used', 7);
  await page.tap('#edit');
  const [from, to] = [await onPage(page, ...home), await onPage(page, 0.5, 0.5)];
  await page.touchscreen.touchStart(...from);
  for (let k = 1; k <= 5; k++) await page.touchscreen.touchMove(from[0] + (k / 5) * (to[0] - from[0]), from[1] + (k / 5) * (to[1] - from[1]));
  await page.touchscreen.touchEnd();
  await isAt('used', 7, [0.5, 0.5], 0.02);
});

test('a file becomes a new set after a question; a bad one is refused with its line', async () => {
  const page = await open('used');
  const file = async (name, text) => {
    writeFileSync(join(folder, name), text);
    await (await page.$('#file')).uploadFile(join(folder, name));
  };
  await file('bad.csv', 'x,y\n1,2\n3,\n');
  await says(page, 'message', 'bad.csv: line 3 has no two coordinates');
  await file('used.csv', 'name,lon,lat,height\n"A, or B",0,0,1.5\nC,4,0,2\nD,0,4,\n');
  await says(page, 'notice', 'Load 3 points of used.csv into the new set used_2 of the server');
  assert.equal((await ask('SETS')).some((row) => /^used_2 /.test(row)), false);
  await press(page, 'Load');
  await waitFor(page, () => window.app.mesh.points === 3 && window.app.mesh.triangles === 1);
  assert.deepEqual((await ask('POINTS used_2 FIELDS height')).slice(1), ['0 0 0 1.5', '1 4 0 2', '2 0 4 nan']);
  assert.equal(await page.evaluate(() => window.app.overlay.names.get(0)), 'A, or B');
  const features = [[1, 2], [3, 4], [1, 5]].map((coordinates) => ({ type: 'Feature', properties: {}, geometry: { type: 'Point', coordinates } }));
  await file('places.geojson', JSON.stringify({ type: 'FeatureCollection', features }));
  await says(page, 'notice', 'new set places of');
  await press(page, 'Cancel');
  assert.equal((await ask('SETS')).some((row) => /^places /.test(row)), false);
  await waitFor(page, () => document.getElementById('notice').hidden);
  await (await page.$('#file')).uploadFile(join(folder, 'places.geojson'));
  await says(page, 'notice', 'new set places of');
});

test('the picture is saved as PNG and as SVG, with everything that is in view', async () => {
  const page = await open('used');
  await page.click('#cells');
  await waitFor(page, () => window.app.scene.counts.whole > 0);
  const session = await page.createCDPSession();
  await session.send('Browser.setDownloadBehavior', {
    behavior: 'allow',
    downloadPath: folder,
    browserContextId: page.browserContext().id,
  });
  const saved = async (name) => {
    await until(() => readdirSync(folder).includes(name));
    return readFileSync(join(folder, name));
  };
  await page.click('#png');
  const png = await saved('used.png');
  assert.deepEqual([...png.subarray(1, 4)], [...Buffer.from('PNG')]);
  await page.click('#svg');
  const svg = String(await saved('used.svg'));
  const triangles = await page.evaluate(() => window.app.mesh.triangles);
  const longest = [...svg.matchAll(/ d="([^"]*)"/g)].map(([, d]) => d.split('M').length - 1);
  assert.ok(longest.includes(triangles), `no path has ${triangles} triangles`);
  assert.ok(longest.includes(60), 'no path has the 60 points or cells');
  assert.equal((svg.match(/fill="rgb/g) ?? []).length >= triangles, true);
  assert.equal(await page.evaluate((s) => new DOMParser().parseFromString(s, 'image/svg+xml').querySelector('parsererror'), svg), null);
});

test('the saved SVG has the colours of the map: of values, in the light of the hillshade, and of bands', async () => {
  await makeSet('slope', 1500);
  const xs = (await ask('POINTS slope')).slice(1).map((row) => Number(row.split(' ')[1]));
  await ask(...xs.map((x, id) => `FSET slope z ${id} ${100 * x}`));
  for (const layers of ['coloured', 'coloured,hillshade', 'coloured,bands']) {
    const page = await open('slope', undefined, `&layers=${layers}`);
    const text = await page.evaluate(async () => {
      const { SvgContext, drawTriangles } = await import('./drawing/svg.js');
      const context = new SvgContext(window.app.view, '#678');
      drawTriangles(context, window.app.view, window.app.mesh, window.app.scene.style);
      return String(context);
    });
    const reader = await browser.newPage();
    await reader.setContent(`<body style="margin: 0">${text}`);
    const svg = PNG.sync.read(Buffer.from(await reader.screenshot()));
    await reader.close();
    const map = await picture(page, 'mesh');
    const places = await page.evaluate(() => [0.12, 0.38, 0.63, 0.88].map((x) => window.app.view.toScreen(x, 0.5).map(Math.round)));
    const meanAt = ({ width, data }, [x, y]) => [0, 1, 2].map((k) => Array.from({ length: 625 }, (_, i) => data[4 * ((y - 12 + Math.floor(i / 25)) * width + x - 12 + (i % 25)) + k]).reduce((a, b) => a + b) / 625);
    for (const place of places) {
      const [a, b] = [meanAt(svg, place), meanAt(map, place)];
      assert.ok(a.every((v, k) => Math.abs(v - b[k]) < 10), `${layers}: ${a} and ${b}`);
    }
    await page.close();
  }
});

test('layers of a field can be chosen only if there is one', async () => {
  await makeSet('plain', 20);
  const page = await open('plain');
  const disabled = () => page.$$eval('#panel input:disabled', (inputs) => inputs.map(({ id }) => id));
  await until(async () => (await disabled()).join() === 'coloured,hillshade,bands,contours');
  await page.select('#set', 'used');
  await until(async () => (await disabled()).length === 0);
});

test('a constraint is drawn bold, and a move that would cross it is shown as refused', async () => {
  await ask('ADD fence 0 0  4 0  4 4  0 4  2 3', 'TRIANGULATE fence', 'CONSTRAIN fence 0 1 3 2');
  const page = await open('fence');
  await page.click('#triangles');
  const bold = (x, y) =>
    page.evaluate(
      (at) => {
        const [px, py] = window.app.view.toScreen(...at).map(Math.round);
        const { data } = document.getElementById('overlay').getContext('2d').getImageData(px - 3, py - 3, 7, 7);
        return data.filter((v, k) => k % 4 === 3 && v > 200).length;
      },
      [x, y],
    );
  await until(async () => (await bold(1, 0)) > 13);
  assert.ok((await bold(0, 1)) < 13, 'the hull is thinner');
  await page.click('#edit');
  await drag(page, await onPage(page, 0, 0), await onPage(page, 2, 4.15), 1);
  await says(page, 'message', 'cross');
  assert.equal((await ask('GET fence 0'))[1], '0 0 0');
  await drag(page, await onPage(page, 0, 0), await onPage(page, 1, 1), 1);
  await isAt('fence', 0, [1, 1], 0.05);
  await until(async () => (await bold(2.5, 0.5)) > 9);
});

test('a map that is moved shows what a page that begins there draws, and keys mean the middle of the map', async () => {
  const page = await open('used');
  await page.focus('#map');
  for (const key of ['ArrowLeft', 'ArrowUp', '+', '+', 'ArrowRight', '-']) await page.keyboard.press(key);
  await waitFor(page, () => document.getElementById('mesh').style.transform === '' && !document.getElementById('pointer').hidden);
  await waitFor(page, () => {
    const [x, y, scale] = (new URLSearchParams(location.hash.slice(1)).get('view') ?? '').split(',').map(Number);
    const { view } = window.app;
    return Math.abs(scale / view.scale - 1) < 1e-5 && Math.hypot(x - view.x, y - view.y) * scale < 1;
  });
  const middle = await page.evaluate(() => window.app.view.toPlane(window.app.view.width / 2, window.app.view.height / 2));
  const [id] = (await ask(`NEAREST used ${middle.join(' ')}`))[1].split(' ');
  assert.match(await page.evaluate(() => document.getElementById('pointer').innerText), new RegExp(`^point ${id}\\b`));
  const other = await open('used', undefined, new URL(page.url()).hash.replace('#set=used', ''));
  const [{ data: a }, { data: b }] = [await picture(page, 'mesh'), await picture(other, 'mesh')];
  const differ = a.filter((value, i) => Math.abs(value - b[i]) > 40).length;
  assert.ok(a.length === b.length && differ < 0.002 * a.length, `${differ} of ${a.length} bytes differ`);
});

test('axe-core finds nothing that keeps anybody out, in both themes, while editing and with a notice', async () => {
  const source = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
  for (const [address, theme] of [['#set=used', 'light'], ['#set=used', 'dark'], ['#set=nope', 'light']]) {
    const page = await visit(`${address}&theme=${theme}`);
    await waitFor(page, () => window.app.scene.counts.whole > 0 || !document.getElementById('notice').hidden);
    await page.click('#edit');
    await page.evaluate(source);
    const { violations } = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes.map((n) => [n.html, n.failureSummary])]), []);
    await page.close();
  }
});
