// The mean colour and the contrast of regions of a screenshot.
import { PNG } from 'pngjs';

/** The pixels of a page as they are on the screen. regionOf([x, y, width, height]) returns the mean of red, green and blue, and the
 * standard deviation of the brightness. `contrast` is the difference between the darkest and the brightest pixel. All are 0 to 255. */
export async function screenshotOf(page) {
  const { width, data } = PNG.sync.read(Buffer.from(await page.screenshot()));
  const regionOf = ([x0, y0, across, down]) => {
    const sums = [0, 0, 0];
    const brightness = [];
    for (let y = Math.ceil(y0); y < Math.floor(y0 + down); y++) {
      for (let x = Math.ceil(x0); x < Math.floor(x0 + across); x++) {
        const rgb = [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)];
        rgb.forEach((value, k) => (sums[k] += value));
        brightness.push(0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]);
      }
    }
    const n = brightness.length;
    const mean = brightness.reduce((a, b) => a + b) / n;
    const deviation = Math.sqrt(brightness.reduce((sum, b) => sum + (b - mean) ** 2, 0) / n);
    const [least, most] = brightness.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [255, 0]);
    return { colour: sums.map((sum) => sum / n), mean, deviation, contrast: most - least };
  };
  return { regionOf };
}
