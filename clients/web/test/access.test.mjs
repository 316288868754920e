// The page beside a daemon with one set that wants tokens, in a real browser.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { WebSocket } from 'ws';
import { ask, closePages, drawnShare, onPage, pagePort, says, start, stop, until, visit } from './stage.mjs';

let folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'access-'));
  writeFileSync(join(folder, 'tokens'), 'ro reader\nrw writer\n');
  await start({ options: ['--auth-file', join(folder, 'tokens')] });
  await ask('AUTH writer', 'ADD set 0 0  4 0  4 4  0 4  1 2', 'TRIANGULATE set');
});
afterEach(closePages);
after(async () => {
  await stop();
  rmSync(folder, { recursive: true });
});

test('without a token, or with a wrong one, the page says what is missing, and does not try again', async () => {
  for (const [address, text] of [['', 'authenticate first'], ['#token=other', 'no such token']]) {
    const page = await visit(address);
    await says(page, 'message', text);
    await new Promise((resolve) => setTimeout(resolve, 3500));
    await says(page, 'message', text);
    await page.close();
  }
});

test('with a token for reading the page shows sets, and says that it may not edit them', async () => {
  const page = await visit('#set=set&token=reader');
  await page.waitForFunction(() => window.app.mesh.triangles === 4);
  await page.click('#edit');
  await page.mouse.click(...(await onPage(page, 3, 2)), { count: 2 });
  await says(page, 'message', 'your token is for reading only');
  assert.equal(await page.evaluate(() => window.app.mesh.points), 5);
});

test('pointers are passed only between those whose token lets them see the set', async () => {
  const page = await visit('#set=set&token=reader');
  await page.waitForFunction(() => window.app.mesh.triangles === 4);
  const join = (token) => {
    const socket = new WebSocket(`ws://127.0.0.1:${pagePort}/pointers`);
    const seen = [];
    socket.on('message', (data) => seen.push(JSON.parse(data).place));
    socket.on('open', () => socket.send(JSON.stringify({ set: 'set', place: [1, 1], token })));
    return { socket, seen };
  };
  const strangers = [join(null), join('wrong'), join('reader\nSETS')];
  const known = join('reader');
  await until(() => page.evaluate(() => window.app.marks.pointers.size === 1));
  await page.mouse.move(...(await onPage(page, 2, 3)));
  await until(() => known.seen.some((place) => place !== null && Math.hypot(place[0] - 2, place[1] - 3) < 0.05));
  assert.deepEqual(strangers.flatMap(({ seen }) => seen), []);
  assert.equal(await page.evaluate(() => window.app.marks.pointers.size), 1);
  for (const { socket } of [...strangers, known]) socket.close();
  await until(() => page.evaluate(() => window.app.marks.pointers.size === 0));
});

test('when the last set is dropped nothing is left of it, and no point can be added', async () => {
  const page = await visit('#set=set&token=writer');
  await page.waitForFunction(() => window.app.mesh.triangles === 4);
  await page.click('#edit');
  await page.mouse.move(...(await onPage(page, 3, 2)));
  const drawn = async () => (await drawnShare(page, ['mesh', 'overlay'])) > 0;
  await page.waitForFunction(() => document.getElementById('pointer').textContent !== '');
  await until(drawn);
  await ask('AUTH writer', 'DROP set');
  await says(page, 'notice', 'The set set has been dropped. The daemon has no sets yet.');
  await until(async () => {
    await new Promise((resolve) => setTimeout(resolve, 500)); // reading pictures back all the time would keep the page from drawing
    return !(await drawn());
  });
  await page.waitForFunction(() => document.getElementById('facts').textContent + document.getElementById('pointer').textContent === '');
  await page.mouse.click(300, 300, { count: 2 });
  assert.equal((await ask('AUTH writer', 'SETS'))[1], 'OK 0');
});
