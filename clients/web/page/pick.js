// Pick finds the point nearest to the pointer and the triangle there, for the mark on the map and the card. It asks again when the set
// changes, so that the card shows the present state.

export class Pick {
  #at = null; // the pointer, in pixels; null: it is elsewhere
  #isBusy = false;
  #isStale = false;

  /** state() returns {set, kind, field}; request(line) resolves to a reply; nameOf(id) is the name of a point or undefined. Calls
   * onPick({id, place, pixels, triangle, facts, name}), or with null when there is nothing. */
  constructor({ mesh, view, state, request, nameOf, onPick }) {
    Object.assign(this, { mesh, view, state, request, nameOf, onPick });
  }

  /** The number of the point of the mesh nearest to a pixel, not farther than some pixels; null: there is none. */
  near(px, py, pixels) {
    const { mesh, view } = this;
    const [x, y] = view.toPlane(px, py);
    let [best, nearest] = [(pixels / view.scale) ** 2, null];
    for (let n = 0; n < mesh.ids; n++) {
      const d = (mesh.xy[2 * n] - x) ** 2 + (mesh.xy[2 * n + 1] - y) ** 2;
      if (d <= best) [best, nearest] = [d, n];
    }
    return nearest;
  }

  /** The pointer is at a pixel, or null: it has left the map. */
  look(at) {
    this.#at = at;
    this.again();
  }

  async again() {
    this.#isStale = true;
    if (this.#isBusy) return;
    this.#isBusy = true;
    while (this.#isStale) {
      this.#isStale = false;
      const at = this.#at;
      const { set, kind } = this.state();
      const found = at === null || kind === null || this.mesh.points === 0 ? null : await this.#find(set, at).catch(() => null);
      if (this.#at === null || this.state().set !== set) this.onPick(null);
      else if (!this.#isStale || found !== null) this.onPick(found);
    }
    this.#isBusy = false;
  }

  async #find(set, at) {
    const { mesh, view } = this;
    const [x, y] = view.toPlane(...at);
    const [near, where] = await Promise.all([
      this.request(`NEAREST ${set} ${x} ${y}`),
      mesh.triangles === 0 ? null : this.request(`LOCATE ${set} ${x} ${y}`),
    ]);
    const [id, ...place] = near.rows[0].split(' ').map(Number).slice(0, 3);
    const ring = where === null ? null : (await this.request(`LISTS ${set} ${id}`)).rows[0].split(' ').slice(1);
    const corners = where?.keys.where === 'inside' ? where.rows[0].split(' ').map((c) => mesh.numberOf(Number(c))) : [];
    const isKnown = corners.length > 0 && corners.every((n) => mesh.hasPoint(n));
    const triangle = isKnown ? corners.map((n) => [mesh.xy[2 * n], mesh.xy[2 * n + 1]]) : null;
    return { id, name: this.nameOf(id), place, pixels: view.toScreen(...place), triangle, facts: this.#facts(id, place, ring) };
  }

  #facts(id, place, ring) {
    const facts = { 'x, y': place.map((v) => Number(v.toPrecision(8))).join(', ') };
    if (ring !== null) facts.neighbours = ring.length;
    const { field } = this.state();
    const value = this.mesh.values[this.mesh.numberOf(id)];
    if (field !== null && value !== undefined && !Number.isNaN(value)) facts[field.name] = Number(value.toPrecision(6));
    return facts;
  }
}
