// The classes that compute in process, for browsers and bundlers: `import Delaunator from`, `import { Delaunay } from`.
import './browser.js';

export const { Constrainautor, Delaunator, Delaunay, LiveSet, NONE, Refused, Voronoi, earcut } = globalThis.delaunayd;
export { Delaunator as default };
