// Files that are opened on the page, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { parse } from '../page/data/files.js';

const read = (name, text) => {
  const { xy, values, field, names, constraints } = parse(name, text);
  return [[...xy].join(' '), field, values && [...values].join(' '), [...names.values()].join(), constraints.flat().join(' ')];
};

test('tables: columns by their headings or in order, between commas, semicolons, tabulators or spaces', () => {
  const all = [
    ['name,lat,lon,height\n"A, ""or"" B",2,1,7\n\n# c\nC,4,3,\n', '1 2 3 4', 'height', '7 NaN', 'A, "or" B,C'],
    ['x;y\r\n1;2\r\n3;4', '1 2 3 4', null, null, ''],
    ['x\ty\r1\t2\r', '1 2', null, null, ''],
    ['1 2 3\n 4  5 6\n', '1 2 4 5', 'z', '3 6', ''],
  ];
  for (const [text, ...expected] of all) assert.deepEqual(read('a.csv', text), [...expected, '']);
});

test('GeoJSON: places, and constraints along lines and rings', () => {
  const geometries = [{ type: 'Point', coordinates: [9, 8, 7] }, { type: 'Polygon', coordinates: [[[0, 0], [1, 0], [0, 1], [0, 0]]] }];
  const feature = { type: 'Feature', properties: { name: 'A' }, geometry: { type: 'GeometryCollection', geometries } };
  assert.deepEqual(read('a.geojson', JSON.stringify(feature)), ['9 8 0 0 1 0 0 1 0 0', 'z', '7 NaN NaN NaN NaN', 'A,A,A,A,A', '1 2 2 3 3 4']);
});

test('what is no such file is refused with a reason', () => {
  const all = {
    'the file has no points': [['a.csv', ''], ['a.csv', '\n# c\n'], ['a.csv', 'x,y\n'], ['a.json', '[]'], ['a.json', '{"type":"Feature","geometry":null}']],
    'the first line names no columns x and y, or lon and lat': [['a.csv', 'a,b\n1,2'], ['a.csv', 'PK\x03\x04']],
    'line 2 has no two coordinates': [['a.csv', 'x;y\n1,5;2,5\n'], ['a.csv', 'x,y\n1;2\n'], ['a.csv', 'x,y\n1e400,2']],
    'a place has no two coordinates': [['a.json', '{"type":"LineString","coordinates":[[1,2],[3]]}'], ['a.json', '{"type":"Point","coordinates":["1","2"]}']],
    'this is not GeoJSON': [['a.json', '{'], ['a.json', 'null'], ['a.json', '{"features":[null]}'], ['a.json', '{"type":"Point","coordinates":5}']],
  };
  for (const [message, files] of Object.entries(all)) for (const [name, text] of files) assert.throws(() => read(name, text), { message }, text);
});
