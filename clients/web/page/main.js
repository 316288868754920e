// The page: follows one set of the daemon and shows it. Start reading here; sets.js decides which set, shown.js what is shown of it,
// hands.js what mouse, touch and keyboard do; stage.js draws.
import { countWaits } from './data/connection.js';
import { connection, converse } from './daemon.js';
import { listen } from './hands.js';
import { beginLayers } from './layers.js';
import { openFile } from './open.js';
import { $, report, showWait } from './panel.js';
import { savePNG, saveSVG } from './save.js';
import { choose, refreshSets } from './sets.js';
import { SAMPLES, follow, follower, refreshSoon, resume, showFacts } from './shown.js';
import { canvas, marks, mesh, overlay, resize, scene, view } from './stage.js';

const SETS_MS = 3000;

function listenToPanel() {
  $('set').addEventListener('change', () => choose($('set').value));
  $('field').addEventListener('change', () => follow(follower.set, { keepView: true }).catch(report));
  $('angles').addEventListener('toggle', refreshSoon);
  $('png').addEventListener('click', () => follower.set !== null && savePNG(follower.set));
  $('svg').addEventListener('click', () => follower.set !== null && saveSVG(follower.set));
  $('file').addEventListener('change', () => {
    const [file] = $('file').files;
    $('file').value = ''; // so that the same file may be chosen again
    if (file !== undefined) openFile(file);
  });
  addEventListener('dragover', (e) => e.preventDefault());
  addEventListener('drop', (e) => {
    e.preventDefault();
    if (e.dataTransfer.files.length > 0) openFile(e.dataTransfer.files[0]);
  });
  $('sheet').addEventListener('click', () => {
    const isOpen = document.body.classList.toggle('closed') === false;
    $('sheet').textContent = isOpen ? 'Hide' : 'Show';
    $('sheet').setAttribute('aria-expanded', String(isOpen));
  });
  addEventListener('hashchange', () => location.reload());
}

beginLayers(refreshSoon);
resize();
listen();
listenToPanel();
new ResizeObserver(() => {
  resize();
  refreshSoon();
}).observe(canvas.mesh.parentElement);
converse({
  files: Object.fromEntries(Object.entries(SAMPLES).map(([name, { file }]) => [name, file])),
  onEvent: (event) => follower.onEvent(event),
  begin: async () => {
    await resume();
    await refreshSets();
  },
});
setInterval(showFacts, 1000);
setInterval(refreshSets, SETS_MS);
setInterval(() => showWait(countWaits(), scene.isLost ? 'waiting for WebGL' : ''), 1000);
export { connection, follower, marks, mesh, overlay, scene, view }; // for tests
