/** The interface of earcut: the triangles of a polygon with holes, three corners each, counterclockwise in a plane whose y axis points
 * up. Throws Refused with the code CROSSES if sides cross where no corner is. */
declare function earcut(data: ArrayLike<number>, holeIndices?: ArrayLike<number> | null, dim?: number): number[];

declare namespace earcut {
  /** The relative difference between the area of the triangles and the area of the polygon. */
  export function deviation(
    data: ArrayLike<number>,
    holeIndices: readonly number[] | null | undefined,
    dim: number,
    triangles: ArrayLike<number>,
  ): number;
  /** The rings of a GeoJSON polygon as arguments. */
  export function flatten(rings: ArrayLike<ArrayLike<ArrayLike<number>>>): { vertices: number[]; holes: number[]; dimensions: number };
  export { earcut as default };
}

export = earcut;
