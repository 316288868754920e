import delaunayd from './index.js';

export const {
  Client,
  Constrainautor,
  Delaunator,
  Delaunay,
  Disconnected,
  LiveSet,
  NONE,
  Refused,
  Triangulation,
  Voronoi,
  connect,
  earcut,
  useServer,
} = delaunayd;
