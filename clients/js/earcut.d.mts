import earcut from './earcut.js';

export const deviation: typeof earcut.deviation;
export const flatten: typeof earcut.flatten;
export { earcut as default };
