export { Delaunator, Delaunator as default, Delaunay, LiveSet, Refused, Voronoi } from './index.js';
