// The pointers of other people who look at the same set through the same gateway.
import { given } from './address.js';
import { isLocal, socketURL } from './daemon.js';
import { draw, marks } from './stage.js';

const LEAST_MS = 50; // between two messages
const RETRY_MS = 2000;

let socket = null;
let set = null; // that this page shows
let next = null; // what is to be sent: [x, y], or null if the pointer has left the map
let timer = 0;

function connect() {
  socket = new WebSocket(socketURL('pointers'));
  socket.onmessage = ({ data }) => {
    const { number, place } = JSON.parse(data);
    if (place === null) marks.pointers.delete(number);
    else marks.pointers.set(number, place);
    draw();
  };
  socket.onopen = send;
  socket.onclose = () => {
    marks.pointers.clear();
    draw();
    setTimeout(connect, RETRY_MS);
  };
}

/** This page shows a set, null: none, and its pointer is at a place [x, y], null: elsewhere. */
export function point(shown, place) {
  if (shown !== set) marks.pointers.clear();
  [set, next] = [shown, place];
  timer ||= setTimeout(send, LEAST_MS);
}

function send() {
  clearTimeout(timer);
  timer = 0;
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ set, place: next, token: given('token') }));
}

if (!isLocal) connect();
