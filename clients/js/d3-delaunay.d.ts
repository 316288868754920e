/** What is drawn on: a CanvasRenderingContext2D, or anything with these. */
export interface Context {
  moveTo(x: number, y: number): void;
  lineTo(x: number, y: number): void;
  closePath(): void;
  arc(x: number, y: number, radius: number, startAngle: number, endAngle: number): void;
}

export type Polygon = [number, number][];

/** d3-delaunay's own, where that is installed: @types/d3-delaunay has all of it. */
export interface Voronoi {
  delaunay: Delaunay;
  circumcenters: Float64Array;
  vectors: Float64Array;
  xmin: number;
  ymin: number;
  xmax: number;
  ymax: number;
  contains(i: number, x: number, y: number): boolean;
  neighbors(i: number): Iterable<number>;
  cellPolygon(i: number): Polygon;
  cellPolygons(): Iterable<Polygon & { index: number }>;
  render(context?: null): string;
  render(context: Context): void;
  renderBounds(context?: null): string;
  renderBounds(context: Context): void;
  renderCell(i: number, context?: null): string;
  renderCell(i: number, context: Context): void;
  update(): this;
}

export const Voronoi: { new (delaunay: Delaunay, bounds?: ArrayLike<number>): Voronoi };

/** The interface of d3-delaunay's Delaunay. */
export class Delaunay<T extends ArrayLike<number> = Float64Array> {
  static from<P = ArrayLike<number>>(
    points: ArrayLike<P> | Iterable<P>,
    fx?: (this: any, p: P, i: number, points: ArrayLike<P> | Iterable<P>) => number,
    fy?: (this: any, p: P, i: number, points: ArrayLike<P> | Iterable<P>) => number,
    that?: any,
  ): Delaunay;
  constructor(points: T);
  points: T;
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
  voronoi(bounds?: ArrayLike<number>): Voronoi;
  hullPolygon(): Polygon;
  trianglePolygon(i: number): Polygon;
  trianglePolygons(): IterableIterator<Polygon>;
  render(context?: null): string;
  render(context: Context): void;
  renderHull(context?: null): string;
  renderHull(context: Context): void;
  renderTriangle(i: number, context?: null): string;
  renderTriangle(i: number, context: Context): void;
  renderPoints(context?: null, radius?: number): string;
  renderPoints(radius: number): string;
  renderPoints(context: Context, radius?: number): void;
}
