// Follows one set: the mesh is a copy of it, or of a part of it, and stays so. A set that is not too large is mirrored whole. Of a
// larger one the mesh has the points in a box around the view and the triangles between them, or a sample, as sample.js decides.
import { contains } from './box.js';
import { Gathered } from './rings.js';
import { boxAround, boxToShow, sampleOf } from './sample.js';

const AGAIN_MS = 1000; // between samples while the set is edited
const NOWHERE = Array(4).fill(2 ** 201).join(' '); // a box in the corner of the plane: its events say that the set has changed

export class Follower {
  set = null; // its name
  field = null; // {name, min, max} that comes with the points
  /** What the mesh is: 'whole', 'box' or 'sample'; null while it is not that of the set. */
  kind = null;
  events = 0;
  #gathered = new Gathered(); // the event that is arriving in parts
  #isPart = false; // the set is too large to be mirrored whole
  #box = null; // of a mesh that is a box
  #seen = null; // the view of the sample
  #isStale = false; // the set has changed since the sample
  #sampledAt = 0;
  #following = 0; // how often another set was chosen

  /** connection() returns the open one, fetchAll(requests, most) the replies. Sets of at most `most` points are mirrored whole. Calls
   * onShow(squares) for another mesh, and onDropped(set). Calls onChange(box) when the set has changed, with the box that Mesh.apply returns, or null. */
  constructor({ connection, fetchAll, mesh, view, most, onShow, onChange, onDropped }) {
    Object.assign(this, { connection, fetchAll, mesh, view, most, onShow, onChange, onDropped });
  }

  get isLoading() {
    return this.set !== null && this.kind === null && !this.#isPart;
  }

  get #fields() {
    return this.field === null ? '' : ` FIELDS ${this.field.name}`;
  }

  #watch(options, onReply) {
    return this.connection().request(`WATCH ${this.set}${options}${this.#fields}`, () => {
      this.#gathered = new Gathered();
      onReply?.();
    });
  }

  /** Follows another set, or the same one with another field; fieldOf() resolves to it. */
  async follow(set, fieldOf) {
    const turn = ++this.#following;
    const before = this.set;
    Object.assign(this, { set, kind: null });
    this.#isPart = false;
    if (before !== null) await this.connection().request(`UNWATCH ${before}`).catch(() => {});
    const { keys } = await this.connection().request(`STAT ${set}`);
    const field = await fieldOf();
    if (turn !== this.#following) return;
    this.field = field;
    if (Number(keys.points) > this.most) await this.#followPart();
    else await this.#followWhole(keys, turn);
  }

  async #followWhole(keys, turn) {
    const requests = [`POINTS ${this.set}${this.#fields} BINARY`];
    if (keys.triangulated === 'yes') requests.push(`TRIANGLES ${this.set} BINARY`);
    const [points, triangles = { data: new Uint8Array(0) }] = await this.fetchAll(requests);
    if (turn !== this.#following) return;
    this.mesh.load(points.data, triangles.data, this.field !== null);
    this.mesh.version = Number(keys.version);
    this.#show('whole');
    await this.#watch(` SINCE ${this.mesh.version}`);
  }

  #show(kind, squares) {
    this.kind = kind;
    this.onShow(squares);
  }

  /** The connection is another one. */
  async resume() {
    this.#gathered = new Gathered();
    if (this.kind === 'whole') await this.#watch(` SINCE ${this.mesh.version}`);
    else if (this.kind !== null) await this.#followPart();
  }

  async #followPart() {
    this.#isPart = true;
    this.mesh.version = 0;
    await this.#watch(` WITHIN ${NOWHERE}`);
    if (this.kind !== null) this.kind = 'sample';
    this.#isStale = true;
  }

  /** The box around all points. */
  async around() {
    return this.kind === 'whole' ? this.mesh.box() : boxAround(this.fetchAll, this.set);
  }

  /** Fits the mesh to the view, if it does not fit and the set is large. First it loads a sample, then a box around the view if that is to
   * be shown. Resolves to whether the mesh fits. A set that is being loaded is not examined. */
  async look() {
    if (this.set === null || !this.#isPart) return true;
    const seen = this.view.copy();
    const isSampled = this.kind === 'sample' && seen.equals(this.#seen);
    if (this.kind === 'box' && contains(this.#box, seen.box())) return true;
    if (isSampled && !this.#isStale) return true;
    if (isSampled && Date.now() - this.#sampledAt < AGAIN_MS) return false;
    const turn = this.#following;
    if (this.kind === 'box') await this.#watch(` WITHIN ${NOWHERE}`);
    const sample = await sampleOf(this.fetchAll, this.set, seen, this.field);
    if (turn !== this.#following) return true;
    this.mesh.loadSample(sample.triangles, sample.places, sample.version);
    this.#seen = seen;
    this.#sampledAt = Date.now();
    this.#isStale = false;
    this.#show('sample', sample.squares);
    const box = await boxToShow(this.fetchAll, this.set, seen, sample, this.most);
    if (box !== null && turn === this.#following) {
      await this.#watch(` WITHIN ${box.join(' ')}`, () => {
        this.kind = 'box';
        this.#box = box;
      });
    }
    return true;
  }

  onEvent(event) {
    if (event.set !== this.set) return;
    if (event.dropped) {
      Object.assign(this, { set: null, kind: null });
      this.onDropped(event.set);
      return;
    }
    this.#gathered.add(event);
    if (event.more) return;
    this.events++;
    const complete = this.#gathered;
    this.#gathered = new Gathered();
    if (this.kind === 'whole' || this.kind === 'box') this.#apply(complete, event.version);
    else if (event.version > this.mesh.version) this.#outdate(event.version);
  }

  #apply(gathered, version) {
    if (!gathered.reset) {
      this.onChange(this.mesh.apply(gathered, version));
      return;
    }
    this.mesh.loadEvent(gathered, version, this.kind === 'box');
    this.#show(this.kind);
  }

  /** The sample is not that of the set any more. */
  #outdate(version) {
    this.mesh.version = version;
    this.#isStale = true;
    this.onChange(null);
  }
}
