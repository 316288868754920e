// The conversation with the daemon, which begins again when the connection is lost; or with the sets in this page, if it is a site of
// static files.
import { given } from './address.js';
import { Connection, fetchReplies } from './data/connection.js';
import { Local } from './data/local.js';
import { report, say } from './panel.js';

const RETRY_MS = 1000;
const NOT_NOW = ['LOADING', 'BUSY', 'NOMEM', 'TIMEOUT']; // errors of a daemon that may answer later

export const isLocal = document.documentElement.dataset.source === 'local';
let current = null; // a Connection or a Local
let access = 'unknown'; // to the daemon; 'given' or 'refused'

export const connection = () => current;
export const request = (line) => current.request(line);
export const isOpen = () => access === 'given' && !current.isLost;

/** The address of a WebSocket of the gateway. */
export function socketURL(name) {
  const url = new URL(name, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  url.hash = '';
  return url;
}

/** The replies to requests whose replies may be large. */
export async function fetchAll(requests, most) {
  if (isLocal) return current.fetchAll(requests);
  const auth = given('token') === null ? [] : [`AUTH ${given('token')}`];
  const replies = await Promise.all(fetchReplies('daemon', [...auth, ...requests], most));
  return replies.slice(auth.length);
}

async function enter() {
  try {
    if (given('token') !== null) await request(`AUTH ${given('token')}`);
    await request('SETS');
    access = 'given';
  } catch (error) {
    if (error.code === 'LOST' || NOT_NOW.includes(error.code)) throw error;
    access = 'refused';
    say(`${error.message}; the address should end with #token=TOKEN, or &token=TOKEN`);
  }
}

/** Begins the conversation. begin() is called when requests are answered, again with each new connection; onEvent(event) of its events.
 * files: {name: address} of the sets in this page. */
export async function converse({ files, onEvent, begin }) {
  let reason = 'the connection is lost';
  const onEnd = () => {
    if (access === 'refused') return;
    say(`${reason}; trying again ...`);
    setTimeout(() => converse({ files, onEvent, begin }), RETRY_MS);
  };
  current = isLocal ? new Local(files, { onEvent }) : new Connection(socketURL('daemon'), { onEvent, onEnd });
  try {
    await current.opened;
    if (isLocal) access = 'given';
    else await enter();
    if (access === 'given') await begin();
  } catch (error) {
    if (error.code === 'LOST') return report(error);
    reason = error.message;
    current.close();
  }
}
