// What bundlers for browsers make of `import earcut from 'delaunayd/earcut'`.
import { earcut } from './browser.mjs';

export const { deviation, flatten } = earcut;
export { earcut as default };
