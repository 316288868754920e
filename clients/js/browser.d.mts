export { Constrainautor, Delaunator, Delaunator as default, Delaunay, LiveSet, Refused, Voronoi, earcut } from './index.js';
