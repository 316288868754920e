/** The interface of d3-delaunay; its published types are those of @types/d3-delaunay. */
export class Delaunay<P = Delaunay.Point> {
  static from(points: ArrayLike<Delaunay.Point> | Iterable<Delaunay.Point>): Delaunay<Delaunay.Point>;
  static from(points: ArrayLike<ArrayLike<number>> | Iterable<ArrayLike<number>>): Delaunay<ArrayLike<number>>;
  static from<P>(
    points: ArrayLike<P> | Iterable<P>,
    getX: Delaunay.GetCoordinate<P, ArrayLike<P> | Iterable<P>>,
    getY: Delaunay.GetCoordinate<P, ArrayLike<P> | Iterable<P>>,
    that?: any,
  ): Delaunay<P>;
  /** x, y one after the other. */
  constructor(points: ArrayLike<number>);
  points: ArrayLike<number>;
  triangles: Uint32Array;
  halfedges: Int32Array;
  hull: Uint32Array;
  /** A half edge that ends at the point; -1 for one that coincides with another. */
  inedges: Int32Array;
  /** All points in order, if they are collinear. */
  collinear?: Int32Array;
  /** After a change of points. */
  update(): this;
  /** The point nearest to a place; the search starts at i. -1: there are no points. */
  find(x: number, y: number, i?: number): number;
  neighbors(i: number): IterableIterator<number>;
  voronoi(bounds?: Delaunay.Bounds | ArrayLike<number>): Voronoi<P>;
  hullPolygon(): Delaunay.Polygon;
  trianglePolygon(i: number): Delaunay.Triangle;
  trianglePolygons(): IterableIterator<Delaunay.Triangle>;
  render(context?: null): string;
  render(context: Delaunay.MoveContext & Delaunay.LineContext): void;
  renderHull(context?: null): string;
  renderHull(context: Delaunay.MoveContext & Delaunay.LineContext): void;
  renderTriangle(i: number, context?: null): string;
  renderTriangle(i: number, context: Delaunay.MoveContext & Delaunay.LineContext & Delaunay.ClosableContext): void;
  renderPoints(context?: null, radius?: number): string;
  renderPoints(radius: number): string;
  renderPoints(context: Delaunay.MoveContext & Delaunay.ArcContext, radius?: number): void;
}

export namespace Delaunay {
  type Point = [number, number];
  type Triangle = Point[];
  type Polygon = Point[];
  type Bounds = [number, number, number, number];
  type GetCoordinate<P, PS> = (this: any, point: P, i: number, points: PS) => number;

  /** A target for drawing: a CanvasRenderingContext2D, or anything with these. */
  interface RectContext {
    rect(x: number, y: number, width: number, height: number): void;
  }
  interface MoveContext {
    moveTo(x: number, y: number): void;
  }
  interface LineContext {
    lineTo(x: number, y: number): void;
  }
  interface ArcContext {
    arc(x: number, y: number, radius: number, startAngle: number, endAngle: number, counterclockwise?: boolean): void;
  }
  interface ClosableContext {
    closePath(): void;
  }
}

/** All of these. */
export interface Context extends Delaunay.MoveContext, Delaunay.LineContext, Delaunay.ArcContext, Delaunay.ClosableContext {}

export type Polygon = Delaunay.Polygon;

/** The interface of d3-delaunay's Voronoi. Corners are exact places of which each coordinate is rounded once. */
export class Voronoi<P = Delaunay.Point> {
  constructor(delaunay: Delaunay<P>, bounds?: Delaunay.Bounds | ArrayLike<number>);
  delaunay: Delaunay<P>;
  readonly circumcenters: Float64Array;
  readonly vectors: Float64Array;
  xmin: number;
  ymin: number;
  xmax: number;
  ymax: number;
  contains(i: number, x: number, y: number): boolean;
  neighbors(i: number): IterableIterator<number>;
  /** Closed; null if the point has no cell in the bounds. */
  cellPolygon(i: number): Delaunay.Polygon;
  cellPolygons(): IterableIterator<Delaunay.Polygon & { index: number }>;
  render(context?: null): string;
  render(context: Delaunay.MoveContext & Delaunay.LineContext): void;
  renderBounds(context?: null): string;
  renderBounds(context: Delaunay.RectContext): void;
  renderCell(i: number, context?: null): string;
  renderCell(i: number, context: Delaunay.MoveContext & Delaunay.LineContext & Delaunay.ClosableContext): void;
  /** After a change of delaunay.points. */
  update(): this;
}
