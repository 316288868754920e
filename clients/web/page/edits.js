// One's own edits of a set: a point that is dragged, added or deleted, and how to undo and redo each. An edit of somebody else is never
// undone: an undo is a new edit of the same point, and is refused as any other edit is.
import { request } from './daemon.js';
import { $, report } from './panel.js';
import { endHint } from './sets.js';
import { rename } from './shown.js';
import { draw, marks } from './stage.js';

class Edits {
  #set = null;
  #done = []; // {kind, id, ...}: 'move' with from and to; 'add' and 'delete' with at, [x, y], and values, {field: value}
  #undone = [];
  #queue = Promise.resolve(); // edits are carried out one after the other
  #drag = null;

  /** The next edits are those of another set. */
  begin(set) {
    if (set === this.#set) return;
    this.#set = set;
    [this.#done, this.#undone, this.#drag] = [[], [], null];
    this.#showChoices();
  }

  /** There is more or less to undo. */
  #showChoices() {
    $('undo').disabled = this.#done.length === 0;
    $('redo').disabled = this.#undone.length === 0;
    if (this.#done.length > 0) endHint();
  }

  /** A drag cannot go on, [from, to]; null: it can. */
  #refuse(line) {
    marks.refused = line;
    draw();
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
    this.#refuse(null);
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
        await request(`MOVE ${drag.set} ${drag.id} ${place.join(' ')}`);
        [drag.to, drag.isMoved] = [place, true];
        this.#refuse(null);
      } catch (error) {
        if (error.code === 'LOST') drag.isMoved = true; // perhaps: the reply is lost
        else if (!drag.isDropped) this.#refuse([drag.to, place]);
        report(error);
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
    this.#queue = this.#queue.then(() => set !== null && set === this.#set && act()).catch((error) => report(error));
    return this.#queue;
  }

  #record(edit) {
    this.#done.push(edit);
    this.#undone = [];
    this.#showChoices();
  }

  /** Takes an edit from one list to the other. A refused one is forgotten: it would be refused again. */
  async #again(from, to, isForward) {
    const edit = from.pop();
    if (edit === undefined) return;
    try {
      if (edit.kind === 'move') await request(`MOVE ${this.#set} ${edit.id} ${(isForward ? edit.to : edit.from).join(' ')}`);
      else if ((edit.kind === 'add') === isForward) await this.#add(edit);
      else await this.#remove(edit);
      to.push(edit);
    } finally {
      this.#showChoices();
    }
  }

  /** Adds the point of an edit, which gets a new id in all edits. */
  async #add(edit) {
    const names = Object.keys(edit.values);
    const fields = names.length === 0 ? '' : `FIELDS ${names.join(',')} `;
    const { keys } = await request(`ADD ${this.#set} ${fields}${[...edit.at, ...Object.values(edit.values)].join(' ')}`);
    const [before, id] = [edit.id, Number(keys.first)];
    if (before === null) return Object.assign(edit, { id });
    for (const other of [edit, ...this.#done, ...this.#undone]) if (other.id === before) other.id = id;
    rename(before, id);
    return edit;
  }

  /** Deletes the point of an edit, and keeps where it was and its values. */
  async #remove(edit) {
    const [place, fields] = await Promise.all([request(`GET ${this.#set} ${edit.id}`), request(`FIELDS ${this.#set}`)]);
    const values = await Promise.all(
      fields.rows.map(async (row) => {
        const [name] = row.split(' ');
        const { rows } = await request(`FGET ${this.#set} ${name} ${edit.id}`);
        return [name, rows[0].split(' ')[1]];
      }),
    );
    await request(`DEL ${this.#set} ${edit.id}`);
    return Object.assign(edit, { at: place.rows[0].split(' ').slice(1, 3).map(Number), values: Object.fromEntries(values) });
  }
}

export const edits = new Edits();
