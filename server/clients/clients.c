/* clients.c - see clients.h. The low half of an id is the number of a slot, the high half how often that
 * slot has been used. */
#include "server/clients/clients.h"

#include <inttypes.h>
#include <stdlib.h>

enum { FIRST_CAPACITY = 64 };

struct client_slot {
    struct session *session; /* NULL: free */
    uint32_t used;           /* sessions so far; at least 1 while in use, so no id is 0 */
    uint32_t next_free;      /* plus 1; 0: none */
};

struct session *clients_oldest_stranger(struct clients *c)
{
    for (struct list_link *e; (e = list_first(&c->strangers)) != NULL; list_remove(e)) {
        struct session *s = list_owner(e, offsetof(struct session, stranger));
        if (s->client.role == ROLE_NONE && !s->conn.closed)
            return s;
    }
    return NULL;
}

static bool grow(struct clients *c)
{
    uint32_t cap = c->cap == 0 ? FIRST_CAPACITY : 2 * c->cap;
    struct client_slot *slot = realloc(c->slot, cap * sizeof *slot);
    if (slot == NULL)
        return false;
    c->slot = slot;
    for (uint32_t i = cap; i-- > c->cap;) {
        slot[i] = (struct client_slot){.next_free = c->free_slot};
        c->free_slot = i + 1;
    }
    c->cap = cap;
    return true;
}

bool clients_add(struct clients *c, struct session *s)
{
    if (c->free_slot == 0 && !grow(c))
        return false;
    uint32_t i = c->free_slot - 1;
    c->free_slot = c->slot[i].next_free;
    c->slot[i].session = s;
    c->slot[i].used++;
    s->id = (uint64_t)c->slot[i].used << 32 | i;
    if (s->client.role == ROLE_NONE)
        list_append(&c->strangers, &s->stranger);
    c->n++;
    return true;
}

void clients_remove(struct clients *c, struct session *s)
{
    uint32_t i = (uint32_t)s->id;
    list_remove(&s->stranger);
    c->slot[i].session = NULL;
    c->slot[i].next_free = c->free_slot;
    c->free_slot = i + 1;
    c->n--;
}

struct session *clients_find(const struct clients *c, uint64_t id)
{
    uint32_t i = (uint32_t)id;
    bool there = i < c->cap && c->slot[i].session != NULL && c->slot[i].session->id == id;
    return there ? c->slot[i].session : NULL;
}

struct session *clients_asker(const struct server *s, const struct answer *a)
{
    return s->clients != NULL ? clients_find(s->clients, a->owner) : NULL;
}

struct session *clients_at(const struct clients *c, uint32_t i)
{
    return c->slot[i].session;
}

void clients_each(const struct clients *c, void (*visit)(struct session *s))
{
    for (uint32_t i = 0; i < c->cap; i++)
        if (c->slot[i].session != NULL)
            visit(c->slot[i].session);
}

void clients_clear(struct clients *c)
{
    free(c->slot);
    *c = (struct clients){0};
}

void notice_client(const struct session *s, enum notice_level level, const char *what)
{
    char peer[SOCK_PEER_TEXT];
    if (!notice_wanted(level))
        return;
    sock_peer_text(&s->peer, peer);
    notice(level, "client %" PRIu64 " of %s %s", s->id, peer, what);
}
