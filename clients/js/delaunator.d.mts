import Delaunator from './delaunator.js';

export { Delaunator as default };
