/** The interface of Delaunator. Triangles are clockwise in a plane whose y axis points up. */
declare class Delaunator<T extends ArrayLike<number> = Float64Array> {
  static from<P = ArrayLike<number>>(
    points: ArrayLike<P>,
    getX?: (p: P) => number,
    getY?: (p: P) => number,
  ): Delaunator<Float64Array>;
  /** Throws: only Triangulation.from() uses a server. */
  static useServer(): never;
  /** x, y one after the other. */
  constructor(coords: T);
  coords: T;
  triangles: Uint32Array;
  /** The half edge on the other side; -1 at the hull. */
  halfedges: Int32Array;
  hull: Uint32Array;
  trianglesLen: number;
  /** After a change of coords. */
  update(): void;
}

declare namespace Delaunator {
  export { Delaunator as default };
}

export = Delaunator;
