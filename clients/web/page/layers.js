// The layers and colours that are chosen on the page or by the address, and the theme.
import { given, keep } from './address.js';
import { THEMES as LINES } from './drawing/overlay.js';
import { $, showLegend } from './panel.js';
import { overlay, scene } from './stage.js';
import { stepOf } from './drawing/steps.js';

const FIELD_LAYERS = ['coloured', 'hillshade', 'bands', 'contours'];
const LAYERS = ['triangles', 'hull', 'cells', 'points', 'names', ...FIELD_LAYERS];
const STEEP = 0.04; // the height of the hillshade's ground, in sizes of the set
const THEMES = {
  light: { fill: [0.16, 0.44, 0.69, 0.08], edge: [0.16, 0.4, 0.65, 0.85] },
  dark: { fill: [0.35, 0.6, 0.9, 0.1], edge: [0.5, 0.72, 0.95, 0.85] },
};
const LINES_ON_COLOURS = [0, 0, 0, 0.3];
const BESIDE_CELLS = 0.55; // of the opacity of lines, so that cells are seen, too

const dark = matchMedia('(prefers-color-scheme: dark)');
let shown = { field: null, size: 1 };

const isOn = (layer) => $(layer).checked;

/** The set that is shown has another field, {name, min, max} or null, or size: the longer side of the box around it. */
export function showField(field, size = shown.size) {
  shown = { field, size };
  applyStyle();
}

function applyStyle() {
  const { field, size } = shown;
  const theme = document.documentElement.dataset.theme;
  const { fill, edge } = THEMES[theme];
  const coloured = field !== null && isOn('coloured');
  scene.style = {
    fill: isOn('triangles') ? fill : [0, 0, 0, 0],
    edge: coloured ? LINES_ON_COLOURS : [...edge.slice(0, 3), isOn('cells') ? edge[3] * BESIDE_CELLS : edge[3]],
    coloured,
    edged: isOn('triangles'),
    range: field === null ? [0, 1] : [field.min, field.max],
    relief: field !== null && isOn('hillshade') ? (STEEP * size) / (field.max - field.min || 1) : 0,
    bands: field !== null && isOn('bands') ? stepOf(field) : 0,
  };
  for (const layer of Object.keys(overlay.layers)) overlay.layers[layer] = isOn(layer);
  overlay.colours = LINES[theme];
  overlay.stale();
  scene.stale();
  showLegend(coloured ? field : null);
  for (const layer of FIELD_LAYERS) $(layer).disabled = field === null;
}

/** Shows the theme that the address or an earlier choice names, or else that of the system. */
export function showTheme() {
  const name = given('theme') ?? localStorage.getItem('theme') ?? (dark.matches ? 'dark' : 'light');
  document.documentElement.dataset.theme = name === 'dark' ? 'dark' : 'light';
  applyStyle();
}

/** Chooses the theme that is not shown now. */
export function switchTheme() {
  const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
  localStorage.setItem('theme', theme);
  keep({ theme });
  showTheme();
}

/** Shows some layers, {layer: whether it is on}, unless the address says which. */
export function suggestLayers(layers) {
  if (given('layers') !== null) return;
  for (const [layer, on] of Object.entries(layers)) $(layer).checked = on;
  applyStyle();
}

/** Shows the layers of the address, or those that are chosen on the page, and the theme; onChange() is called when others are chosen. */
export function beginLayers(onChange) {
  const layers = given('layers')?.split(',');
  for (const layer of LAYERS) {
    if (layers !== undefined) $(layer).checked = layers.includes(layer);
    $(layer).addEventListener('change', () => {
      keep({ layers: LAYERS.filter(isOn).join(',') });
      applyStyle();
      onChange();
    });
  }
  dark.addEventListener('change', showTheme);
  showTheme();
}
