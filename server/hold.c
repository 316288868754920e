/* hold.c - see hold.h. */
#include "server/hold.h"

void hold_add(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from)
{
    if (h->groups < 2) {
        h->group[h->groups].from = from;
        h->groups++;
    }
    h->group[h->groups - 1].lsn = lsn;
    if (h->in != NULL)
        return;
    h->in = in;
    h->prev = NULL;
    h->next = in->first;
    if (h->next != NULL)
        h->next->prev = h;
    in->first = h;
}

void hold_clear(struct hold *h)
{
    h->groups = 0;
    if (h->in == NULL)
        return;
    if (h->prev == NULL)
        h->in->first = h->next;
    else
        h->prev->next = h->next;
    if (h->next != NULL)
        h->next->prev = h->prev;
    h->in = NULL;
}

void holders_release(struct holders *in, uint64_t lsn)
{
    for (struct hold *h = in->first, *next; h != NULL; h = next) {
        next = h->next;
        unsigned before = h->groups;
        while (h->groups > 0 && h->group[0].lsn <= lsn) {
            h->group[0] = h->group[1];
            h->groups--;
        }
        if (h->groups == 0)
            hold_clear(h);
        if (h->groups < before)
            in->released(h);
    }
}

void holders_fail(struct holders *in)
{
    for (struct hold *h = in->first, *next; h != NULL; h = next) {
        next = h->next;
        in->not_saved(h);
    }
}
