/* agenda.c - see agenda.h. */
#include "server/watch/agenda.h"

void agenda_enter(struct watched *k)
{
    struct watching *w = &k->server->watching;
    k->next = w->all;
    k->link = &w->all;
    if (k->next != NULL)
        k->next->link = &k->next;
    w->all = k;
}

/* ---- busy ---- */

void agenda_call(struct watched *k)
{
    struct watching *w = &k->server->watching;
    if (k->busy)
        return;
    k->busy = true;
    k->busy_next = w->busy;
    w->busy = k;
}

void agenda_begin(struct server *s)
{
    s->watching.now = s->watching.busy;
    s->watching.busy = NULL;
}

struct watched *agenda_next(struct server *s)
{
    struct watched *k = s->watching.now;
    if (k == NULL)
        return NULL;
    s->watching.now = k->busy_next;
    k->busy = false;
    return k;
}

/* ---- deserted ---- */

void agenda_desert(struct watched *k, int64_t now_ms)
{
    struct watching *w = &k->server->watching;
    if (k->deserted_ms != 0)
        return;
    k->deserted_ms = now_ms;
    k->deserted_next = NULL;
    k->deserted_before = w->deserted_last;
    *(w->deserted_last != NULL ? &w->deserted_last->deserted_next : &w->deserted) = k;
    w->deserted_last = k;
}

void agenda_return(struct watched *k)
{
    struct watching *w = &k->server->watching;
    struct watched *next = k->deserted_next, *before = k->deserted_before;
    if (k->deserted_ms == 0)
        return;
    k->deserted_ms = 0;
    *(before != NULL ? &before->deserted_next : &w->deserted) = next;
    *(next != NULL ? &next->deserted_before : &w->deserted_last) = before;
}

void agenda_leave(struct watched *k)
{
    struct watching *w = &k->server->watching;
    agenda_return(k);
    for (struct watched **at = &w->busy; k->busy && *at != NULL; at = &(*at)->busy_next) {
        if (*at == k) {
            *at = k->busy_next;
            break;
        }
    }
    *k->link = k->next;
    if (k->next != NULL)
        k->next->link = k->link;
}
