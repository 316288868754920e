// The commands whose methods follow from the table of commands.
// Generated from the table of commands by `make generate`, not to be edited.
'use strict';

const { nothing, number, table, text, truth, typedKeys } = require('./framing.js');
const { checkField, checkSet, flag, list, option, real, whole, word } = require('./values.js');

/** The commands that need no more than their words. As the last argument each takes the options of request(). */
class Table {
  /** Deletes a set. */
  async drop(set, options) {
    return nothing(await this._ask(['DROP', checkSet(set)], options));
  }

  /** Drops the set after this number of seconds. */
  async expire(set, seconds, options) {
    return nothing(await this._ask(['EXPIRE', checkSet(set), real(seconds)], options));
  }

  /** In how many seconds a set is dropped. Resolves with `ttl`. */
  async ttl(set, options) {
    return number('ttl')(await this._ask(['TTL', checkSet(set)], options));
  }

  /** Takes EXPIRE back: the set stays. Resolves with `changed`. */
  async persist(set, options) {
    return truth('changed')(await this._ask(['PERSIST', checkSet(set)], options));
  }

  /** Counts and memory of a set. */
  async stat(set, options) {
    return typedKeys(await this._ask(['STAT', checkSet(set)], options));
  }

  /** A number of the whole set: equal sets have equal numbers. Resolves with `digest`. */
  async digest(set, options) {
    return text('digest')(await this._ask(['DIGEST', checkSet(set)], options));
  }

  /** Deletes points; with CASCADE also the constraints that end there. Resolves with `deleted`. */
  async delete(set, ids, { cascade, ...options } = {}) {
    return number('deleted')(await this._ask(['DEL', checkSet(set), list(ids, whole), flag('CASCADE', cascade)], options));
  }

  /** Deletes a field. */
  async dropField(set, field, options) {
    return nothing(await this._ask(['FDROP', checkSet(set), checkField(field)], options));
  }

  /** Computes the Delaunay triangulation, which edits then keep current. */
  async triangulate(set, { method, ...options } = {}) {
    return typedKeys(await this._ask(['TRIANGULATE', checkSet(set), option('METHOD', method, word)], options));
  }

  /** Proves the triangulation exactly. */
  async check(set, options) {
    return typedKeys(await this._ask(['CHECK', checkSet(set)], options));
  }

  /** The steps of the shelling algorithm, for sets of up to 1000 points. */
  async trace(set, options) {
    return table('w')(await this._ask(['TRACE', checkSet(set)], options));
  }

  /** Begins to write all sets to the data directory, and begins a new log. Resolves with `lsn`. */
  async snapshot(options) {
    return number('lsn')(await this._ask(['SNAPSHOT'], options));
  }

  /** Writes a copy of the data directory, while it is in use, below --backup-dir. */
  async backup(name, options) {
    return typedKeys(await this._ask(['BACKUP', word(name)], options));
  }

  /** Waits until so many followers have the changes of this connection on disk. Resolves with `followers`. */
  async wait(followers, seconds, options) {
    return number('followers')(await this._ask(['WAIT', whole(followers), real(seconds)], options));
  }
}

module.exports = { Table };
