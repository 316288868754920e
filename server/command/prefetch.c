/* prefetch.c - see prefetch.h. */
#include "server/command/prefetch.h"

#include "proto/line.h"
#include "proto/number.h"
#include "proto/resp.h"
#include "server/command/command.h"

#include <string.h>

enum { LEAST = 4 }; /* requests from which on prefetching pays */

/* The questions of a pipeline about one set. */
struct questions {
    struct dataset *set;
    struct dt_place place[DT_AHEAD];
    struct prefetch_request *asks[DT_AHEAD]; /* about place[i] */
    uint32_t id[DT_AHEAD];
    size_t places, ids;
    bool edits;  /* some of the ids are those of points to be deleted or moved */
    bool inside; /* the reactor is inside the set's gate */
};

/* Parses the next request of bytes[n] into words of q; returns its length, 0 if it is not complete or not valid. */
static size_t next_request(const char *bytes, size_t n, struct request *q)
{
    struct line line;
    struct resp resp;
    if (n > 0 && bytes[0] == '*') {
        ptrdiff_t took = resp_read(bytes, n, q, &resp);
        return took > 0 && !resp.has_body ? (size_t)took : 0;
    }
    ptrdiff_t took = line_read(bytes, n, false, &line);
    return took > 0 && request_split(q, line.text, line.len) ? (size_t)took : 0;
}

/* False: an edit of the set is under way. */
static bool enter(struct questions *all, struct dataset *set, const struct reactor *r)
{
    if (!loop_is_sharing(&r->loop))
        return true;
    all->inside = gate_try_enter(&set->current->gate, r->number);
    return all->inside;
}

static void leave(struct questions *all, struct dataset *set, const struct reactor *r)
{
    if (all->inside)
        gate_leave(&set->current->gate, r->number);
    all->inside = false;
}

/* Whether the request is about the same set as the others, and the set may be read now. */
static bool is_ours(const struct server *s, const struct reactor *r, struct questions *all,
                    const struct word *name)
{
    if (all->set != NULL)
        return all->set->name_len == name->len &&
               memcmp(all->set->name, name->text, name->len) == 0;
    if (!word_is_set_name(name))
        return false;
    struct dataset *set = registry_find(&s->sets, name);
    if (set == NULL || !enter(all, set, r))
        return false;
    if (set->born && !set->exclusive && !set->loading)
        all->set = set;
    else
        leave(all, set, r);
    return all->set != NULL;
}

static void take_place(struct questions *all, struct prefetch_request *r)
{
    struct dt_place *p = &all->place[all->places];
    if (!proto_read_double(r->word[2].text, r->word[2].len, &p->at.x) ||
        !proto_read_double(r->word[3].text, r->word[3].len, &p->at.y) ||
        !dt_coordinate_ok(p->at.x) || !dt_coordinate_ok(p->at.y))
        return;
    p->near = UINT32_MAX;
    all->asks[all->places++] = r;
}

static void take_id(struct questions *all, const struct prefetch_request *r)
{
    all->ids += proto_read_u32(r->word[2].text, r->word[2].len, &all->id[all->ids]);
}

/* Notes what is to be prefetched for the request. */
static void take_question(const struct server *s, const struct reactor *by, struct questions *all,
                          struct prefetch_request *r)
{
    enum command_prefetch prefetch = r->command != NULL ? r->command->prefetch : PREFETCH_NOTHING;
    size_t words = prefetch == PREFETCH_PLACE ? 4 : 3;
    if (prefetch == PREFETCH_NOTHING || r->n < words || !is_ours(s, by, all, &r->word[1]))
        return;
    if (prefetch == PREFETCH_PLACE)
        take_place(all, r);
    else
        take_id(all, r);
    all->edits |= prefetch == PREFETCH_EDIT;
}

static void fetch(struct questions *all)
{
    if (all->places >= LEAST && all->set->current->sum.searchable)
        dt_fetch_places(all->set->current->dt, all->place, all->places);
    if (all->ids >= LEAST && all->edits)
        dt_fetch_edits(all->set->current->dt, all->id, all->ids);
    else if (all->ids >= LEAST)
        dt_fetch_ids(all->set->current->dt, all->id, all->ids);
    for (size_t i = 0; i < all->places; i++) {
        all->asks[i]->place = all->place[i];
        all->asks[i]->placed = true;
    }
}

/* Appends a request that has been parsed; NULL: it is too long, or a body follows it. */
static struct prefetch_request *keep(const struct server *s, struct reactor *r, const char *text,
                                     size_t len)
{
    struct prefetch *a = r->prefetch;
    const struct request *q = &r->request;
    const struct command *c = q->n > 1 ? command_find_again(s, r, &q->word[0]) : NULL;
    if (q->n > PREFETCH_WORDS || (c != NULL && c->body.rows != LOAD_NOTHING))
        return NULL;
    struct prefetch_request *kept = &a->of[a->n++];
    kept->text = text;
    kept->len = len;
    kept->n = q->n;
    kept->command = c;
    kept->placed = false;
    for (size_t i = 0; i < q->n; i++)
        kept->word[i] = q->word[i];
    return kept;
}

/* Parses the requests at the front of bytes[n], and prefetches for them. */
static void look(const struct server *s, struct reactor *r, const char *bytes, size_t n)
{
    struct prefetch *a = r->prefetch;
    struct questions all;
    all.set = NULL;
    all.places = all.ids = 0;
    all.edits = all.inside = false;
    prefetch_forget(a);
    for (size_t at = 0, took; a->n < DT_AHEAD; at += took) {
        struct prefetch_request *kept;
        took = next_request(bytes + at, n - at, &r->request);
        if (took == 0 || (kept = keep(s, r, bytes + at, took)) == NULL)
            break;
        take_question(s, r, &all, kept);
    }
    fetch(&all);
    leave(&all, all.set, r);
}

size_t prefetch_take(const struct server *s, struct reactor *r, const char *bytes, size_t n)
{
    struct prefetch *a = r->prefetch;
    if (a->next == a->n || a->of[a->next].text != bytes)
        look(s, r, bytes, n);
    if (a->n == 0)
        return 0;
    const struct prefetch_request *next = &a->of[a->next++];
    if (!request_set(&r->request, next->word, next->n))
        return 0;
    a->place = next->placed ? &next->place : NULL;
    if (next->command != NULL)
        r->command = next->command;
    return next->len;
}

bool read_place(struct answer *a, const struct request *q, struct dt_place *p)
{
    if (a->reactor->prefetch->place != NULL) {
        *p = *a->reactor->prefetch->place;
        return true;
    }
    p->near = UINT32_MAX;
    return read_point(a, &q->word[2], &p->at);
}
