import d3 from './d3-delaunay.js';

export const { Delaunay, Voronoi } = d3;
