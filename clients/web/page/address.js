// The address keeps the set, the view, the layers and a chosen theme behind `#`. It may also give a token, and `most`.

const read = () => new URLSearchParams(location.hash.slice(1));

/** A word of the address, or null. */
export const given = (name) => read().get(name);

/** Puts words into the address, {name: text}; null removes one. The history gets no new page, and no event comes. */
export function keep(words) {
  const all = read();
  for (const [name, text] of Object.entries(words)) {
    if (text === null) all.delete(name);
    else all.set(name, text);
  }
  const hash = `#${all.toString().replaceAll('%2C', ',')}`;
  if (hash !== location.hash) history.replaceState(null, '', hash);
}

/** The view of the address as {x, y, scale}, or null. */
export function givenView() {
  const [x, y, scale] = (given('view') ?? '').split(',').map(Number);
  return Number.isFinite(x) && Number.isFinite(y) && scale > 0 ? { x, y, scale } : null;
}

/** The view as text: places to a tenth of a pixel. */
export function viewText({ x, y, scale }) {
  const digits = Math.max(0, Math.min(100, Math.ceil(Math.log10(scale)) + 1));
  return [x.toFixed(digits), y.toFixed(digits), Number(scale.toPrecision(6))].join(',');
}
