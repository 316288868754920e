/* resume.c - WATCH ... SINCE: where a watcher that comes back continues, if what has changed since its version is still known (feed.h). */
#include "server/watch/feed.h"

#include <stdlib.h>

/* Adds the points in the box to the points that a watcher may know. Adds those below `ids` that have changed after the mark, too,
 * because they may have been in the box. If changes have not been collected, all are added, because points that have just
 * left the box are not found. */
static bool know_since(struct feed *f, const struct recent_mark *m, uint32_t ids)
{
    const struct watched *k = f->of;
    struct dt_ids found = {0};
    bool good = true;
    if (k->set->exclusive || k->version != k->set->version || ids - m->ids > FEED_KEYS ||
        !feed_find_box(f, &found)) {
        free(found.v);
        return known_fill(&f->known, ids);
    }
    for (size_t i = 0; good && i < found.n; i++)
        good = known_add(&f->known, found.v[i], k->ids);
    for (uint64_t at = m->at; good && at < k->recent.key_end; at++)
        good = known_add(&f->known, (uint32_t)(recent_key(&k->recent, at) >> 32), k->ids);
    for (uint32_t id = m->ids; good && id < ids; id++)
        good = known_add(&f->known, id, k->ids);
    free(found.v);
    return good;
}

struct position feed_since(struct feed *f, uint64_t version)
{
    const struct watched *k = f->of;
    struct position p = {.tick = recent_find(&k->recent, version)};
    const struct recent_mark *m = recent_at(&k->recent, p.tick);
    if (version > k->set->version || m == NULL || p.tick < feed_first_tick(f) ||
        version_is_stale(k->set->current))
        return (struct position){.tick = 0};
    p.ids = m->ids;
    p.altered = f->scope.constraints ? m->altered : 0;
    if (version != m->version && k->set->exclusive)
        return (struct position){.tick = 0};
    if (version != m->version) /* it may know ids that are newer than the mark */
        p.ids = dt_next_id(k->set->current->dt);
    return f->scope.boxed && !know_since(f, m, p.ids) ? (struct position){.tick = 0} : p;
}
