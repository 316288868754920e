/** The interface of Constrainautor: edges that a triangulation like Delaunator's has to keep. */
declare class Constrainautor {
  /** del: what Delaunator makes, which is modified; edges: pairs of points. */
  constructor(del: Constrainautor.DelaunatorLike, edges?: Iterable<readonly [number, number]>);
  readonly del: Constrainautor.DelaunatorLike;
  /** Returns the half edge from p1 to p2, or minus the one from p2 to p1; its number is valid until the next call. */
  constrainOne(p1: number, p2: number): number;
  /** All or none; much faster than one by one. */
  constrainAll(edges: Iterable<readonly [number, number]>): this;
  /** Does nothing: every edge that is not constrained is Delaunay already. */
  delaunify(deep?: boolean): this;
  isConstrained(edg: number): boolean;
  /** The half edge from p1 to p2; minus the one from p2 to p1 if that is the only one; Infinity: there is none. */
  findEdge(p1: number, p2: number): number;
  /** Points that coincide with earlier ones. */
  untriangulatedPoints(): number[];
}

declare namespace Constrainautor {
  export interface DelaunatorLike {
    coords: ArrayLike<number>;
    triangles: Uint32Array;
    halfedges: Int32Array;
  }
  export { Constrainautor as default };
}

export = Constrainautor;
