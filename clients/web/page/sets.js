// The page shows the set that is chosen, if it exists, and explains what is missing.
import { given, keep } from './address.js';
import { isOpen, request } from './daemon.js';
import { suggestLayers } from './layers.js';
import { $, explain, fillSelect, makeButton, report, say } from './panel.js';
import { SAMPLES, follow, follower, forget, latest, on, refreshSoon } from './shown.js';

const FIRST = 'ireland'; // the set that is shown if the address names none

let wanted = null; // the name of the set that is to be shown, whether it exists or not
let dropped = null; // the name of a set that was dropped while it was shown
let hint = ''; // for a visitor who has not done anything yet

on({
  onDropped: (name) => {
    dropped = name;
    refreshSets();
  },
  onStat: explainSet,
});

/** start() is called before the first view of a visitor who has chosen nothing. */
export const first = { start() {} };

export function choose(name) {
  wanted = name;
  hint = '';
  keep({ set: name, view: null });
  return follow(name).catch(report);
}

export const refreshSets = latest(async () => {
  if (!isOpen()) return;
  const { rows } = await request('SETS');
  const names = rows.map((row) => row.slice(0, row.indexOf(' ')));
  if (wanted === null && given('set') === null && names.includes(FIRST)) beginFirst();
  wanted ??= given('set') ?? names[0] ?? null;
  if (!names.includes(follower.set) && follower.set !== null) forget();
  if (follower.set === null && names.includes(wanted)) await follow(wanted);
  fillSelect($('set'), names, follower.set);
  showSamples(names);
  if (follower.set === null) explainMissing(names);
});

/** Buttons for the sets that come with the page, if it has them. */
function showSamples(names) {
  const found = Object.keys(SAMPLES).filter((name) => names.includes(name));
  if ($('samples').children.length !== found.length) {
    $('samples').replaceChildren(...found.map((name) => makeButton(SAMPLES[name].title, () => choose(name))));
  }
  for (const [k, button] of [...$('samples').children].entries()) {
    button.value = found[k];
    button.setAttribute('aria-pressed', String(found[k] === follower.set));
  }
}

/** The first view: towns that can be dragged at once. */
function beginFirst() {
  wanted = FIRST;
  suggestLayers({ cells: true, hull: false });
  hint = 'Drag a town.';
  first.start();
}

/** The visitor has found out how to edit. */
export function endHint() {
  if (hint === '') return;
  hint = '';
  explain('');
}

function explainMissing(names) {
  say('');
  const choices = names.map((name) => [name, () => choose(name)]);
  const next = names.length === 0 ? 'The daemon has no sets yet.' : 'Choose another set:';
  if (wanted === null) explain(next);
  else explain(`The set ${wanted} ${wanted === dropped ? 'has been dropped' : 'does not exist'}. ${next}`, choices);
}

/** Explains why there are no triangles, if there are none; keys of STAT. */
function explainSet({ points, triangulated }) {
  const { set } = follower;
  if (triangulated !== 'yes' && points > 0) {
    const act = () => request(`TRIANGULATE ${set}`).then(refreshSoon, report);
    explain(`${set} has ${new Intl.NumberFormat().format(points)} points and is not triangulated.`, [['Triangulate', act]]);
  } else if (Number(points) === 0) {
    explain(`${set} is empty. Choose Edit, then double-click on the map to add a point.`);
  } else {
    explain(hint);
  }
}
