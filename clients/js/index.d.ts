import Constrainautor = require('./constrainautor');
import Delaunator = require('./delaunator');
import earcut = require('./earcut');
import { Delaunay, Voronoi } from './d3-delaunay';
import { LiveSet } from './live';
import { Table } from './table';

export { Constrainautor, Delaunator, Delaunay, LiveSet, Voronoi, earcut };

/** Flat coordinates (x, y, x, y ...) or pairs; further coordinates of a point are not read. */
export type Points = ArrayLike<number> | Iterable<readonly [number, number]> | Iterable<ArrayLike<number>>;

/** Ids, flat or as pairs. */
export type Pairs = ArrayLike<number> | Iterable<readonly [number, number]>;

/** For points of any other type. */
export interface Accessors<P> {
  getX?: (p: P) => number;
  getY?: (p: P) => number;
}

export interface Reply {
  /** The values of the status line by key, as text. */
  keys: Record<string, string>;
  rows: string[];
  /** The bytes of a binary reply. */
  data: Uint8Array | null;
}

/** A part of the results of triangulate(), check() and stat(). */
export type Summary = Omit<Awaited<ReturnType<Table['check']>>, 'delaunay'>;

/** `version` grows with every change of the set. */
export type Stat = Awaited<ReturnType<Table['stat']>>;

export interface Point {
  id: number;
  x: number;
  y: number;
}

export interface Neighbour extends Point {
  distance: number;
}

export interface Located {
  where: 'inside' | 'edge' | 'vertex' | 'outside';
  ids: number[];
}

export interface RequestOptions {
  /** Milliseconds after which the server cancels the request (code TIMEOUT); 0: no limit. */
  timeout?: number;
  progress?: (text: string) => void;
}

export interface ClientOptions {
  /** For requests without a timeout of their own, in milliseconds; 0, the default: no limit. */
  timeout?: number;
  /** In milliseconds; 10000 by default. */
  connectTimeout?: number;
  /** Whether the process may end while this client is connected and no request is under way. */
  unref?: boolean;
}

export interface FieldFacts {
  /** Points that have a value. */
  count: number;
  /** NaN if there are none. */
  least: number;
  most: number;
}

export type Box = readonly [x0: number, y0: number, x1: number, y1: number] | ArrayLike<number>;

export interface SurfaceOptions extends RequestOptions {
  /** linear by default. */
  method?: 'linear' | 'natural' | 'laplace' | 'nearest' | 'smooth';
  /** No values in triangles with a longer edge. */
  maxEdge?: number;
  /** No values outside. */
  inside?: Inside;
  /** Outside the hull NaN, or the value at the nearest place of the hull; nan by default. */
  outside?: 'nan' | 'nearest';
  /** Points without a value: NaN around them, or as if they had been deleted; nan by default. */
  missing?: Missing;
}

export interface RasterOptions extends SurfaceOptions {
  /** The name of a set, inside whose borders alone there are values. */
  clip?: string;
}

/** Of linear surfaces inside the hull. */
export type PlainOptions = Omit<SurfaceOptions, 'method' | 'outside'>;

/** Either levels, or base, 0 by default, and all multiples of `every` from it. */
export type LevelOptions = PlainOptions & { levels?: Iterable<number>; every?: number; base?: number };

/** A loop of the boundary of a shape, with the shape on its left, so the loop of a hole is clockwise. */
export interface Loop {
  hole: boolean;
  ids: Uint32Array;
}

export type Missing = 'nan' | 'skip';

/** One field, or several, whose values follow each other. */
export type Fields = string | readonly string[];

/** The number of a border; true: any of them. */
export type Inside = number | boolean;

/** The kind of constraints, borders or lines, and the number of their line or polygon, 0 by default. */
export interface WhichConstraints {
  border?: boolean;
  number?: number;
}

/** With `split`, constraints that cross get points in common. */
export type ConstrainOptions = WhichConstraints & RequestOptions & { split?: boolean };

/** added: new constraints; with `split`: new points, from the id `first` on. */
export interface Constrained {
  added: number;
  first?: number;
  split?: number;
  deviation?: number;
}

/** Limits of triangles inside borders: degrees, area, length of an edge; and of the points that may be added. */
export interface RefineOptions extends RequestOptions {
  angle?: number;
  area?: number;
  length?: number;
  inside?: Inside;
  keep?: boolean;
  limit?: number;
}

/** New points from the id `first` on, constraints that were divided, the least angle, triangles that are not as wanted, and edges of the
 * hull that became border 0. */
export interface Refined {
  first: number;
  added: number;
  split: number;
  angle: number;
  unrefined: number;
  hull: number;
}

export interface Region {
  closed: boolean;
  triangles: number;
  area: number;
}

export interface ContourLine {
  level: number;
  closed: boolean;
  /** x, y, x, y ...; higher ground is on the left, and a closed line does not repeat its first place. */
  coords: Float64Array;
}

/** A polygon between two levels, which may be infinite; the first ring is the outer one, counterclockwise. */
export interface BandPolygon {
  type: 'Polygon';
  low: number;
  high: number;
  coordinates: [number, number][][];
}

/** As d3-contour's. */
export interface ContourPolygons {
  type: 'MultiPolygon';
  value: number;
  coordinates: [number, number][][][];
}

/** Voronoi cells; the one of ids[i] has the corners offsets[i] .. offsets[i + 1] of coords. */
export interface Cells {
  box: [number, number, number, number];
  ids: Uint32Array;
  offsets: Uint32Array;
  coords: Float64Array;
  /** Closed, as d3-delaunay's; null if the cell is not in the box. */
  cellPolygon(id: number): [number, number][] | null;
  cellPolygons(): IterableIterator<[number, number][] & { index: number }>;
}

/** The server replied ERR; the connection is still usable. */
export class Refused extends Error {
  /** The word after ERR: NOSET, RANGE, TIMEOUT ... */
  code: string;
}

/** The connection ended before the reply arrived: an edit may or may not have been carried out. */
export class Disconnected extends Error {
  code: string;
}

export interface LoadOptions extends RequestOptions {
  /** Values of all points by the name of the field; NaN where one is missing. */
  fields?: Record<string, ArrayLike<number>>;
}

/** Made by connect(). Requests may be made without waiting for one another. */
export interface Client extends Table {}
export class Client {
  private constructor();
  close(): void;
  request(line: string, options?: RequestOptions & { body?: Uint8Array }): Promise<Reply>;
  sets(options?: RequestOptions): Promise<string[]>;
  create(set: string, tolerance?: number, options?: RequestOptions & { temporary?: boolean }): Promise<void>;
  load(set: string, points: Points, options?: LoadOptions): Promise<number>;
  load<P>(set: string, points: Iterable<P>, options: Accessors<P> & LoadOptions): Promise<number>;
  add(set: string, x: number, y: number, options?: RequestOptions): Promise<number>;
  /** Moves a point, which keeps its id. */
  move(set: string, id: number, x: number, y: number, options?: RequestOptions): Promise<void>;
  get(set: string, ids: Iterable<number>, options?: RequestOptions): Promise<Point[]>;
  points(set: string, options?: RequestOptions): Promise<{ ids: Uint32Array; coords: Float64Array }>;
  points(
    set: string,
    options: RequestOptions & { fields: Fields },
  ): Promise<{ ids: Uint32Array; coords: Float64Array; values?: Record<string, Float64Array> }>;
  coincident(set: string, options?: RequestOptions): Promise<Map<number, number>>;
  triangles(set: string, options?: RequestOptions & { clockwise?: boolean; within?: Box; inside?: Inside }): Promise<Uint32Array>;
  edges(set: string, options?: RequestOptions & { constrained?: boolean; inside?: Inside }): Promise<Uint32Array>;
  lists(set: string, options?: RequestOptions & { within?: Box }): Promise<Map<number, Uint32Array>>;
  hull(set: string, options?: RequestOptions & { clockwise?: boolean }): Promise<Uint32Array>;
  locate(set: string, x: number, y: number, options?: RequestOptions): Promise<Located>;
  nearest(set: string, x: number, y: number, k?: number, options?: RequestOptions): Promise<Neighbour[]>;
  locateAll(set: string, places: Points, options?: RequestOptions): Promise<Uint32Array>;
  locateAll<P>(set: string, places: Iterable<P>, options: Accessors<P> & RequestOptions): Promise<Uint32Array>;
  nearestAll(set: string, places: Points, k?: number, options?: RequestOptions): Promise<Uint32Array>;
  nearestAll<P>(set: string, places: Iterable<P>, k: number, options: Accessors<P> & RequestOptions): Promise<Uint32Array>;
  within(set: string, x0: number, y0: number, x1: number, y1: number): Promise<number[]>;
  within(set: string, x: number, y: number, r: number): Promise<number[]>;
  fields(set: string, options?: RequestOptions): Promise<Record<string, FieldFacts>>;
  getField(set: string, field: string, ids: Iterable<number>, options?: RequestOptions): Promise<Float64Array>;
  field(set: string, field: string, options?: RequestOptions): Promise<{ ids: Uint32Array; values: Float64Array }>;
  setField(set: string, field: string, values: ArrayLike<number>, options?: RequestOptions & { first?: number }): Promise<void>;
  weights(
    set: string,
    x: number,
    y: number,
    options?: RequestOptions & { method?: 'linear' | 'natural' | 'laplace' },
  ): Promise<Map<number, number>>;
  interpolate(set: string, field: Fields, places: Points, options?: SurfaceOptions): Promise<Float64Array>;
  interpolate<P>(set: string, field: Fields, places: Iterable<P>, options: Accessors<P> & SurfaceOptions): Promise<Float64Array>;
  gradient(set: string, field: Fields, places: Points, options?: PlainOptions): Promise<Float64Array>;
  gradient<P>(set: string, field: Fields, places: Iterable<P>, options: Accessors<P> & PlainOptions): Promise<Float64Array>;
  raster(
    set: string,
    field: Fields,
    box: Box,
    columns: number,
    rows: number,
    options?: RasterOptions & { quantity?: 'slope' | 'aspect' },
  ): Promise<Float64Array>;
  contourLines(set: string, field: string, options: LevelOptions): Promise<ContourLine[]>;
  bands(set: string, field: string, options: LevelOptions): Promise<BandPolygon[]>;
  contours(set: string, field: string, levels: Iterable<number>, options?: RequestOptions): Promise<ContourPolygons[]>;
  profile(set: string, field: string, places: Points, options?: PlainOptions): Promise<Float64Array>;
  profile<P>(set: string, field: string, places: Iterable<P>, options: Accessors<P> & PlainOptions): Promise<Float64Array>;
  volume(
    set: string,
    field: string,
    options?: RequestOptions & { level?: number; minus?: string; inside?: Inside; missing?: Missing; box?: Box },
  ): Promise<{ above: number; below: number; area: number }>;
  voronoi(set: string, options?: RequestOptions & { ids?: Iterable<number>; box?: Box }): Promise<Cells>;
  alpha(set: string, radius: number, options?: RequestOptions): Promise<Loop[]>;
  alphaAuto(set: string, options?: RequestOptions): Promise<{ radius: number; loops: Loop[] }>;
  simplify(
    set: string,
    field: string,
    error: number,
    into: string,
    options?: RequestOptions & { points?: number; ids?: string },
  ): Promise<{ points: number; constraints: number; error: number }>;
  areas(set: string, options?: RequestOptions & { box?: Box }): Promise<{ ids: Uint32Array; areas: Float64Array }>;
  constrain(set: string, ends: Pairs, options?: ConstrainOptions): Promise<Constrained>;
  constrainPath(set: string, ids: Iterable<number>, options?: ConstrainOptions & { closed?: boolean }): Promise<Constrained>;
  refine(set: string, options?: RefineOptions): Promise<Refined>;
  release(set: string, ends: Pairs, options?: WhichConstraints & RequestOptions): Promise<number>;
  /** Of all kinds if there is no number. */
  releaseAll(set: string, options?: WhichConstraints & RequestOptions): Promise<number>;
  constraints(
    set: string,
    options?: { ids?: Iterable<number>; number?: number } & RequestOptions,
  ): Promise<{ ends: Uint32Array; border: Uint8Array; number: Uint32Array }>;
  regions(set: string, options?: RequestOptions): Promise<{ triangles: number; area: number; borders: Map<number, Region> }>;
  quality(
    set: string,
    options?: { inside?: Inside } & RequestOptions,
  ): Promise<{ triangles: number; area: number; angle: number; largest: number; shortest: number; longest: number; counts: number[] }>;
  regionsAt(set: string, places: Points, options?: RequestOptions): Promise<number[][]>;
  regionsAt<P>(set: string, places: Iterable<P>, options: Accessors<P> & RequestOptions): Promise<number[][]>;
  /** fields: for each name the values of each path. */
  loadPaths(
    set: string,
    paths: Iterable<Points>,
    options?: ConstrainOptions & { fields?: Record<string, ArrayLike<ArrayLike<number>>> },
  ): Promise<{ first: number; added: number; coincident: number; constraints: number; split?: number; deviation?: number }>;
  mirror(set: string, options?: { within?: Box; fields?: Fields }): Promise<Mirror>;
  info(options?: RequestOptions): Promise<Record<string, string | number | boolean>>;
}

/** A constraint, a < b; a border or else a line. */
export interface Constraint {
  a: number;
  b: number;
  border: boolean;
  number: number;
  /** In a mirror of a box: x and y of a and of b, which may be outside. */
  places?: number[];
}

/** The difference between two versions of a set. */
export interface Change {
  version: number;
  /** The server sent everything; the rest is still the difference. */
  reset: boolean;
  /** Ids of points, ascending; moved: they have other coordinates, or another value. */
  added: Uint32Array;
  moved: Uint32Array;
  gone: Uint32Array;
  /** Three ids a triangle, counterclockwise from the smallest, in no order. */
  trianglesAdded: Uint32Array;
  trianglesRemoved: Uint32Array;
  /** Sorted; in a mirror of a box those that come to meet it or do not any more, and the first also those whose ends have moved. */
  constraintsAdded: Constraint[];
  constraintsReleased: Constraint[];
}

/** A copy of a set that follows it, over a connection of its own, until it is closed or the set is dropped. An EventEmitter. A
 * change costs time in proportion to its size; each point takes a few hundred bytes. Made by Client.mirror(). */
export interface Mirror {
  readonly version: number;
  /** The number of points. */
  readonly size: number;
  /** x, y and the values of the fields asked for. */
  point(id: number): readonly number[] | undefined;
  /** Counterclockwise, in the order of LISTS; undefined if there is no such point, for aliases, and before TRIANGULATE. */
  neighbors(id: number): readonly number[] | undefined;
  /** As Client.points(), lists() and triangles(), without a request. */
  points(): { ids: Uint32Array; coords: Float64Array; values?: Record<string, Float64Array> };
  lists(): Map<number, Uint32Array>;
  triangles(): Uint32Array;
  /** In the order of CONSTRAINTS; of a box those that meet it. */
  constraints(): readonly Readonly<Constraint>[];
  /** Resolves when the copy has this version or a later one. Rejects with the code CLOSED or DROPPED. */
  reached(version: number): Promise<void>;
  close(): void;
  /** The copy has just become that of change.version. */
  on(event: 'change', listener: (change: Change) => void): this;
  /** The connection is lost; the mirror connects again by itself, and the next change is the difference. */
  on(event: 'lost', listener: (error: Error) => void): this;
  on(event: 'resumed' | 'dropped', listener: () => void): this;
  once(event: 'change', listener: (change: Change) => void): this;
  once(event: 'lost', listener: (error: Error) => void): this;
  once(event: 'resumed' | 'dropped', listener: () => void): this;
  off(event: string, listener: (...words: any[]) => void): this;
}

/** The value for a missing id in the results of locateAll and nearestAll, and of LiveSet. */
export const NONE: 0xffffffff;

/**
 * Connects. The URL is delaunay://[:token@]host[:port], unix://[:token@]/path, or private: for a daemon of this process. Without
 * one: $DELAUNAY_URL, or else localhost:6374, or else, if no server listens there, a private daemon.
 */
export function connect(url?: string, options?: ClientOptions): Promise<Client>;

/** Sets the server of Triangulation.from() for later calls; a URL as in connect(). */
export function useServer(url?: string, options?: { timeout?: number }): void;

export interface TriangulationOptions {
  /** By default a shared one, connected as by connect() without a URL. */
  client?: Client;
  /** In a plane whose y axis points up. */
  clockwise?: boolean;
}

/** A triangulation with the fields of Delaunator's, computed without blocking. */
export class Triangulation {
  private constructor();
  coords: Float64Array;
  triangles: Uint32Array;
  halfedges: Int32Array;
  hull: Uint32Array;
  static from(points: Points, options?: TriangulationOptions): Promise<Triangulation>;
  static from<P>(points: Iterable<P>, options: TriangulationOptions & Accessors<P>): Promise<Triangulation>;
  /** After a change of coords. */
  update(): Promise<this>;
}
