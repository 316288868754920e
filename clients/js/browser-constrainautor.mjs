// The module that bundlers for browsers use for `import Constrainautor from 'delaunayd/constrainautor'`.
export { Constrainautor as default } from './browser.mjs';
