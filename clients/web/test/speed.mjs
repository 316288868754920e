// Measures the page: how soon 2 million triangles are shown, and how often it is drawn while a point among 100,000 is dragged.
// For `make bench-web`.
import { browser, makeSet, onPage, open, start, stop, waitFor } from './stage.mjs';

async function timeToPicture() {
  const began = Date.now();
  const page = await open('million');
  await waitFor(page, () => window.app.mesh.triangles > 1e6 && window.app.scene.counts.whole > 0, { polling: 20, timeout: 120000 });
  const ms = Date.now() - began;
  await page.close();
  return ms;
}

async function framesWhileDragging() {
  const page = await open('hundred');
  await page.click('#edit');
  const counts = () => page.evaluate(() => ({ ...window.app.scene.counts, at: performance.now() }));
  await page.mouse.move(...(await onPage(page, 0.5, 0.5)));
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
  return { perSecond: (1000 * parts) / (after.at - before.at), bytes: (after.bytes - before.bytes) / parts };
}

await start();
await makeSet('million', 1000000);
await makeSet('hundred', 100000);
await (await browser.newPage()).goto('about:blank');
for (let round = 0; round < 3; round++) {
  const drag = await framesWhileDragging();
  console.log(
    `2e6 triangles: first picture after ${await timeToPicture()} ms; point among 1e5: ${drag.perSecond.toFixed(0)} pictures a second, ` +
      `${drag.bytes.toFixed(0)} bytes to the graphics memory for each`,
  );
}
await stop();
