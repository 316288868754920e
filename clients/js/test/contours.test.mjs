// Contour polygons from lines, without a daemon.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { describe, it as test } from 'node:test';

const { bordersOf, contourOf, multiPolygon } = createRequire(import.meta.url)('../lib/surfaces.js');

const square = (z) => [[0, 0, z[0]], [4, 0, z[1]], [4, 4, z[2]], [0, 4, z[3]]];

describe('contour polygons', () => {
  test('rows become lines', () => {
    assert.deepEqual(contourOf('-1.5 open 2 0 0 1e-7 2'), { level: -1.5, closed: false, coords: Float64Array.of(0, 0, 1e-7, 2) });
    assert.equal(contourOf('7 closed 3 0 0 1 0 0 1').closed, true);
  });

  test('a summit is a ring, a hollow a hole in the hull', () => {
    const summit = contourOf('5 closed 4 1 1 3 1 3 3 1 3');
    assert.deepEqual(multiPolygon([summit], [square([0, 0, 0, 0])], 5), {
      type: 'MultiPolygon',
      value: 5,
      coordinates: [[[[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]]]],
    });
    const hollow = contourOf('5 closed 4 1 1 1 3 3 3 3 1');
    assert.deepEqual(multiPolygon([hollow], [square([9, 9, 9, 9])], 5).coordinates, [
      [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], [[1, 1], [1, 3], [3, 3], [3, 1], [1, 1]]],
    ]);
  });

  test('a line that ends on the hull is closed along it, higher ground on the left', () => {
    const slope = contourOf('5 open 2 2 0 2 4'); // falls from the west to the east
    assert.deepEqual(multiPolygon([slope], [square([10, 0, 0, 10])], 5).coordinates, [[[[2, 0], [2, 4], [0, 4], [0, 0], [2, 0]]]]);
    const rise = contourOf('5 open 2 2 4 2 0');
    assert.deepEqual(multiPolygon([rise], [square([0, 10, 10, 0])], 5).coordinates, [[[[2, 4], [2, 0], [4, 0], [4, 4], [2, 4]]]]);
  });

  test('a ridge between two lines is one polygon', () => {
    const lines = ['5 open 2 3 0 4 1', '5 open 2 1 4 0 3'].map(contourOf);
    const { coordinates } = multiPolygon(lines, [square([8, 4, 8, 4])], 5);
    assert.equal(coordinates.length, 1);
    assert.equal(coordinates[0][0].length, 7);
  });

  test('without a line it is all of the hull or nothing', () => {
    assert.deepEqual(multiPolygon([], [square([5, 5, 5, 5])], 5).coordinates, [[[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]]]);
    assert.deepEqual(multiPolygon([], [square([4, 4, 4, 4])], 5).coordinates, []);
    assert.deepEqual(multiPolygon([], [], 5).coordinates, []);
  });

  test('a hole that touches the ring around it at all of its corners is in it', () => {
    const lines = ['5 closed 4 2 0 4 2 2 4 0 2', '5 closed 3 2 0 2 4 4 2'].map(contourOf);
    assert.deepEqual(multiPolygon(lines, [square([0, 0, 0, 0])], 5).coordinates, [
      [[[2, 0], [4, 2], [2, 4], [0, 2], [2, 0]], [[2, 0], [2, 4], [4, 2], [2, 0]]],
    ]);
  });

  test('lines of one place on a border do not count', () => {
    assert.deepEqual(multiPolygon([], [square([5, 0, 0, 0])], 5).coordinates, []);
    assert.equal(multiPolygon([], [square([5 - 1e-15, 9, 9, 9])], 5).coordinates.length, 1);
  });

  test('the border of a surface goes around missing values', () => {
    const coords = [0, 0, 4, 0, 4, 4, 0, 4, 2, 2];
    const triangles = [0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 3, 4];
    const border = (z) => bordersOf(triangles, [0, 1, 2, 3, 4], coords, z).map((ring) => ring.map(([, , height]) => height));
    assert.deepEqual(border([1, 2, 3, 4, 5]), [[1, 2, 3, 4]]);
    assert.deepEqual(border([1, 2, NaN, 4, 5]), [[1, 2, 5, 4]]);
    assert.deepEqual(border([1, 2, 3, 4, NaN]), []);
  });

  test('two surfaces that touch at a point have a border each', () => {
    const coords = [0, 0, 2, 0, 2, 2, 4, 2, 4, 4];
    const borders = bordersOf([0, 1, 2, 2, 3, 4], [0, 1, 2, 3, 4], coords, [1, 2, 3, 4, 5]);
    assert.deepEqual(borders.map((ring) => ring.map(([, , z]) => z)), [[1, 2, 3], [3, 4, 5]]);
  });
});
