// Tests of editing by hand, of undo and redo, and of what the page explains.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { ask, closePages, drag, isAt, killGateway, listen, makeSet, onPage, open, placeOf, press, says, settled, start, stop, until, visit, waitFor } from './stage.mjs';

before(start);
afterEach(closePages);
after(stop);

const type = async (page, ...keys) => {
  for (const key of keys) await page.keyboard.down(key);
  for (const key of keys.reverse()) await page.keyboard.up(key);
};

test('a drag moves the map, and points only after E; undo and redo take the whole drag back and forth', async () => {
  await makeSet('pulled', 50);
  const page = await open('pulled');
  const home = await placeOf('pulled', 17);
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.5));
  assert.deepEqual(await placeOf('pulled', 17), home);
  await page.focus('#map');
  await type(page, 'e');
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.5));
  await isAt('pulled', 17, [0.5, 0.5]);
  await type(page, 'Control', 'z');
  await isAt('pulled', 17, home, 0);
  await type(page, 'Control', 'Shift', 'z');
  await isAt('pulled', 17, [0.5, 0.5]);
  await page.waitForSelector('#undo:not([disabled])');
  await page.click('#undo');
  await isAt('pulled', 17, home, 0);
  await page.waitForSelector('#undo[disabled]');
});

test('undo brings a deleted point back with its values, and what was done to it before can be undone, too', async () => {
  await makeSet('kept', 40);
  await ask('FSET kept z 3 7.25', 'FSET kept w 3 -1');
  const page = await open('kept');
  await page.click('#edit');
  const home = await placeOf('kept', 3);
  await drag(page, await onPage(page, ...home), await onPage(page, 0.5, 0.52));
  await isAt('kept', 3, [0.5, 0.52]);
  await settled(page, 'kept');
  await page.focus('#map');
  await type(page, 'Delete');
  await until(async () => (await placeOf('kept', 3)) === undefined);
  await page.waitForFunction(() => window.app.mesh.points === 39);
  await type(page, 'Control', 'z');
  await isAt('kept', 40, [0.5, 0.52]);
  assert.deepEqual([(await ask('FGET kept z 40'))[1], (await ask('FGET kept w 40'))[1]], ['40 7.25', '40 -1']);
  await type(page, 'Control', 'z');
  await isAt('kept', 40, home, 0);
  await page.mouse.click(...(await onPage(page, 0.4, 0.6)), { count: 2 });
  await isAt('kept', 41, [0.4, 0.6]);
  await type(page, 'Control', 'z');
  await until(async () => (await placeOf('kept', 41)) === undefined);
  await type(page, 'Control', 'Shift', 'z');
  await isAt('kept', 42, [0.4, 0.6]);
});

test('an edit whose point another person has deleted is refused, and the one before it can still be undone', async () => {
  await makeSet('taken', 40);
  const page = await open('taken');
  await page.click('#edit');
  const homes = [await placeOf('taken', 5), await placeOf('taken', 6)];
  await drag(page, await onPage(page, ...homes[0]), await onPage(page, 0.5, 0.5));
  await isAt('taken', 5, [0.5, 0.5]);
  await settled(page, 'taken');
  await drag(page, await onPage(page, ...homes[1]), await onPage(page, 0.3, 0.5));
  await isAt('taken', 6, [0.3, 0.5]);
  await ask('DEL taken 6');
  await type(page, 'Control', 'z');
  await says(page, 'message', 'there is no point 6');
  await type(page, 'Control', 'z');
  await isAt('taken', 5, homes[0], 0);
});

test('a connection lost in the middle of a drag leaves a set that undo puts right', async () => {
  await makeSet('cut', 40);
  const page = await open('cut');
  await page.click('#edit');
  const home = await placeOf('cut', 5);
  await page.mouse.move(...(await onPage(page, ...home)));
  await page.mouse.down();
  await page.mouse.move(...(await onPage(page, 0.5, 0.5)), { steps: 5 });
  await isAt('cut', 5, [0.5, 0.5]);
  killGateway();
  await page.mouse.move(...(await onPage(page, 0.6, 0.6)), { steps: 5 });
  await page.mouse.up();
  await listen();
  await settled(page, 'cut');
  await says(page, 'message', '');
  await page.click('#undo');
  await isAt('cut', 5, home, 0);
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
});

test('the card is about the point that is there now', async () => {
  await ask('ADD card 0 0  4 0  4 4  0 4  2 2  2.2 3', 'TRIANGULATE card', 'FSET card z 4 1.5');
  const page = await open('card');
  await page.mouse.move(...(await onPage(page, 2, 2.05)));
  const isCard = async (id, at, rest) => {
    const ring = (await ask(`LISTS card ${id}`))[1].split(' ').slice(1);
    await says(page, 'pointer', `point ${id} x, y ${at} neighbours ${ring.length}${rest}`);
  };
  await isCard(4, '2, 2', ' z 1.5');
  const ring = (await ask('LISTS card 4'))[1].split(' ').slice(1);
  await waitFor(page, (n) => document.getElementById('spoken').textContent === `point 4; x, y 2, 2; neighbours ${n}; z 1.5`, {}, ring.length);
  await ask('MOVE card 4 2 1.75', 'FSET card z 4 2.5');
  await isCard(4, '2, 1.75', ' z 2.5');
  await ask('DEL card 4');
  await isCard(5, '2.2, 3', '');
  await page.mouse.move(5, 5);
  await page.mouse.move(890, 300);
  await says(page, 'pointer', '');
});

test('a set that is missing, dropped, empty or not triangulated is explained, and another one is never shown instead', async () => {
  await makeSet('there', 30);
  await ask('CREATE empty', 'ADD flat 0 0 1 0 0 1');
  const page = await visit('#set=nope');
  await says(page, 'notice', 'The set nope does not exist. Choose another set:');
  await new Promise((resolve) => setTimeout(resolve, 3500));
  assert.equal(await page.evaluate(() => window.app.follower.set), null);
  await press(page, 'there');
  await waitFor(page, () => window.app.mesh.points === 30 && document.getElementById('notice').hidden);
  await ask('DROP there');
  await says(page, 'notice', 'The set there has been dropped. Choose another set:');
  await makeSet('there', 20, 5);
  await waitFor(page, () => window.app.mesh.points === 20 && document.getElementById('notice').hidden);
  await page.select('#set', 'empty');
  await says(page, 'notice', 'empty is empty');
  await page.select('#set', 'flat');
  await says(page, 'notice', 'flat has 3 points and is not triangulated.');
  await press(page, 'Triangulate');
  await waitFor(page, () => window.app.mesh.triangles === 1 && document.getElementById('notice').hidden);
  await ask('ADD nope 0 0 1 1');
});
