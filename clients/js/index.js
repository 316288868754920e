// The package delaunayd, for require(); index.mjs is for import.
'use strict';

const { Client, NONE, connect } = require('./lib/client.js');
const { Disconnected, Refused } = require('./lib/errors.js');
const { Triangulation } = require('./lib/triangulation.js');
const Delaunator = require('./delaunator.js');
const { Delaunay } = require('./d3-delaunay.js');
const { useServer } = require('./lib/sync.js');

module.exports = { Client, Delaunator, Delaunay, Disconnected, NONE, Refused, Triangulation, connect, useServer };
