import earcut from './earcut.js';

export const deviation: typeof earcut.deviation;
export const flatten: typeof earcut.flatten;
export const refine: typeof earcut.refine;
export { earcut as default };
