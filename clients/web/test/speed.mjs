// Measures the page in Chromium with WebGL in software: the first picture, frames while the map moves, and the picture when it rests. It
// drags a point, and measures how soon an edit of somebody else is seen. For `make bench-web`; words choose measurements. SITE is what `make site` has built.
import { readFileSync, readdirSync } from 'node:fs';
import { serveFolder } from './folder.mjs';
import { browser, makeSet, onPage, open, start, stop, visit, waitFor } from './stage.mjs';

const SIZE = { width: 1280, height: 800 };
const { SITE, ROUNDS = '3', FRAMES = '120' } = process.env;

/** Seconds of processor time that Chromium has used, all its processes together. */
function processorTime() {
  const parents = new Map();
  const ticks = new Map();
  for (const name of readdirSync('/proc').filter((entry) => /^\d+$/.test(entry))) {
    try {
      const words = readFileSync(`/proc/${name}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
      parents.set(Number(name), Number(words[1]));
      ticks.set(Number(name), Number(words[11]) + Number(words[12]));
    } catch {
      // it has ended
    }
  }
  const isOurs = (pid) => pid === browser.process().pid || (parents.has(pid) && isOurs(parents.get(pid)));
  return [...ticks].reduce((sum, [pid, t]) => sum + (isOurs(pid) ? t : 0), 0) / 100;
}

/** Notes when the first triangles, points and names are drawn. Runs in the page before its scripts. */
function noteFirsts() {
  window.firsts = {};
  const note = (name, prototype, method, isIt) => {
    const act = prototype[method];
    prototype[method] = function (...words) {
      if (isIt(...words)) window.firsts[name] ??= performance.now();
      return act.apply(this, words);
    };
  };
  note('triangles', WebGL2RenderingContext.prototype, 'drawArrays', (mode, first, count) => mode === 4 && count > 0);
  note('points', CanvasRenderingContext2D.prototype, 'arc', () => true);
  note('names', CanvasRenderingContext2D.prototype, 'strokeText', () => true);
}

async function firstPicture(at, address, names) {
  const page = await visit(address, { at, size: SIZE, before: noteFirsts });
  await waitFor(page, (all) => all.every((name) => name in window.firsts), {}, names);
  const firsts = await page.evaluate(() => window.firsts);
  await page.close();
  return names.map((name) => `${name} after ${firsts[name].toFixed(0)} ms`).join(', ');
}

/** Moves the map in each of n frames, by keys or by the wheel. Returns how many milliseconds they took. Runs in the page. */
function moveMap(kind, n) {
  const map = document.getElementById('map') ?? document.getElementById('overlay');
  const acts = {
    pan: (k) => map.dispatchEvent(new KeyboardEvent('keydown', { key: k % 16 < 8 ? 'ArrowLeft' : 'ArrowRight' })),
    zoom: (k) => map.dispatchEvent(new WheelEvent('wheel', { deltaY: k % 40 < 20 ? -20 : 20, clientX: 500, clientY: 400 })),
  };
  return new Promise((resolve) => {
    const began = performance.now();
    let frames = 0;
    const frame = (now) => {
      if (frames === n) return resolve(now - began);
      acts[kind](frames++);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
}

async function framesWhileMoving(at, name, address, isThere) {
  const page = await visit(address, { at, size: SIZE });
  await waitFor(page, isThere);
  await new Promise((resolve) => setTimeout(resolve, 1000));
  const texts = [];
  for (const kind of ['pan', 'zoom']) {
    const before = processorTime();
    const ms = await page.evaluate(moveMap, kind, Number(FRAMES));
    const each = (1000 * (processorTime() - before)) / Number(FRAMES);
    texts.push(`${kind} ${((1000 * Number(FRAMES)) / ms).toFixed(0)} frames a second, ${each.toFixed(0)} ms of processor time each`);
  }
  console.log(`${name}: ${texts.join('; ')}`);
  await page.close();
}

/** Ends n pans of the map. Returns for each how many milliseconds later the canvases showed the new view, and how long the last drawing of
 * both took. Runs in the page. */
async function endPans(n) {
  const { overlay, scene } = window.app;
  const [map, canvas] = [document.getElementById('map'), document.getElementById('mesh')];
  let took = 0;
  for (const part of [scene, overlay]) {
    const { draw } = part;
    part.draw = (...words) => {
      const began = performance.now();
      draw.apply(part, words);
      took += performance.now() - began;
    };
  }
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const pans = [];
  for (let k = 0; k < n; k++) {
    for (let i = 0; i < 8; i++) {
      map.dispatchEvent(new KeyboardEvent('keydown', { key: k % 2 === 0 ? 'ArrowLeft' : 'ArrowRight' }));
      await frame();
    }
    const began = performance.now();
    do {
      took = 0;
      await frame();
    } while (canvas.style.transform !== '');
    pans.push({ later: performance.now() - began, took });
  }
  return pans;
}

async function redrawAtRest() {
  const page = await open('fifty', SIZE);
  const pans = await page.evaluate(endPans, 20);
  const median = (key) => pans.map((pan) => pan[key]).sort((a, b) => a - b)[pans.length >> 1].toFixed(0);
  const before = processorTime();
  await page.evaluate(async () => {
    const { drawNow } = await import('./stage.js');
    for (let k = 0; k < 20; k++) drawNow();
  });
  const each = (1000 * (processorTime() - before)) / 20;
  const texts = [`in ${median('took')} ms`, `${each.toFixed(0)} ms of processor time`, `${median('later')} ms after its end`];
  console.log(`1e5 triangles are drawn again when a pan has ended: ${texts.join(', ')}`);
  await page.close();
}

async function framesWhileDragging() {
  const page = await open('hundred');
  await page.click('#edit');
  const counts = () => page.evaluate(() => ({ ...window.app.scene.counts, at: performance.now() }));
  const id = await page.evaluate(() => window.app.mesh.ids >> 1);
  const [x, y] = await page.evaluate((i) => [window.app.mesh.xy[2 * i], window.app.mesh.xy[2 * i + 1]], id);
  await page.mouse.move(...(await onPage(page, x, y)));
  await page.mouse.down();
  const before = await counts();
  for (let k = 1; k <= 200; k++) await page.mouse.move(...(await onPage(page, x + 0.0005 * k, y)));
  const after = await counts();
  await page.mouse.up();
  await page.close();
  const parts = after.part - before.part;
  const perSecond = (1000 * parts) / (after.at - before.at);
  console.log(`a point among 1e5 is dragged: ${perSecond.toFixed(0)} pictures a second, ${((after.triangles - before.triangles) / parts).toFixed(0)} triangles each`);
}

/** Measures from the reply to a MOVE of one page to the frame after the one that draws it on another page. */
async function editsOfOthers() {
  const [one, two] = [await open('hundred', SIZE), await open('hundred', SIZE)];
  const times = [];
  for (let k = 0; k < 40; k++) {
    const seen = two.evaluate(
      (version) =>
        new Promise((resolve) => {
          const frame = () => {
            if (window.app.mesh.version > version) requestAnimationFrame(() => resolve(performance.timeOrigin + performance.now()));
            else requestAnimationFrame(frame);
          };
          frame();
        }),
      await two.evaluate(() => window.app.mesh.version),
    );
    const replied = await one.evaluate(async (i) => {
      const [x, y] = window.app.mesh.xy.subarray(2 * i, 2 * i + 2);
      await window.app.connection().request(`MOVE hundred ${i} ${x + 1e-4} ${y}`);
      return performance.timeOrigin + performance.now();
    }, 1000 + k);
    times.push((await seen) - replied);
  }
  times.sort((a, b) => a - b);
  const at = (share) => times[Math.floor(share * (times.length - 1))].toFixed(0);
  console.log(`an edit of another page among 1e5 points: seen after ${at(0.5)} ms, 95 % within ${at(0.95)} ms`);
  for (const page of [one, two]) await page.close();
}

const chosen = process.argv.slice(2);
const isChosen = (word) => chosen.length === 0 || chosen.includes(word);
const site = await serveFolder(SITE);
await start();
await makeSet('hundred', 100000);
if (isChosen('rest')) await makeSet('fifty', 50000);
if (isChosen('million')) await makeSet('million', 1000000);
await (await browser.newPage()).goto('about:blank');
for (let round = 0; round < Number(ROUNDS); round++) {
  if (isChosen('first')) {
    console.log(`Ireland in process: ${await firstPicture(site.port, '', ['triangles', 'points', 'names'])}`);
    console.log(`cities in process: ${await firstPicture(site.port, '#set=cities', ['triangles'])}`);
  }
  if (isChosen('million')) console.log(`2e6 triangles of a daemon: ${await firstPicture(undefined, '#set=million', ['triangles'])}`);
  if (isChosen('move')) {
    const hasPoints = (n) => `window.app.mesh.points === ${n} && window.app.scene.counts.whole > 0`;
    await framesWhileMoving(site.port, 'Ireland with cells', '', `${hasPoints(485)} && window.app.overlay.labels.length > 40`);
    await framesWhileMoving(site.port, 'terrain', '#set=terrain', hasPoints(14976));
    await framesWhileMoving(site.port, 'cities', '#set=cities', hasPoints(171075));
    await framesWhileMoving(undefined, '1e5 points', '#set=hundred', hasPoints(100000));
    if (isChosen('million')) await framesWhileMoving(undefined, '1e6 points', '#set=million', `window.app.follower.kind === 'sample'`);
  }
  if (isChosen('rest')) await redrawAtRest();
  if (isChosen('drag')) await framesWhileDragging();
  if (isChosen('others')) await editsOfOthers();
}
await stop();
site.close();
