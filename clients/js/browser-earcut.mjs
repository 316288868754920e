// What bundlers for browsers make of `import earcut from 'delaunayd/earcut'`.
import { earcut } from './browser.mjs';

export const { deviation, flatten, refine } = earcut;
export { earcut as default };
