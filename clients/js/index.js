// The package delaunayd, for require(); index.mjs is for import, browser.mjs for browsers.
'use strict';

const { Client, connect, useServer } = require('./lib/client.js');
const { Disconnected, Refused } = require('./lib/errors.js');
const { Triangulation } = require('./lib/triangulation.js');
const Delaunator = require('./delaunator.js');
const { Delaunay, Voronoi } = require('./d3-delaunay.js');
const { LiveSet, NONE } = require('./live.js');
const Constrainautor = require('./constrainautor.js');
const earcut = require('./earcut.js');

module.exports = {
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
};
