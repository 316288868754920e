/* durable.h - a server with a data directory: reads it at the start, and keeps log and snapshots in
 * step with the sets. This is the I/O thread's side; the disk is touched by the log's thread and by
 * threads that come and go, one that reads at the start and one for each snapshot. */
#ifndef SERVER_DURABLE_H
#define SERVER_DURABLE_H

#include "server/log.h"
#include "server/server.h"

/* Locks the directory and begins to read it. False: the reason is on standard error. */
bool durable_start(struct server *s);

/* Writes and syncs what there is, ends all threads. Does nothing without --data. */
void durable_stop(struct server *s);

/* Becomes readable when durable_on_event has something to do. */
int durable_event(const struct server *s);

/* False: the directory cannot be used; the reason is on standard error. */
bool durable_on_event(struct server *s);

void durable_tick(struct server *s); /* once a second */
void durable_turn_end(struct server *s);

/* Whether all sets are there, with their triangulations. */
bool durable_is_complete(const struct server *s);

/* Whether the directory has been read. If not, the error has been told. */
bool durable_loaded(struct server *s, struct answer *a);

/* Whether the set (NULL: none in particular) may be used now; to be changed, if `write`, in a way
 * that frees space, if `frees`. If not, the error has been told, or the request waits: while the disk
 * is slow, changes go on at its pace, so that what the log has to write stays small. */
bool durable_admits(struct server *s, struct answer *a, const struct dataset *set, bool write,
                    bool frees);

/* NULL without --data, and as long as the directory is being read. */
struct log *durable_log(const struct server *s);

/* What INFO tells. */
struct durable_facts {
    const char *state; /* off, loading, good, full, readonly */
    uint64_t loaded_percent;
    uint64_t lsn, durable_lsn, synced_lsn;
    uint64_t log_bytes, log_syncs, log_failures;
    uint64_t snapshot_lsn, snapshot_bytes, snapshots;
    bool snapshot_running;
    uint64_t snapshot_failures, snapshot_retry_s;
};
void durable_facts(const struct server *s, struct durable_facts *f);

#endif
