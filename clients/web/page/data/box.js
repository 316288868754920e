// Boxes of the plane, [x0, y0, x1, y1].

/** A box without a place. */
export const emptyBox = () => [Infinity, Infinity, -Infinity, -Infinity];

/** Makes a box contain a place. */
export function extend(box, x, y) {
  if (x < box[0]) box[0] = x;
  if (y < box[1]) box[1] = y;
  if (x > box[2]) box[2] = x;
  if (y > box[3]) box[3] = y;
}

/** Makes a box contain another one. */
export function widen(box, [x0, y0, x1, y1]) {
  extend(box, x0, y0);
  extend(box, x1, y1);
}

export const contains = (a, b) => a[0] <= b[0] && a[1] <= b[1] && a[2] >= b[2] && a[3] >= b[3];

export const meets = (a, b) => a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3];
