// Tests of editing by hand, of undo and redo, and of what the page explains.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { ask, drag, killGateway, listen, makeSet, onPage, open, settled, start, stop, until, visit, waitFor } from './stage.mjs';

before(start);
after(stop);

const place = async (set, id) => (await ask(`GET ${set} ${id}`))[1]?.split(' ').slice(1).map(Number);
const textOf = (page, id) => page.evaluate((i) => document.getElementById(i).innerText.replace(/\s+/g, ' '), id);
const press = async (page, ...keys) => {
  for (const key of keys) await page.keyboard.down(key);
  for (const key of keys.reverse()) await page.keyboard.up(key);
};
const isAt = (set, id, [x, y]) => until(async () => ((p) => p !== undefined && Math.hypot(p[0] - x, p[1] - y) < 0.01)(await place(set, id)));

test('a drag moves the map, and points only after E; undo and redo take the whole drag back and forth', async () => {
  await makeSet('pulled', 50);
  const page = await open('pulled');
  const home = await place('pulled', 17);
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.5));
  assert.deepEqual(await place('pulled', 17), home);
  await page.focus('#map');
  await press(page, 'e');
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.5));
  await isAt('pulled', 17, [0.5, 0.5]);
  await press(page, 'Control', 'z');
  await until(async () => String(await place('pulled', 17)) === String(home));
  await press(page, 'Control', 'Shift', 'z');
  await isAt('pulled', 17, [0.5, 0.5]);
  await page.waitForSelector('#undo:not([disabled])');
  await page.click('#undo');
  await until(async () => String(await place('pulled', 17)) === String(home));
  await page.waitForSelector('#undo[disabled]');
  assert.deepEqual(page.faults, []);
  await page.close();
});

test('undo brings a deleted point back with its values, and what was done to it before can be undone, too', async () => {
  await makeSet('kept', 40);
  await ask('FSET kept z 3 7.25', 'FSET kept w 3 -1');
  const page = await open('kept');
  await page.click('#edit');
  const home = await place('kept', 3);
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.52));
  await isAt('kept', 3, [0.5, 0.52]);
  await settled(page, 'kept');
  await page.focus('#map');
  await press(page, 'Delete');
  await until(async () => (await place('kept', 3)) === undefined);
  await page.waitForFunction(() => window.app.mesh.points === 39);
  await press(page, 'Control', 'z');
  await isAt('kept', 40, [0.5, 0.52]);
  assert.deepEqual([(await ask('FGET kept z 40'))[1], (await ask('FGET kept w 40'))[1]], ['40 7.25', '40 -1']);
  await press(page, 'Control', 'z');
  await until(async () => String(await place('kept', 40)) === String(home));
  await page.mouse.click(...(await onPage(page, 0.4, 0.6)), { count: 2 });
  await isAt('kept', 41, [0.4, 0.6]);
  await press(page, 'Control', 'z');
  await until(async () => (await place('kept', 41)) === undefined);
  await press(page, 'Control', 'Shift', 'z');
  await isAt('kept', 42, [0.4, 0.6]);
  await page.close();
});

test('an edit whose point another person has deleted is refused, and the one before it can still be undone', async () => {
  await makeSet('taken', 40);
  const page = await open('taken');
  await page.click('#edit');
  const homes = [await place('taken', 5), await place('taken', 6)];
  await drag(page, await onPage(page, ...homes[0]), await onPage(page, 0.5, 0.5));
  await isAt('taken', 5, [0.5, 0.5]);
  await settled(page, 'taken');
  await drag(page, await onPage(page, ...homes[1]), await onPage(page, 0.3, 0.5));
  await isAt('taken', 6, [0.3, 0.5]);
  await ask('DEL taken 6');
  await press(page, 'Control', 'z');
  await page.waitForFunction(() => /there is no point 6/.test(document.getElementById('message').textContent));
  await press(page, 'Control', 'z');
  await until(async () => String(await place('taken', 5)) === String(homes[0]));
  await page.close();
});

test('a connection lost in the middle of a drag leaves a set that undo puts right', async () => {
  await makeSet('cut', 40);
  const page = await open('cut');
  await page.click('#edit');
  const home = await place('cut', 5);
  await page.mouse.move(...(await onPage(page, ...home)));
  await page.mouse.down();
  await page.mouse.move(...(await onPage(page, 0.5, 0.5)), { steps: 5 });
  await isAt('cut', 5, [0.5, 0.5]);
  killGateway();
  await page.mouse.move(...(await onPage(page, 0.6, 0.6)), { steps: 5 });
  await page.mouse.up();
  await listen();
  await settled(page, 'cut');
  await page.waitForFunction(() => document.getElementById('message').textContent === '');
  await page.click('#undo');
  await until(async () => String(await place('cut', 5)) === String(home));
  assert.deepEqual(page.faults, []);
  await page.close();
});

test('the pointer of another person on the same set is shown, moves, and goes when the person goes', async () => {
  await makeSet('met', 30);
  await makeSet('elsewhere', 30);
  const [one, two, far] = [await open('met'), await open('met'), await open('elsewhere')];
  const seen = (page) => page.evaluate(() => [...window.app.marks.pointers.values()]);
  const isNear = async (page, x, y) => (await seen(page)).some((p) => Math.hypot(p[0] - x, p[1] - y) < 0.01);
  await one.mouse.move(...(await onPage(one, 0.3, 0.6)));
  await until(() => isNear(two, 0.3, 0.6));
  await one.mouse.move(...(await onPage(one, 0.7, 0.2)));
  await until(() => isNear(two, 0.7, 0.2));
  assert.deepEqual([(await seen(two)).length, await seen(far), await seen(one)], [1, [], []]);
  await one.select('#set', 'elsewhere');
  await until(async () => (await seen(two)).length === 0);
  await two.mouse.move(...(await onPage(two, 0.5, 0.5)));
  await one.select('#set', 'met');
  await two.mouse.move(...(await onPage(two, 0.4, 0.5)));
  await until(() => isNear(one, 0.4, 0.5));
  await two.close();
  await until(async () => (await seen(one)).length === 0);
  for (const page of [one, far]) await page.close();
});

test('the card is about the point that is there now', async () => {
  await ask('ADD card 0 0  4 0  4 4  0 4  2 2  2.2 3', 'TRIANGULATE card', 'FSET card z 4 1.5');
  const page = await open('card');
  await page.mouse.move(...(await onPage(page, 2, 2.05)));
  const says = async (id, at, rest) => {
    const ring = (await ask(`LISTS card ${id}`))[1].split(' ').slice(1);
    const text = `point ${id} x, y ${at} neighbours ${ring.length}${rest}`;
    await waitFor(page, (t) => document.getElementById('pointer').innerText.replace(/\s+/g, ' ') === t, {}, text);
  };
  await says(4, '2, 2', ' z 1.5');
  const ring = (await ask('LISTS card 4'))[1].split(' ').slice(1);
  await waitFor(page, (n) => document.getElementById('spoken').textContent === `point 4; x, y 2, 2; neighbours ${n}; z 1.5`, {}, ring.length);
  await ask('MOVE card 4 2 1.75', 'FSET card z 4 2.5');
  await says(4, '2, 1.75', ' z 2.5');
  await ask('DEL card 4');
  await says(5, '2.2, 3', '');
  await page.mouse.move(5, 5);
  await page.mouse.move(890, 300);
  await until(async () => (await textOf(page, 'pointer')) === '');
  await page.close();
});

test('a set that is missing, dropped, empty or not triangulated is explained, and another one is never shown instead', async () => {
  await makeSet('there', 30);
  await ask('CREATE empty', 'ADD flat 0 0 1 0 0 1');
  const notice = (page, pattern) => waitFor(page, (p) => new RegExp(p).test(document.getElementById('notice').innerText), {}, pattern);
  const choose = (page, label) =>
    page.evaluate((l) => [...document.querySelectorAll('#notice button')].find((b) => b.textContent === l).click(), label);
  const page = await visit('#set=nope');
  await notice(page, 'The set nope does not exist. Choose another set:');
  await new Promise((resolve) => setTimeout(resolve, 3500));
  assert.equal(await page.evaluate(() => window.app.follower.set), null);
  await choose(page, 'there');
  await waitFor(page, () => window.app.mesh.points === 30 && document.getElementById('notice').hidden);
  await ask('DROP there');
  await notice(page, 'The set there has been dropped. Choose another set:');
  await makeSet('there', 20, 5);
  await waitFor(page, () => window.app.mesh.points === 20 && document.getElementById('notice').hidden);
  await page.select('#set', 'empty');
  await notice(page, 'empty is empty');
  await page.select('#set', 'flat');
  await notice(page, 'flat has 3 points and is not triangulated.');
  await choose(page, 'Triangulate');
  await waitFor(page, () => window.app.mesh.triangles === 1 && document.getElementById('notice').hidden);
  await ask('ADD nope 0 0 1 1');
  assert.deepEqual(page.faults, []);
  await page.close();
});
