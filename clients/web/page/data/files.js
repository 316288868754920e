// Points in files: CSV with a header or without, columns between spaces, GeoJSON, whose lines and polygons become constraints.

const X = /^(x|lon|lng|long|longitude|east|easting)$/i;
const Y = /^(y|lat|latitude|north|northing)$/i;
const NAME = /^(name|title|label|id)$/i;
const VALUE = /^(z|value|height|elevation|ele)$/i;

/** The fields of a line; quoted ones may have separators and doubled quotes. */
function fieldsOf(line, separator) {
  const fields = [];
  const pattern = new RegExp(`${separator}(?:\\s*"((?:[^"]|"")*)"\\s*|([^${separator}]*))`, 'g');
  for (const [, quoted, plain] of (separator + line).matchAll(pattern)) fields.push(quoted?.replaceAll('""', '"') ?? plain.trim());
  return fields;
}

const isNumber = (word) => word !== undefined && word !== '' && Number.isFinite(Number(word));

/** Reads the text of a file; its name says whether it is GeoJSON. Returns {xy, values, field, names}: coordinates x, y, ...; values
 * (null if there are none) of a field; names by id; constraints, pairs of ids. Throws an Error that names the line. */
export function parse(fileName, text) {
  if (!/json$/i.test(fileName)) return parseTable(text);
  try {
    return parseGeoJSON(JSON.parse(text));
  } catch (error) {
    throw error instanceof TypeError || error instanceof SyntaxError ? new Error('this is not GeoJSON') : error;
  }
}

function parseTable(text) {
  const lines = text.split(/\r\n?|\n/).map((line, k) => ({ line, number: k + 1 })).filter(({ line }) => line.trim() !== '' && line[0] !== '#');
  if (lines.length === 0) throw new Error('the file has no points');
  const separator = ['\t', ';', ','].find((character) => lines[0].line.includes(character)); // with semicolons commas are decimal
  const split = separator === undefined ? (line) => line.trim().split(/\s+/) : (line) => fieldsOf(line, separator);
  const head = split(lines[0].line);
  const hasHeader = !(isNumber(head[0]) && isNumber(head[1]));
  const columnOf = (pattern) => (hasHeader ? head.findIndex((word) => pattern.test(word)) : -1);
  let [x, y, name, value] = [columnOf(X), columnOf(Y), columnOf(NAME), columnOf(VALUE)];
  if (!hasHeader) [x, y, value] = [0, 1, isNumber(head[2]) ? 2 : -1];
  if (x < 0 || y < 0) throw new Error('the first line names no columns x and y, or lon and lat');
  const points = lines.slice(hasHeader ? 1 : 0).map(({ line, number }) => {
    const words = split(line);
    if (!isNumber(words[x]) || !isNumber(words[y])) throw new Error(`line ${number} has no two coordinates`);
    return { place: [Number(words[x]), Number(words[y])], value: isNumber(words[value]) ? Number(words[value]) : NaN, name: words[name] };
  });
  return collect(points, value < 0 ? null : fieldName(hasHeader ? head[value] : 'z'));
}

const fieldName = (word) => word.toLowerCase().replace(/[^a-z0-9_]/g, '_');

function parseGeoJSON(json) {
  const points = [];
  const constraints = [];
  const visit = (geometry, name) => {
    const { type, coordinates, geometries = [] } = geometry ?? {};
    for (const part of geometries) visit(part, name);
    const depth = { Point: 0, MultiPoint: 0, LineString: 0, MultiLineString: 1, Polygon: 1, MultiPolygon: 2 }[type];
    if (depth === undefined) return;
    for (const line of type === 'Point' ? [[coordinates]] : [coordinates].flat(depth)) {
      for (const [k, [px, py, z]] of line.entries()) {
        if (k > 0 && !type.endsWith('Point')) constraints.push([points.length - 1, points.length]);
        points.push({ place: [px, py], value: z ?? NaN, name });
      }
    }
  };
  for (const { geometry, properties } of json.features ?? [json.type === 'Feature' ? json : { geometry: json }]) visit(geometry, properties?.name);
  if (!points.every(({ place }) => place.every(Number.isFinite))) throw new Error('a place has no two coordinates');
  return { ...collect(points, points.some(({ value }) => !Number.isNaN(value)) ? 'z' : null), constraints };
}

function collect(points, field) {
  if (points.length === 0) throw new Error('the file has no points');
  const names = new Map();
  points.forEach(({ name }, id) => typeof name === 'string' && name !== '' && names.set(id, name));
  return {
    xy: Float64Array.from(points.flatMap(({ place }) => place)),
    values: field === null ? null : Float64Array.from(points, ({ value }) => value),
    field,
    names,
    constraints: [],
  };
}
