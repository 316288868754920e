// Bundled for browsers, then run: each entry of the package has its own class, by require.
const { LiveSet } = require('delaunayd');
const Constrainautor = require('delaunayd/constrainautor');
const { Delaunay } = require('delaunayd/d3-delaunay');
const Delaunator = require('delaunayd/delaunator');
const earcut = require('delaunayd/earcut');

const square = [0, 0, 9, 0, 9, 9, 0, 9, 2, 2, 7, 2, 7, 7, 2, 7];
const parts = [
  new Delaunator([0, 0, 1, 0, 0, 1]).triangles.join(),
  Delaunay.from([[0, 0], [1, 0], [0, 1]]).voronoi([0, 0, 1, 1]).cellPolygon(1).length,
  new Constrainautor(Delaunator.from([[150, 50], [50, 200], [150, 350], [250, 200]])).constrainOne(0, 2),
  earcut(square, [4]).length,
  LiveSet.from(square).size,
];
if (parts.join(' ') !== '0,2,1 5 3 24 8') throw new Error(parts.join(' '));
