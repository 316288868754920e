// Mouse, touch and keyboard, as what they mean: the map moves or zooms, a point is dragged, added or deleted.

const CLOSE = 12; // pixels from a point that count as on it
const KEY_PAN = 60;
const KEY_ZOOM = 1.4;

export class Hands {
  tool = 'look'; // or, to edit: 'move', 'add', 'delete'
  #pointers = new Map(); // id -> [px, py]
  #isDragging = false; // a point
  #began = null; // where the only pointer went down
  #hover = null; // where the pointer is on the map; null: it is elsewhere, and keys mean the middle of the map
  #map;

  /** acts: pan(dx, dy), zoom(factor, px, py), fit(), pointNear(px, py, pixels) -> id or null, grab(id), drag(px, py), drop(), add(px, py),
   * remove(id), hover([px, py] or null), edit(), theme(). Places are pixels of the map. */
  constructor(map, acts) {
    this.acts = acts;
    this.#map = map;
    const place = (e) => [e.offsetX, e.offsetY];
    map.addEventListener('pointerdown', (e) => {
      map.setPointerCapture(e.pointerId);
      this.#down(e.pointerId, place(e), e.button);
    });
    map.addEventListener('pointermove', (e) => this.#move(e.pointerId, place(e)));
    for (const kind of ['pointerup', 'pointercancel']) map.addEventListener(kind, (e) => this.#up(e.pointerId, kind === 'pointerup'));
    map.addEventListener('dblclick', (e) => {
      if (this.tool === 'move') acts.add(...place(e));
      else if (this.tool === 'look') acts.zoom(2, ...place(e));
    });
    map.addEventListener('pointerleave', () => {
      if (this.#pointers.size > 0) return;
      this.#hover = null;
      acts.hover(null);
    });
    map.addEventListener(
      'wheel',
      (e) => {
        e.preventDefault();
        acts.zoom(Math.exp(-e.deltaY * (e.deltaMode === 0 ? 0.0015 : 0.05)), ...place(e));
      },
      { passive: false },
    );
    map.addEventListener('contextmenu', (e) => e.preventDefault());
    map.addEventListener('keydown', (e) => this.#key(e));
  }

  #down(pointer, at, button) {
    this.#pointers.set(pointer, at);
    this.#hover = at;
    this.#began = this.#pointers.size === 1 ? at : null;
    if (this.#isDragging) this.#drop(); // a second finger
    if (this.#began === null || this.tool !== 'move' || button !== 0) return; // only the first button of a mouse drags points
    const id = this.acts.pointNear(...at, CLOSE);
    this.#isDragging = id !== null;
    if (id !== null) this.acts.grab(id);
  }

  #drop() {
    this.#isDragging = false;
    this.acts.drop();
  }

  #move(pointer, at) {
    const before = this.#pointers.get(pointer);
    if (before === undefined) {
      this.#hover = at;
      this.acts.hover(at);
      return;
    }
    const [first, second] = [...this.#pointers.values()];
    this.#pointers.set(pointer, at);
    this.#hover = at;
    if (second !== undefined) {
      const still = before === first ? second : first;
      this.acts.zoom(Math.hypot(at[0] - still[0], at[1] - still[1]) / Math.max(1, Math.hypot(before[0] - still[0], before[1] - still[1])), ...still);
    } else if (this.#isDragging) {
      this.acts.hover(at);
      this.acts.drag(...at);
    } else {
      this.acts.pan(at[0] - before[0], at[1] - before[1]);
    }
  }

  #up(pointer, done) {
    const at = this.#pointers.get(pointer);
    this.#pointers.delete(pointer);
    const still = this.#began !== null && at !== undefined && Math.hypot(at[0] - this.#began[0], at[1] - this.#began[1]) < 4;
    if (done && still && this.tool === 'add') this.acts.add(...at);
    if (done && still && this.tool === 'delete') this.#remove(at);
    if (this.#isDragging) this.#drop();
    this.#began = null;
  }

  #remove(at) {
    const id = this.acts.pointNear(...at, CLOSE);
    if (id !== null) this.acts.remove(id);
  }

  #key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const at = this.#hover ?? [this.#map.clientWidth / 2, this.#map.clientHeight / 2];
    const zoom = (factor) => this.acts.zoom(factor, ...at);
    const keys = {
      ArrowLeft: () => this.acts.pan(KEY_PAN, 0),
      ArrowRight: () => this.acts.pan(-KEY_PAN, 0),
      ArrowUp: () => this.acts.pan(0, KEY_PAN),
      ArrowDown: () => this.acts.pan(0, -KEY_PAN),
      '+': () => zoom(KEY_ZOOM),
      '=': () => zoom(KEY_ZOOM),
      '-': () => zoom(1 / KEY_ZOOM),
      0: () => this.acts.fit(),
      e: () => this.acts.edit(),
      a: () => this.tool !== 'look' && this.acts.add(...at),
      Delete: () => this.tool !== 'look' && this.#remove(at),
      t: () => this.acts.theme(),
    };
    const act = keys[e.key] ?? keys[e.key.toLowerCase()];
    if (act === undefined) return;
    e.preventDefault();
    act();
    if (this.#hover === null) this.acts.hover(at);
  }
}
