import earcut from './earcut.js';

export const { deviation, flatten } = earcut;
export { earcut as default };
