// The pointers of other people who look at the same set through the same gateway.

const LEAST_MS = 50; // between two messages
const RETRY_MS = 2000;

export class Others {
  /** Map number -> [x, y] in the plane: where the others point. */
  places = new Map();
  #url;
  #token;
  #socket = null;
  #set = null;
  #next = null; // what is to be sent: [x, y], or null if the pointer has left the map
  #timer = 0;

  /** token: for the daemon, or null. onChange() is called when somebody's pointer has moved. */
  constructor(url, token, onChange) {
    this.#url = url;
    this.#token = token;
    this.onChange = onChange;
    this.#connect();
  }

  #connect() {
    this.#socket = new WebSocket(this.#url);
    this.#socket.onmessage = ({ data }) => {
      const { number, place } = JSON.parse(data);
      if (place === null) this.places.delete(number);
      else this.places.set(number, place);
      this.onChange();
    };
    this.#socket.onopen = () => this.#send();
    this.#socket.onclose = () => {
      this.places.clear();
      this.onChange();
      setTimeout(() => this.#connect(), RETRY_MS);
    };
  }

  /** This page shows a set, null: none, and its pointer is at a place [x, y], null: elsewhere. */
  point(set, place) {
    if (set !== this.#set) this.places.clear();
    this.#set = set;
    this.#next = place;
    this.#timer ||= setTimeout(() => this.#send(), LEAST_MS);
  }

  #send() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify({ set: this.#set, place: this.#next, token: this.#token }));
  }
}
