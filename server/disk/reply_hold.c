/* reply_hold.c - see reply_hold.h. */
#include "server/disk/reply_hold.h"

static void add(struct holders *in, struct hold *h, struct hold_group g)
{
    if (g.lsn <= in->durable)
        return;
    struct hold_group *last = h->groups > 0 ? &h->group[h->groups - 1] : NULL;
    /* It joins the last group if that waits for as long or is the same reply, or if there are already
     * two groups. */
    if (last != NULL && (g.lsn <= last->lsn || g.from == last->from || h->groups == 2)) {
        last->lsn = g.lsn > last->lsn ? g.lsn : last->lsn;
        last->acknowledges = last->acknowledges || g.acknowledges;
    } else {
        h->group[h->groups++] = g;
    }
    if (!list_holds(&h->link))
        list_append(&in->holds[h->reactor], &h->link);
}

void hold_acknowledgement(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from)
{
    add(in, h, (struct hold_group){.lsn = lsn, .from = from, .acknowledges = true});
}

void hold_view(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from)
{
    if (in->failing == 0)
        add(in, h, (struct hold_group){.lsn = lsn, .from = from});
}

void hold_clear(struct hold *h)
{
    h->groups = 0;
    list_remove(&h->link);
}

static bool may_go(const struct holders *in, const struct hold_group *g)
{
    return g->lsn <= in->durable || (in->failing != 0 && !g->acknowledges);
}

static void release(struct holders *in, struct hold *h)
{
    unsigned before = h->groups;
    while (h->groups > 0 && may_go(in, &h->group[0])) {
        h->group[0] = h->group[1];
        h->groups--;
    }
    if (h->groups == 0)
        hold_clear(h);
    if (h->groups < before)
        in->released(h);
}

/* `fails`: those that still wait are not saved. */
static void release_all(struct holders *in, bool fails)
{
    for (unsigned i = 0; i < HOLD_REACTORS; i++) {
        for (struct hold *h = list_first(&in->holds[i]), *next; h != NULL; h = next) {
            next = list_next(&in->holds[i], h);
            release(in, h);
            if (fails && h->groups > 0)
                in->not_saved(h);
        }
    }
}

/* Sets the durable lsn, here and on followers. */
static void look_again(struct holders *in)
{
    bool fewer = in->needs_followers && in->followed < in->saved;
    uint64_t durable = fewer ? in->followed : in->saved;
    if (durable == in->durable)
        return;
    in->durable = durable;
    release_all(in, false);
}

void holders_release(struct holders *in, uint64_t lsn)
{
    in->saved = lsn;
    look_again(in);
}

void holders_follow(struct holders *in, uint64_t lsn)
{
    if (in->needs_followers && lsn <= in->followed)
        return;
    in->needs_followers = true;
    in->followed = lsn;
    look_again(in);
}

void holders_follow_none(struct holders *in)
{
    in->needs_followers = false;
    look_again(in);
}

void holders_fail(struct holders *in, enum hold_cause cause)
{
    in->failing |= cause;
    release_all(in, true);
}

void holders_recover(struct holders *in, enum hold_cause cause)
{
    in->failing &= ~(unsigned)cause;
}
