/* power_oracle.c - the part of power_history.h about the moment of a power cut. */
#include "tests/server/power/power_history.h"

#include "proto/records/hash.h"
#include "tests/server/digest.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* ---- the states that a stream goes through ---- */

/* The stream's points among those of a set that others may share. */
static uint64_t digest_own(const struct stream *s, const struct dt *dt, uint32_t *own)
{
    struct dt_point p;
    uint64_t h = 1;
    *own = 0;
    for (uint32_t id = 0; dt != NULL && id < dt_next_id(dt); id++) {
        if (dt_get(dt, id, &p) != DT_OK || p.x != s->number)
            continue;
        h = hash_bytes(h, &p, sizeof p);
        ++*own;
    }
    return h;
}

static uint64_t digest_model(const struct stream *s, const struct model *m)
{
    uint32_t own;
    return s->shared ? digest_own(s, m->dt, &own) : model_digest(m);
}

static struct model copy_model(const struct model *m)
{
    struct model copy = {.triangulated = m->triangulated};
    CHECK(m->dt == NULL || dt_clone(m->dt, &copy.dt) == DT_OK);
    return copy;
}

/* The model after the first n changes; the caller clears it. */
static struct model model_after(const struct stream *s, int n)
{
    char reply[REPLY_BYTES];
    struct model m = copy_model(&s->before);
    for (int i = 0; i < n; i++)
        if (!s->sent[i].refused)
            model_apply(&m, &s->sent[i].change, reply);
    return m;
}

static void compute_states(struct stream *s)
{
    struct model m = copy_model(&s->before);
    char want[REPLY_BYTES];
    s->digest = realloc(s->digest, (size_t)(s->n + 1) * sizeof *s->digest);
    CHECK(s->digest != NULL);
    s->digest[0] = digest_model(s, &m);
    for (int i = 0; i < s->n; i++) {
        struct sent_change *sent = &s->sent[i];
        if (!sent->refused)
            model_apply(&m, &sent->change, want);
        if (!sent->refused && !s->shared)
            CHECK_MSG(sent->reply[0] == '\0' || begins(sent->reply, want),
                      "change %d of %s: got %s, want %s", i, s->set, sent->reply, want);
        s->digest[i + 1] = digest_model(s, &m);
    }
    model_clear(&m);
}

void history_close(struct states *h)
{
    for (int i = 0; i < h->streams; i++)
        compute_states(h->stream[i]);
}

/* The change of the stream that has put a point there; -1: a change of an earlier life. */
static int maker_of(const struct stream *s, struct dt_point p)
{
    for (int i = 0; i < s->n; i++) {
        const struct request_change *c = &s->sent[i].change;
        for (uint32_t k = 0; c->points != NULL && k < c->n; k++)
            if (c->points[k].y == p.y)
                return i;
    }
    return -1;
}

static void count_reply(struct states *h, const struct heard *heard)
{
    struct stream *s = heard->stream;
    int index = heard->index;
    if (s == NULL) {
        s = h->stream[(int)heard->point.x];
        index = h->shows_unsaved ? -1 : maker_of(s, heard->point);
    }
    if (s->acknowledged < index + 1)
        s->acknowledged = index + 1;
}

void history_look(struct states *h, const struct power_log *log, size_t n, bool all)
{
    for (int i = 0; i < h->streams; i++)
        h->stream[i]->acknowledged = 0;
    for (int i = 0; i < h->connections; i++) {
        const struct connection *c = h->connection[i];
        uint64_t sent = power_log_sent(log, n, c->port);
        for (int k = 0; k < c->n && (all || c->heard[k].end <= sent); k++)
            count_reply(h, &c->heard[k]);
    }
}

/* ---- which states are allowed ---- */

__attribute__((format(printf, 2, 3))) static bool refuse(char why[WHY_BYTES], const char *format,
                                                         ...)
{
    va_list ap;
    va_start(ap, format);
    vsnprintf(why, WHY_BYTES, format, ap);
    va_end(ap);
    return false;
}

static struct dataset *set_of(const struct registry *sets, const struct stream *s)
{
    struct word name = {s->set, strlen(s->set)};
    return registry_find(sets, &name);
}

static uint64_t digest_found(struct stream *s, const struct dataset *set)
{
    if (s->shared)
        return digest_own(s, set == NULL ? NULL : set->current->dt, &s->own);
    return set == NULL ? 0 : digest_set(set);
}

static bool find_state(struct stream *s, uint64_t digest)
{
    for (int i = s->acknowledged; i <= s->n; i++) {
        if (s->digest[i] == digest) {
            s->found = i;
            return true;
        }
    }
    return false;
}

/* Whether a full disk may have refused the change without the client reading the reply. */
static bool may_be_refused(const struct sent_change *sent)
{
    enum request_kind kind = sent->change.kind;
    return sent->reply[0] == '\0' && kind != REQUEST_DELETE && kind != REQUEST_DROP &&
           kind != REQUEST_FDROP && kind != REQUEST_RELEASE && kind != REQUEST_CASCADE;
}

/* Of the changes that may have been refused, assumes that those whose bit in `which` is set were.
 * Returns how many may have been refused. */
static unsigned suppose_refused(struct stream *s, unsigned which)
{
    unsigned n = 0;
    for (int i = 0; i < s->n; i++)
        if (may_be_refused(&s->sent[i]))
            s->sent[i].refused = which >> n++ & 1;
    CHECK(n <= BURST);
    compute_states(s);
    s->supposed = which;
    return n;
}

/* Finds a state in which some of the changes that may have been refused were refused. */
static bool find_state_after_refusals(struct stream *s, uint64_t digest)
{
    unsigned n = suppose_refused(s, 0);
    for (unsigned which = 1; which < 1u << n; which++) {
        suppose_refused(s, which);
        if (find_state(s, digest))
            return true;
    }
    suppose_refused(s, 0);
    return false;
}

static bool allows_stream(const struct states *h, struct stream *s, const struct registry *sets,
                          char why[WHY_BYTES])
{
    uint64_t digest = digest_found(s, set_of(sets, s));
    if (s->supposed != 0)
        suppose_refused(s, 0); /* for an earlier moment */
    if (find_state(s, digest) || (h->disk_is_full && find_state_after_refusals(s, digest)))
        return true;
    for (int i = s->acknowledged - 1; i >= 0; i--)
        if (s->digest[i] == digest)
            return refuse(why, "%s (stream %u) has %d changes of %d that were acknowledged", s->set,
                          s->number, i, s->acknowledged);
    return refuse(why, "%s (stream %u) is in no state after %d to %d changes", s->set, s->number,
                  s->acknowledged, s->n);
}

/* Whether the points of a stream in a shared set have the ids that its replies reported. */
static bool allows_ids(const struct stream *s, const struct dt *dt, char why[WHY_BYTES])
{
    struct model m = model_after(s, s->found);
    struct dt_point p;
    uint32_t id = 0;
    bool ok = true;
    for (uint32_t own = 0; m.dt != NULL && own < dt_next_id(m.dt) && ok; own++) {
        if (dt_get(m.dt, own, &p) != DT_OK)
            continue;
        while (dt_get(dt, id, &p) != DT_OK || p.x != s->number)
            id++;
        if (own < s->known && s->id[own] != id)
            ok = refuse(why, "point %" PRIu32 " of %s has the id %" PRIu32, s->id[own], s->set, id);
        id++;
    }
    model_clear(&m);
    return ok;
}

/* Whether a reply to a stream says that the set is triangulated, or the stream may have triangulated it. */
static void count_triangulations(const struct stream *s, bool *must, bool *may)
{
    *must |= s->before.triangulated;
    for (int i = 0; i < s->n; i++) {
        const struct sent_change *sent = &s->sent[i];
        if (sent->change.kind != REQUEST_TRIANGULATE)
            continue;
        *must |= i < s->acknowledged && begins(sent->reply, "OK");
        *may |= sent->reply[0] == '\0' || begins(sent->reply, "OK");
    }
    *may |= *must;
}

/* Checks a shared set against all its streams; `first` is one of them. */
static bool allows_shared_set(const struct states *h, const struct stream *first,
                              const struct dataset *set, char why[WHY_BYTES])
{
    bool must = false, may = false, is = set != NULL && set->triangulated;
    uint32_t points = 0;
    for (int i = 0; i < h->streams; i++) {
        const struct stream *s = h->stream[i];
        if (strcmp(s->set, first->set) != 0)
            continue;
        points += s->own;
        count_triangulations(s, &must, &may);
        if (set != NULL && !allows_ids(s, set->current->dt, why))
            return false;
    }
    struct dt_summary sum = {0};
    if (set != NULL)
        dt_summary(set->current->dt, &sum);
    if (sum.points != points)
        return refuse(why, "%s has %" PRIu32 " points, its streams %" PRIu32, first->set,
                      sum.points, points);
    if (is ? !may : must)
        return refuse(why, "%s is%s triangulated", first->set, is ? "" : " not");
    return true;
}

static bool is_first_of_set(const struct states *h, int number)
{
    for (int i = 0; i < number; i++)
        if (strcmp(h->stream[i]->set, h->stream[number]->set) == 0)
            return false;
    return true;
}

bool history_allows(struct states *h, const struct registry *sets, char why[WHY_BYTES])
{
    size_t there = 0;
    for (int i = 0; i < h->streams; i++)
        if (!allows_stream(h, h->stream[i], sets, why))
            return false;
    for (int i = 0; i < h->streams; i++) {
        const struct stream *s = h->stream[i];
        const struct dataset *set = set_of(sets, s);
        if (!is_first_of_set(h, i))
            continue;
        there += set != NULL;
        if (s->shared && !allows_shared_set(h, s, set, why))
            return false;
    }
    return there == sets->sets || refuse(why, "a set is there that was never made");
}

/* ---- from one life to the next ---- */

/* The ids that the points of a shared set have. */
static void take_ids(struct stream *s, const struct dt *dt)
{
    struct dt_point p;
    uint32_t id = 0, next = s->before.dt == NULL ? 0 : dt_next_id(s->before.dt);
    s->id = realloc(s->id, (next + 1) * sizeof *s->id);
    CHECK(s->id != NULL);
    for (uint32_t own = 0; own < next; own++) {
        bool there = dt_get(s->before.dt, own, &p) == DT_OK;
        while (there && (dt_get(dt, id, &p) != DT_OK || p.x != s->number))
            id++;
        s->id[own] = there ? id++ : DT_NONE;
    }
    s->ids = s->known = next;
}

static void settle(struct stream *s, const struct dataset *set)
{
    struct model m = model_after(s, s->found);
    model_clear(&s->before);
    s->before = m;
    for (int i = 0; i < s->n; i++)
        request_change_clear(&s->sent[i].change);
    s->n = s->found = s->acknowledged = 0;
    s->supposed = 0;
    s->before.triangulated = set != NULL && set->triangulated;
    if (s->shared)
        take_ids(s, set == NULL ? NULL : set->current->dt);
    else
        s->ids = m.dt == NULL ? 0 : dt_next_id(m.dt);
}

void history_settle(struct states *h, const struct registry *sets)
{
    for (int i = 0; i < h->streams; i++)
        settle(h->stream[i], set_of(sets, h->stream[i]));
    history_forget_connections(h);
}
