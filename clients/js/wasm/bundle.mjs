// Writes the files of the package that contain the compiled core: lib/module.js for Node, and browser.js, all that runs in process in one
// file for browsers.
//
//     node bundle.mjs                          browser.js, after a change of JavaScript
//     node bundle.mjs CORE.wasm COMPILER       both
import { readFileSync, writeFileSync } from 'node:fs';

const MODULES = ['lib/module', 'lib/errors', 'lib/values', 'lib/points', 'lib/core', 'lib/line', 'lib/mesh', 'lib/path', 'lib/voronoi'];
const ENTRIES = ['delaunator', 'd3-delaunay', 'live', 'constrainautor', 'earcut'];

const at = (name) => new URL(`../${name}`, import.meta.url);
const read = (name) => readFileSync(at(name), 'utf8');

const [wasm, compiler] = process.argv.slice(2);
if (wasm !== undefined) {
  const base64 = readFileSync(wasm).toString('base64');
  writeFileSync(at('lib/module.js'), `// The core, compiled by \`make wasm\`: ${compiler}; not to be edited.\nmodule.exports =\n  '${base64}';\n`);
}

/** A module as a function: `require` finds others by the last part of their names, which are different. */
const wrap = (name) => `modules['${name.split('/').pop()}.js'] = (module, require) => {\n${read(`${name}.js`)}};\n`;

writeFileSync(
  at('browser.js'),
  `// Delaunator, Delaunay, Voronoi, LiveSet, Constrainautor and earcut for browsers: globalThis.delaunayd, or import browser.mjs. Made of the files named below by
// \`make bundle\`; not to be edited.
(() => {
const modules = {};
const loaded = {};
const require = (path) => {
  const name = path.split('/').pop();
  if (!(name in loaded)) {
    const module = { exports: {} };
    modules[name](module, require);
    loaded[name] = module.exports;
  }
  return loaded[name];
};
${[...MODULES, ...ENTRIES].map(wrap).join('')}
globalThis.delaunayd = {
  Constrainautor: require('./constrainautor.js'),
  Delaunator: require('./delaunator.js'),
  earcut: require('./earcut.js'),
  ...require('./d3-delaunay.js'),
  ...require('./live.js'),
  Refused: require('./errors.js').Refused,
};
})();
`,
);
