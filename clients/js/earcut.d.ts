/** The interface of earcut: the triangles of a polygon with holes, three corners each, counterclockwise in a plane whose y axis points
 * up. If sides cross between corners, no triangles are exact; then those whose centroid is enclosed an odd number of times are returned. Throws
 * Refused if a coordinate is not a number (NUMBER) or beyond 2^201 (RANGE). */
declare function earcut(data: ArrayLike<number>, holeIndices?: ArrayLike<number> | null, dim?: number): number[];

declare namespace earcut {
  /** The relative difference between the area of the triangles and the area of the polygon. */
  export function deviation(
    data: ArrayLike<number>,
    holeIndices: readonly number[] | null | undefined,
    dim: number,
    triangles: ArrayLike<number>,
  ): number;
  /** Does nothing: every edge of earcut()'s triangles is a side or Delaunay already. */
  export function refine(triangles: ArrayLike<number>, vertices: ArrayLike<number>, dim?: number): void;
  /** The rings of a GeoJSON polygon as arguments. */
  export function flatten(rings: ArrayLike<ArrayLike<ArrayLike<number>>>): { vertices: number[]; holes: number[]; dimensions: number };
  export { earcut as default };
}

export = earcut;
