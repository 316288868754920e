// Starts a private daemon of this process, which ends with the process.
'use strict';

const { spawn } = require('node:child_process');
const { existsSync } = require('node:fs');
const path = require('node:path');

const { Disconnected } = require('./errors.js');

let own = null; // of all clients of this thread: a promise of the private daemon's path

/** $DELAUNAYD, or the program in this package, or that of the checkout that has this package, or that of $PATH. */
function findProgram() {
  const root = path.join(__dirname, '..');
  const near = [path.join(root, 'bin', 'delaunayd'), path.join(root, '..', '..', 'build', 'delaunayd')];
  return process.env.DELAUNAYD || near.find(existsSync) || 'delaunayd';
}

/** Starts a private daemon. It ends with this process in any case: the system then closes the
 * daemon's standard input. Returns the path of its socket. */
function startPrivate() {
  const program = findProgram();
  return new Promise((resolve, reject) => {
    const child = spawn(program, ['--private', '--log-level', 'error'], { stdio: ['pipe', 'pipe', 'inherit'], detached: true });
    let said = '';
    const fail = (why) => reject(new Disconnected(`cannot start ${program}: ${why}`, 'NODAEMON'));
    child.on('error', (error) => fail(error.code === 'ENOENT' ? 'not found; $DELAUNAYD may name it' : error.message));
    child.on('exit', (status, signal) => {
      own = null;
      fail(`it ended with ${signal ?? `status ${status}`}`);
    });
    child.stdin.on('error', () => {});
    child.stdin.unref?.();
    child.stdout.on('data', (piece) => {
      said += piece;
      const ready = /^ready on (.+)\n/.exec(said);
      if (!ready) return;
      child.stdout.destroy();
      child.unref();
      resolve(ready[1]);
    });
  });
}

/** Calls use(path of the private daemon's socket), and starts the daemon before if there is none. If use fails, the next call starts another. */
async function withPrivate(use) {
  own ??= startPrivate();
  try {
    return await use(await own);
  } catch (error) {
    own = null;
    throw error;
  }
}

module.exports = { withPrivate };
