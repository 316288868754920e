/* client_events.h - what mirrors need of a client beside its public functions: events between replies, and a time limit. */
#ifndef CLIENTS_CLIENT_EVENTS_H
#define CLIENTS_CLIENT_EVENTS_H

#include "clients/lib/delaunay_client.h"

/* From now on there may be events between replies. */
void client_expect_events(struct delaunay_client *c);

/* Passes the next part of a reply or event to fn, which may be NULL, or waits until something has been sent or received. *last: a part
 * has been passed, and the reply or event ends with it. DELAUNAY_TIMEOUT: nothing for timeout_ms (-1: no limit). */
enum delaunay_result client_take_part(struct delaunay_client *c, int timeout_ms,
                                      delaunay_part_fn *fn, void *ctx, bool *last);

int client_descriptor(const struct delaunay_client *c);

#endif
