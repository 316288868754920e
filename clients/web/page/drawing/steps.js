// Steps of scales.

/** Returns the step between levels of a field. */
export const stepOf = ({ min, max }) => niceStep((max - min) / 20);

/** The next larger of 1, 2, 5, 10, 20, 50 ... */
export function niceStep(step) {
  if (!(step > 0)) return 0;
  const power = Math.floor(Math.log10(step));
  return [1, 2, 5, 10, 20].map((m) => Number(`${m}e${power}`)).find((nice) => nice >= step); // 10 ** -5 is not 1e-5
}
