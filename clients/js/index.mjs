import delaunayd from './index.js';

export const { Client, Delaunator, Delaunay, Disconnected, LiveSet, NONE, Refused, Triangulation, Voronoi, connect, useServer } = delaunayd;
