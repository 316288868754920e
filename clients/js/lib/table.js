// The commands whose methods follow from the table of commands.
// Generated from the table of commands by `make generate`, not to be edited.
'use strict';

const { checkField, checkSet, line, nothing, number, numbers, option, table, text, truth, typedKeys } = require('./framing.js');

/** The commands that need no more than their words. Each takes the options of request(). */
class Table {
  /** Deletes a set. */
  async drop(set, options) {
    return nothing(await this.request(line('DROP', checkSet(set)), options));
  }

  /** Drops the set after this number of seconds. */
  async expire(set, seconds, options) {
    return nothing(await this.request(line('EXPIRE', checkSet(set), Number(seconds)), options));
  }

  /** In how many seconds a set is dropped. Resolves with `ttl`. */
  async ttl(set, options) {
    return number('ttl')(await this.request(line('TTL', checkSet(set)), options));
  }

  /** Takes EXPIRE back: the set stays. Resolves with `changed`. */
  async persist(set, options) {
    return truth('changed')(await this.request(line('PERSIST', checkSet(set)), options));
  }

  /** Counts and memory of a set. */
  async stat(set, options) {
    return typedKeys(await this.request(line('STAT', checkSet(set)), options));
  }

  /** A number of everything in a set: equal sets have the same. Resolves with `digest`. */
  async digest(set, options) {
    return text('digest')(await this.request(line('DIGEST', checkSet(set)), options));
  }

  /** Deletes points; with CASCADE also the constraints that end there. Resolves with `deleted`. */
  async delete(set, ids, { cascade, ...options } = {}) {
    return number('deleted')(await this.request(line('DEL', checkSet(set), numbers(ids), option('CASCADE', cascade)), options));
  }

  /** Deletes a field. */
  async dropField(set, field, options) {
    return nothing(await this.request(line('FDROP', checkSet(set), checkField(field)), options));
  }

  /** Computes the Delaunay triangulation, which edits then keep current. */
  async triangulate(set, { method, ...options } = {}) {
    return typedKeys(await this.request(line('TRIANGULATE', checkSet(set), option('METHOD', method)), options));
  }

  /** Proves the triangulation exactly. */
  async check(set, options) {
    return typedKeys(await this.request(line('CHECK', checkSet(set)), options));
  }

  /** The steps of the shelling algorithm, for sets of up to 1000 points. */
  async trace(set, options) {
    return table('w')(await this.request(line('TRACE', checkSet(set)), options));
  }

  /** Begins to write all sets to the data directory, and begins a new log. Resolves with `lsn`. */
  async snapshot(options) {
    return number('lsn')(await this.request(line('SNAPSHOT'), options));
  }

  /** Writes a copy of the data directory, while it is in use, below --backup-dir. */
  async backup(name, options) {
    return typedKeys(await this.request(line('BACKUP', name), options));
  }

  /** Waits until so many followers have the changes of this connection on disk. Resolves with `followers`. */
  async wait(followers, seconds, options) {
    return number('followers')(await this.request(line('WAIT', Number(followers), Number(seconds)), options));
  }
}

module.exports = { Table };
