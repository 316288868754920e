/* agenda.c - see agenda.h. */
#include "server/watch/agenda.h"

#include <pthread.h>

void agenda_enter(struct watched *k)
{
    list_append(&k->server->watching.all, &k->link);
}

void agenda_leave(struct watched *k)
{
    list_remove(&k->link);
    list_remove(&k->busy);
    list_remove(&k->deserted);
}

/* ---- busy ---- */

void agenda_call(struct watched *k)
{
    static pthread_mutex_t calls = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&calls);
    if (!list_holds(&k->busy))
        list_append(&k->server->watching.busy, &k->busy);
    pthread_mutex_unlock(&calls);
}

void agenda_begin(struct server *s)
{
    list_move(&s->watching.now, &s->watching.busy);
}

struct watched *agenda_next(struct server *s)
{
    return list_owner(list_pop(&s->watching.now), offsetof(struct watched, busy));
}

bool agenda_is_done(const struct server *s)
{
    return list_is_empty(&s->watching.now);
}

/* ---- deserted ---- */

void agenda_desert(struct watched *k, int64_t now_ms)
{
    if (list_holds(&k->deserted))
        return;
    k->deserted_ms = now_ms;
    list_append(&k->server->watching.deserted, &k->deserted);
}

void agenda_return(struct watched *k)
{
    list_remove(&k->deserted);
}

struct watched *agenda_deserted(const struct server *s)
{
    return list_owner(list_first(&s->watching.deserted), offsetof(struct watched, deserted));
}
