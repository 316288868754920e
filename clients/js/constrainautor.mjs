import Constrainautor from './constrainautor.js';

export { Constrainautor as default };
