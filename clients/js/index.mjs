import delaunayd from './index.js';

export const { Client, Delaunator, Delaunay, Disconnected, NONE, Refused, Triangulation, connect, useServer } = delaunayd;
