// The types of the commands whose methods follow from the table of commands.
// Generated from the table of commands by `make generate`, not to be edited.
import { RequestOptions } from './index';

/** The commands that need no more than their words. */
export interface Table {
  /** Deletes a set. */
  drop(set: string, options?: RequestOptions): Promise<void>;
  /** Drops the set after this number of seconds. */
  expire(set: string, seconds: number, options?: RequestOptions): Promise<void>;
  /** In how many seconds a set is dropped. Resolves with `ttl`. */
  ttl(set: string, options?: RequestOptions): Promise<number | undefined>;
  /** Takes EXPIRE back: the set stays. Resolves with `changed`. */
  persist(set: string, options?: RequestOptions): Promise<boolean>;
  /** Counts and memory of a set. */
  stat(set: string, options?: RequestOptions): Promise<{ points: number; coincident: number; triangulated: boolean; triangles: number; edges: number; hull: number; memory: number; tol: number; fields?: number; temporary?: boolean; ttl?: number; version: number }>;
  /** A number of the whole set: equal sets have equal numbers. Resolves with `digest`. */
  digest(set: string, options?: RequestOptions): Promise<string>;
  /** Deletes points; with CASCADE also the constraints that end there. Resolves with `deleted`. */
  delete(set: string, ids: Iterable<number>, options?: RequestOptions & { cascade?: boolean }): Promise<number>;
  /** Deletes a field. */
  dropField(set: string, field: string, options?: RequestOptions): Promise<void>;
  /** Computes the Delaunay triangulation, which edits then keep current. */
  triangulate(set: string, options?: RequestOptions & { method?: 'auto' | 'shelling' | 'divide' }): Promise<{ points: number; coincident: number; triangles: number; edges: number; hull: number; ms: number }>;
  /** Proves the triangulation exactly. */
  check(set: string, options?: RequestOptions): Promise<{ points: number; coincident: number; triangles: number; edges: number; hull: number; delaunay: boolean }>;
  /** The steps of the shelling algorithm, for sets of up to 1000 points. */
  trace(set: string, options?: RequestOptions): Promise<(string | number)[][]>;
  /** Begins to write all sets to the data directory, and begins a new log. Resolves with `lsn`. */
  snapshot(options?: RequestOptions): Promise<number>;
  /** Writes a copy of the data directory, while it is in use, below --backup-dir. */
  backup(name: string, options?: RequestOptions): Promise<{ lsn: number; files: number; size: number; copied: number }>;
  /** Waits until so many followers have the changes of this connection on disk. Resolves with `followers`. */
  wait(followers: number, seconds: number, options?: RequestOptions): Promise<number>;
}
