/* clients.h - the sessions by id. An id is never used twice, so code that holds one can check whether its
 * session still exists. */
#pragma once

#include "server/clients/session_state.h"
#include "server/system/notice.h"

struct clients {
    struct client_slot *slot; /* owns */
    uint32_t n, cap, free_slot;
    /* Sessions that began without a role, in order of age. A session that has acquired a role is removed when it is found. */
    struct list strangers;
};

/* Gives the session its id. False when out of memory. */
bool clients_add(struct clients *c, struct session *s);
void clients_remove(struct clients *c, struct session *s);

/* NULL if it does not exist any more; a session whose connection is closed exists until the end of the
 * turn. */
struct session *clients_find(const struct clients *c, uint64_t id);

/* The session whose request is being answered; NULL: it does not exist any more, or there never was one. */
struct session *clients_asker(const struct server *s, const struct answer *a);

/* The session in slot i < cap; NULL if the slot is free. */
struct session *clients_at(const struct clients *c, uint32_t i);

/* The oldest session without a role; NULL: there is none. Cost: O(1) amortised. */
struct session *clients_oldest_stranger(struct clients *c);

/* Calls visit for every session; it may close them. */
void clients_each(const struct clients *c, void (*visit)(struct session *s));

void clients_clear(struct clients *c);

/* Writes a message about the session for the operator. */
void notice_client(const struct session *s, enum notice_level level, const char *what);
