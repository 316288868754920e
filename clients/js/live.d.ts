import { Accessors, Box, Points } from './index';

/** A set of points in process that stays triangulated while points come, go and move. Errors have the codes of the daemon
 * (NUMBER, RANGE, NOPOINT, NOEDGE, NOFIELD, CROSSES, CONSTRAINED, NOCONSTRAINT, NOTDELAUNAY, NOMEM). Its memory is given back when the object is collected, or by free(). */
export class LiveSet {
  static from(points: Points, options?: LiveSetOptions & { values?: ArrayLike<number> }): LiveSet;
  static from<P>(points: Iterable<P>, options: LiveSetOptions & Accessors<P> & { values?: ArrayLike<number> }): LiveSet;
  constructor(options?: LiveSetOptions);
  free(): void;
  /** The number of points. */
  readonly size: number;
  /** The id that the next point will get. */
  readonly nextId: number;

  /** Adds points, all or none; returns the id of the first one, the others follow. */
  add(points: Points, options?: { values?: ArrayLike<number> }): number;
  add<P>(points: Iterable<P>, options: Accessors<P> & { values?: ArrayLike<number> }): number;
  /** Deletes points, all or none; returns how many. */
  delete(ids: Iterable<number>): number;
  move(id: number, x: number, y: number): void;

  /** Pairs of ids become edges that stay, or chains of edges through the points on them, all or none; returns how many are new.
   * CROSSES: two would cross where no point is. border: they are parts of the border of inside(). */
  constrain(ids: Points, options?: { border?: boolean }): number;
  /** The opposite, all or none; NOCONSTRAINT: one does not exist. */
  release(ids: Points, options?: { border?: boolean }): void;
  /** Pairs: the edges that are parts of constraints. */
  constrainedEdges(): Uint32Array;
  /** The triangles inside the border, three ids each: from there every way out crosses it an odd number of times. None, unless
   * it is closed. */
  inside(options?: { clockwise?: boolean }): Uint32Array;

  point(id: number): [x: number, y: number];
  ids(): Uint32Array;
  /** Pairs: a point that coincides with another one, and that one. */
  coincident(): Uint32Array;
  /** Pairs. */
  edges(): Uint32Array;
  hull(options?: { clockwise?: boolean }): Uint32Array;
  /** As Delaunator's; counterclockwise in a plane whose y axis points up, unless clockwise. */
  triangulation(options?: { clockwise?: boolean }): { triangles: Uint32Array; halfedges: Int32Array };
  neighbors(id: number, options?: { clockwise?: boolean }): Uint32Array;

  /** Three ids for each place: of the triangle that contains it, or NONE. */
  locate(places: Points): Uint32Array;
  /** k ids for each place, the nearest first; NONE behind the last point. */
  nearest(places: Points, k?: number): Uint32Array;

  /** The values of the points with the ids from `first` on; NaN: it has none. */
  setValues(values: ArrayLike<number>, options?: { first?: number }): void;
  /** NaN where there is no surface. */
  interpolate(places: Points, options?: { method?: 'linear' | 'natural' | 'laplace' | 'nearest' | 'smooth'; maxEdge?: number }): Float64Array;
  /** Line i is at levels[i], has the places offsets[i] .. offsets[i + 1] of coords, and is closed if closed[i] is 1. */
  contours(
    levels: Iterable<number>,
    options?: { maxEdge?: number },
  ): { levels: Float64Array; offsets: Uint32Array; coords: Float64Array; closed: Uint32Array };
  /** Voronoi cells in a box: the cell of a point has the corners offsets[id] .. offsets[id + 1] of coords. */
  cells(box: Box): { offsets: Uint32Array; coords: Float64Array };
}

export interface LiveSetOptions {
  /** Points within this distance of an earlier one coincide with it; 0 by default. */
  tolerance?: number;
}
