// How thin the triangles are: a bar for each range of least angles, from the reply to QUALITY.
import { make } from './panel.js';

const DEGREE = 180 / Math.PI;
const STEP = 5;

/** The reply of a set in this page: {keys: {angle}, rows: ['low high count', ...]}, computed in doubles. */
export function qualityOf(triangles, placeOf) {
  const counts = new Array(60 / STEP).fill(0);
  let angle = NaN;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => placeOf(triangles[t + k]));
    const sides = [[a, b], [b, c], [c, a]].map(([p, q]) => Math.hypot(q[0] - p[0], q[1] - p[1])).sort((p, q) => p - q);
    const area = Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    const least = DEGREE * Math.asin(Math.min(1, area / (sides[1] * sides[2])));
    angle = least < angle || Number.isNaN(angle) ? least : angle;
    counts[Math.min(counts.length - 1, Math.floor(least / STEP))]++;
  }
  return { keys: { angle: String(angle) }, rows: counts.map((n, k) => `${STEP * k} ${STEP * (k + 1)} ${n}`) };
}

/** Shows the reply in the element: a list of bars, each with its range and its share of the triangles. */
export function showAngles(element, { keys, rows }) {
  const ranges = rows.map((row) => row.split(' ').map(Number));
  const all = ranges.reduce((sum, [, , n]) => sum + n, 0);
  const most = Math.max(1, ...ranges.map(([, , n]) => n));
  element.querySelector('p').textContent = all === 0 ? 'There are no triangles.' : `The least one is ${Number(keys.angle).toPrecision(3)}°.`;
  element.querySelector('ol').replaceChildren(
    ...ranges.map(([low, high, n]) => {
      const text = make('span', {}, `${low} to ${high}°: ${all === 0 ? 0 : ((100 * n) / all).toFixed(1)} %`);
      return make('li', {}, text, make('i', { style: `width: ${(45 * n) / most}%` }));
    }),
  );
}
