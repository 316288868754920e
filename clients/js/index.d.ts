/** Points: x, y one after the other, or pairs. */
export type Points = Float64Array | Iterable<readonly [number, number]>;

export interface Reply {
  keys: Record<string, string>;
  rows: string[];
  data: Uint8Array | null;
}

export interface Neighbour {
  id: number;
  x: number;
  y: number;
  distance: number;
}

export interface Located {
  where: 'inside' | 'edge' | 'vertex' | 'outside';
  ids: number[];
}

/** The server answered ERR; the connection goes on. */
export class Refused extends Error {
  code: string;
}

/** A connection to a daemon; made by connect(). Requests need not wait for one another. */
export class Client {
  close(): void;
  request(line: string, options?: { body?: Uint8Array; progress?: (text: string) => void }): Promise<Reply>;
  sets(): Promise<string[]>;
  create(set: string, tolerance?: number): Promise<void>;
  drop(set: string): Promise<void>;
  stat(set: string): Promise<Record<string, string>>;
  load(set: string, points: Points): Promise<number>;
  add(set: string, x: number, y: number): Promise<number>;
  delete(set: string, ids: Iterable<number>): Promise<number>;
  move(set: string, id: number, x: number, y: number): Promise<void>;
  points(set: string): Promise<{ ids: Uint32Array; coords: Float64Array }>;
  triangulate(
    set: string,
    options?: { method?: 'auto' | 'shelling' | 'divide'; progress?: (text: string) => void },
  ): Promise<Record<string, string>>;
  check(set: string): Promise<Record<string, string>>;
  triangles(set: string, options?: { clockwise?: boolean }): Promise<Uint32Array>;
  edges(set: string): Promise<Uint32Array>;
  lists(set: string): Promise<Map<number, Uint32Array>>;
  hull(set: string, options?: { clockwise?: boolean }): Promise<Uint32Array>;
  locate(set: string, x: number, y: number): Promise<Located>;
  nearest(set: string, x: number, y: number, k?: number): Promise<Neighbour[]>;
  within(set: string, ...where: number[]): Promise<number[]>;
  info(): Promise<Record<string, string>>;
}

/** Connects; the URL is delaunay://[:token@]host[:port], by default $DELAUNAY_URL or localhost. */
export function connect(url?: string): Promise<Client>;

/** Shaped like Delaunator's result. */
export class Triangulation {
  coords: Float64Array;
  triangles: Uint32Array;
  halfedges: Int32Array;
  hull: Uint32Array;
  static from(points: Float64Array, options: { client: Client; clockwise?: boolean }): Promise<Triangulation>;
  static from<P = readonly [number, number]>(
    points: readonly P[],
    options: { client: Client; clockwise?: boolean; getX?: (p: P) => number; getY?: (p: P) => number },
  ): Promise<Triangulation>;
}
