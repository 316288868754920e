export { Constrainautor, Delaunator, Delaunator as default, Delaunay, LiveSet, NONE, Refused, Voronoi, earcut } from './index.js';
