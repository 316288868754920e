export * from './d3-delaunay.js';
