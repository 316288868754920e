// The errors of this package. Each has a code, as Node's own errors have.
'use strict';

/** The server answered ERR; the connection goes on. code is the word after ERR. */
class Refused extends Error {
  constructor(line) {
    super(line);
    this.name = 'Refused';
    this.code = line.split(' ', 2)[1];
  }
}

/** The connection ended before the reply arrived: an edit may have been carried out or not. */
class Disconnected extends Error {
  constructor(message, code = 'DISCONNECTED', cause = undefined) {
    super(message, cause && { cause });
    this.name = 'Disconnected';
    this.code = code;
  }
}

module.exports = { Refused, Disconnected };
