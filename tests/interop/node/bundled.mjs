// Bundled for browsers, then run: each entry of the package has its own class, by import.
import { LiveSet } from 'delaunayd';
import Constrainautor from 'delaunayd/constrainautor';
import { Delaunay } from 'delaunayd/d3-delaunay';
import Delaunator from 'delaunayd/delaunator';
import earcut, { deviation, flatten, refine } from 'delaunayd/earcut';

const square = [0, 0, 9, 0, 9, 9, 0, 9, 2, 2, 7, 2, 7, 7, 2, 7];
const parts = [
  new Delaunator([0, 0, 1, 0, 0, 1]).triangles.join(),
  Delaunay.from([[0, 0], [1, 0], [0, 1]]).voronoi([0, 0, 1, 1]).cellPolygon(1).length,
  new Constrainautor(Delaunator.from([[150, 50], [50, 200], [150, 350], [250, 200]])).constrainOne(0, 2),
  earcut(square, [4]).length,
  LiveSet.from(square).size,
];
if (deviation(square, [4], 2, earcut(square, [4])) !== 0) throw new Error('deviation');
if (flatten([[[1, 2]]]).vertices.length !== 2) throw new Error('flatten');
if (parts.join(' ') !== '0,2,1 5 3 24 8') throw new Error(parts.join(' '));
