/* ahead.c - see ahead.h. */
#include "server/ahead.h"

#include "proto/line.h"
#include "proto/number.h"
#include "proto/resp.h"
#include "server/server.h"

#include <string.h>

enum { LEAST = 4 }; /* requests for which it is worth while */

/* The questions of a pipeline about one set. */
struct questions {
    struct dataset *set;
    struct dt_point place[DT_AHEAD];
    uint32_t id[DT_AHEAD];
    size_t places, ids;
};

/* The next request of bytes[n] as words of q; returns its length, 0 if there is none that can be
 * passed over. */
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

/* The set that the request is about, as long as it is the same as that of the others and may be
 * looked at now. */
static bool is_ours(struct server *s, struct questions *all, const struct word *name)
{
    if (all->set != NULL)
        return all->set->name_len == name->len &&
               memcmp(all->set->name, name->text, name->len) == 0;
    if (!word_is_set_name(name))
        return false;
    struct dataset *set = registry_find(&s->sets, name);
    if (set == NULL || !set->born || set->exclusive || set->loading)
        return false;
    all->set = set;
    return true;
}

static void take_question(struct server *s, struct questions *all, const struct request *q)
{
    char first = (char)(q->word[0].text[0] & ~0x20);
    bool place = q->n >= 4 && (first == 'N' || ((first == 'L' || first == 'A') && q->n == 4));
    bool id = !place && q->n >= 3 && memchr("LGTEDM", first, 6) != NULL;
    struct dt_point *p = &all->place[all->places];
    if ((!place && !id) || !is_ours(s, all, &q->word[1]))
        return;
    if (place)
        all->places += proto_read_double(q->word[2].text, q->word[2].len, &p->x) &&
                       proto_read_double(q->word[3].text, q->word[3].len, &p->y) &&
                       dt_coordinate_ok(p->x) && dt_coordinate_ok(p->y);
    else
        all->ids += proto_read_u32(q->word[2].text, q->word[2].len, &all->id[all->ids]);
}

/* Whether the words could begin a load, whose points are no requests. */
static bool may_load(const struct request *q)
{
    return q->n > 0 && q->n <= 3 && q->word[0].len >= 4 && q->word[0].len <= 5 &&
           (q->word[0].text[0] & ~0x20) == 'L' && (q->word[0].text[2] & ~0x20) == 'A';
}

/* Keeps a request that has been read. False: it is none of those that are kept. */
static bool keep(struct ahead *a, const char *text, size_t len, const struct request *q)
{
    if (q->n > AHEAD_WORDS || may_load(q))
        return false;
    a->of[a->n].text = text;
    a->of[a->n].len = len;
    a->of[a->n].n = q->n;
    for (size_t i = 0; i < q->n; i++)
        a->of[a->n].word[i] = q->word[i];
    a->n++;
    return true;
}

/* Reads what is at the front of bytes[n]. */
static void look(struct server *s, const char *bytes, size_t n)
{
    struct ahead *a = &s->ahead;
    struct request *q = &s->request;
    struct questions all = {0};
    ahead_forget(a);
    for (size_t at = 0, took; a->n < DT_AHEAD; at += took) {
        took = next_request(bytes + at, n - at, q);
        if (took == 0 || !keep(a, bytes + at, took, q))
            break;
        if (q->n > 1 && q->word[0].len > 0)
            take_question(s, &all, q);
    }
    if (all.places >= LEAST)
        dt_fetch_places(all.set->current->dt, all.place, all.places);
    if (all.ids >= LEAST)
        dt_fetch_ids(all.set->current->dt, all.id, all.ids);
}

size_t ahead_take(struct server *s, const char *bytes, size_t n)
{
    struct ahead *a = &s->ahead;
    if (a->next == a->n || a->of[a->next].text != bytes)
        look(s, bytes, n);
    if (a->n == 0)
        return 0;
    unsigned i = a->next++;
    s->request.n = 0;
    for (size_t k = 0; k < a->of[i].n; k++)
        if (!request_add(&s->request, a->of[i].word[k].text, a->of[i].word[k].len))
            return 0;
    return a->of[i].len;
}
