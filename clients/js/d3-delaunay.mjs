import d3 from './d3-delaunay.js';

export const { Delaunay } = d3;
/** d3-delaunay's own; undefined if that is not installed. */
export const Voronoi = (() => {
  try {
    return d3.Voronoi;
  } catch {
    return undefined;
  }
})();
