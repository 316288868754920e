// A server of static files, for a page without a daemon.
import { once } from 'node:events';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join } from 'node:path';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

/** Serves a folder on a port of its own, {port, close()}. */
export async function serveFolder(folder) {
  const server = createServer(async (request, response) => {
    const name = new URL(request.url, 'http://site').pathname.slice(1) || 'index.html';
    const content = await readFile(join(folder, name)).catch(() => null);
    response.writeHead(content === null ? 404 : 200, { 'Content-Type': TYPES[extname(name)] ?? 'text/plain' }).end(content);
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  return { port: server.address().port, close: () => server.close() };
}
