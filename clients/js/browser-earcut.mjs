// The module that bundlers for browsers use for `import earcut from 'delaunayd/earcut'`.
import { earcut } from './browser.mjs';

export const { deviation, flatten, refine } = earcut;
export { earcut as default };
