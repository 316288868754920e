import earcut from './earcut.js';

export const { deviation, flatten, refine } = earcut;
export { earcut as default };
