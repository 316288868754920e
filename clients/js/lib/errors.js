// The errors of this package. Each has a code, as Node's own errors have.
'use strict';

/** The server replied ERR; the connection is still usable. code is the word after ERR. */
class Refused extends Error {
  constructor(line) {
    super(line);
    this.name = 'Refused';
    this.code = line.split(' ', 2)[1];
  }
}

/** The connection ended before the reply arrived: an edit may or may not have been carried out. */
class Disconnected extends Error {
  constructor(message, code = 'DISCONNECTED', cause = undefined) {
    super(message, cause && { cause });
    this.name = 'Disconnected';
    this.code = code;
  }
}

module.exports = { Refused, Disconnected };
