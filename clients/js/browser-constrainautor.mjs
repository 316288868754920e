// What bundlers for browsers make of `import Constrainautor from 'delaunayd/constrainautor'`.
export { Constrainautor as default } from './browser.mjs';
