import delaunayd from './index.js';

export const { Client, Delaunator, Delaunay, Disconnected, Refused, Triangulation, connect, useServer } = delaunayd;
