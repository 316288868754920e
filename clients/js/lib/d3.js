// The package d3-delaunay, where it is installed. It is an ES module, which Node before 22 cannot load at once; the same
// package has a bundle for browsers, which any Node can.
'use strict';

const { readFileSync } = require('node:fs');
const { createRequire } = require('node:module');
const path = require('node:path');
const { compileFunction } = require('node:vm');

let found = null;

/** Its path: beside this package, or among the packages of the running program. */
function findMain() {
  const from = [__filename, process.argv[1], path.join(process.cwd(), 'x.js')].filter((name) => name && path.isAbsolute(name));
  for (const name of from) {
    try {
      return createRequire(name).resolve('d3-delaunay');
    } catch {
      // not there
    }
  }
  throw new Error('Voronoi diagrams need the package d3-delaunay: npm install d3-delaunay');
}

function load(main) {
  const file = path.join(path.dirname(main), '..', 'dist', 'd3-delaunay.js');
  const module = { exports: {} };
  compileFunction(readFileSync(file, 'utf8'), ['module', 'exports'], { filename: file })(module, module.exports);
  return module.exports;
}

/** Its exports, {Delaunay, Voronoi}. */
function findVoronoi() {
  found ??= load(findMain());
  return found;
}

module.exports = { findVoronoi };
