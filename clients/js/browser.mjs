// The classes that compute in process, for browsers and bundlers: `import Delaunator from`, `import { Delaunay } from`.
import './browser.js';

export const { Delaunator, Delaunay, LiveSet, Refused, Voronoi } = globalThis.delaunayd;
export { Delaunator as default };
