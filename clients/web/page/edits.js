// One's own edits of a set: a point that is dragged, added or deleted, and how to undo and redo each. An edit of somebody else is never
// undone: an undo is a new edit of the same point, and is refused as any other edit is.

export class Edits {
  #set = null;
  #done = []; // {kind, id, ...}: 'move' with from and to; 'add' and 'delete' with at, [x, y], and values, {field: value}
  #undone = [];
  #queue = Promise.resolve(); // edits are carried out one after the other
  #drag = null;

  /** request(line) resolves to the reply. Calls onChange() when there is more or less to undo, and onRenamed(before, id) when a deleted
   * point is back with another id. Calls onError(error) about a refused request, and onRefused([from, to]) where a drag cannot go on; with
   * null: it can. */
  constructor({ request, onChange, onRenamed, onRefused, onError }) {
    Object.assign(this, { request, onChange, onRenamed, onRefused, onError });
  }

  get canUndo() {
    return this.#done.length > 0;
  }

  get canRedo() {
    return this.#undone.length > 0;
  }

  /** The next edits are those of another set. */
  begin(set) {
    if (set === this.#set) return;
    this.#set = set;
    [this.#done, this.#undone, this.#drag] = [[], [], null];
    this.onChange();
  }

  /** A point is taken at its place [x, y]. */
  grab(id, at) {
    this.#drag = { set: this.#set, id, from: at, to: at, next: null, isMoved: false, isBusy: false, isDropped: false };
  }

  /** The point that was taken moves; of the places that come while a request is under way only the last one is sent. */
  drag(place) {
    this.#drag.next = place;
    this.#sendDrag(this.#drag);
  }

  /** Ends the drag, which is one edit. An undo waits until it is recorded. */
  drop() {
    const drag = this.#drag;
    this.#drag = null;
    drag.isDropped = true;
    this.onRefused(null);
    this.#sendDrag(drag);
    this.#queue = this.#queue.then(() => drag.sent);
  }

  #sendDrag(drag) {
    if (!drag.isBusy) drag.sent = this.#sendPlaces(drag);
  }

  async #sendPlaces(drag) {
    drag.isBusy = true;
    while (drag.next !== null) {
      const place = drag.next;
      drag.next = null;
      try {
        await this.request(`MOVE ${drag.set} ${drag.id} ${place.join(' ')}`);
        [drag.to, drag.isMoved] = [place, true];
        this.onRefused(null);
      } catch (error) {
        if (error.code === 'LOST') drag.isMoved = true; // perhaps: the reply is lost
        else if (!drag.isDropped) this.onRefused([drag.to, place]);
        this.onError(error);
      }
    }
    drag.isBusy = false;
    const { set, id, from, to } = drag;
    if (drag.isDropped && drag.isMoved && set === this.#set) this.#record({ kind: 'move', id, from, to });
  }

  add(at) {
    return this.#enqueue(async () => this.#record(await this.#add({ kind: 'add', id: null, at, values: {} })));
  }

  remove(id) {
    return this.#enqueue(async () => this.#record(await this.#remove({ kind: 'delete', id })));
  }

  undo() {
    return this.#enqueue(() => this.#again(this.#done, this.#undone, false));
  }

  redo() {
    return this.#enqueue(() => this.#again(this.#undone, this.#done, true));
  }

  #enqueue(act) {
    const set = this.#set;
    this.#queue = this.#queue.then(() => set !== null && set === this.#set && act()).catch((error) => this.onError(error));
    return this.#queue;
  }

  #record(edit) {
    this.#done.push(edit);
    this.#undone = [];
    this.onChange();
  }

  /** Takes an edit from one list to the other. A refused one is forgotten: it would be refused again. */
  async #again(from, to, isForward) {
    const edit = from.pop();
    if (edit === undefined) return;
    try {
      if (edit.kind === 'move') await this.request(`MOVE ${this.#set} ${edit.id} ${(isForward ? edit.to : edit.from).join(' ')}`);
      else if ((edit.kind === 'add') === isForward) await this.#add(edit);
      else await this.#remove(edit);
      to.push(edit);
    } finally {
      this.onChange();
    }
  }

  /** Adds the point of an edit, which gets a new id in all edits. */
  async #add(edit) {
    const names = Object.keys(edit.values);
    const fields = names.length === 0 ? '' : `FIELDS ${names.join(',')} `;
    const { keys } = await this.request(`ADD ${this.#set} ${fields}${[...edit.at, ...Object.values(edit.values)].join(' ')}`);
    const [before, id] = [edit.id, Number(keys.first)];
    if (before === null) return Object.assign(edit, { id });
    for (const other of [edit, ...this.#done, ...this.#undone]) if (other.id === before) other.id = id;
    this.onRenamed(before, id);
    return edit;
  }

  /** Deletes the point of an edit, and keeps where it was and its values. */
  async #remove(edit) {
    const [place, fields] = await Promise.all([this.request(`GET ${this.#set} ${edit.id}`), this.request(`FIELDS ${this.#set}`)]);
    const values = await Promise.all(
      fields.rows.map(async (row) => {
        const [name] = row.split(' ');
        const { rows } = await this.request(`FGET ${this.#set} ${name} ${edit.id}`);
        return [name, rows[0].split(' ')[1]];
      }),
    );
    await this.request(`DEL ${this.#set} ${edit.id}`);
    return Object.assign(edit, { at: place.rows[0].split(' ').slice(1, 3).map(Number), values: Object.fromEntries(values) });
  }
}
