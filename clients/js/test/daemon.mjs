// Daemons for tests: $DELAUNAYD on a free port or on the port given.
import { spawn } from 'node:child_process';
import { once } from 'node:events';

export async function startDaemon(...flags) {
  const child = spawn(process.env.DELAUNAYD, ['--port', '0', '--log-level', 'error', ...flags], { stdio: ['ignore', 'pipe', 'inherit'] });
  const [ready] = await once(child.stdout, 'data');
  const address = ready.toString().trim().split(' ').pop();
  return {
    child,
    url: `delaunay://${address}`,
    port: address.split(':').pop(),
    async end(signal = 'SIGTERM') {
      child.kill(signal);
      return (await once(child, 'exit'))[0];
    },
  };
}
