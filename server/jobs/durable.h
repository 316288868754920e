/* durable.h - a server with a data directory: reads the directory at the start, and keeps log and snapshots
 * up to date. This is a reactor's side; files are used by the log's thread and by temporary threads, one
 * for reading at the start and one for each snapshot. */
#pragma once

#include "server/changes/change.h"
#include "server/disk/backup.h"
#include "server/disk/log.h"
#include "server/disk/recover.h"
#include "server/disk/saver.h"
#include "server/jobs/server.h"
#include "server/ops/facts.h"

/* Locks the directory and begins to read it. False: the reason is on standard error. */
bool durable_start(struct server *s);

/* Writes and syncs everything, then ends all threads. Does nothing without --data. */
void durable_stop(struct server *s);

/* Becomes readable when durable_on_event has something to do. */
int durable_event(const struct server *s);

/* DURABLE_READ, once: the sets have been read and are the server's, not triangulated yet (restart.h).
 * DURABLE_FAILED: the directory cannot be used; the reason is on standard error. */
enum durable_news { DURABLE_NO_NEWS, DURABLE_READ, DURABLE_FAILED };
enum durable_news durable_on_event(struct server *s);

/* To be called when all sets have been triangulated. */
void durable_complete(struct server *s);

void durable_tick(struct server *s); /* once a second */
void durable_turn_end(struct server *s);

/* The task of a reactor (reactor.h): has the log's thread write what has been appended. */
void durable_push(struct task *t);

/* Whether all sets have been read and triangulated. */
bool durable_is_complete(const struct server *s);

/* Whether the directory has been read. If not, the ERR line has been written. */
bool durable_loaded(struct server *s, struct answer *a);

/* Whether a change is possible now; `frees`: one that frees space. If not, the ERR line has been written, or the
 * request waits, because the queue of the log is full: so changes are no faster than the disk. */
bool durable_admits_change(struct server *s, struct answer *a, bool frees);

/* Whether the server itself may drop a set now. */
bool durable_admits_drops(const struct server *s);

/* Begins a snapshot of all changes up to *lsn. */
enum durable_begun { DURABLE_BEGUN, DURABLE_OFF, DURABLE_BUSY, DURABLE_NOMEM };
enum durable_begun durable_begin_snapshot(struct server *s, uint64_t *lsn);

/* Prepares a backup of all changes so far; its name and its `cancel` are the caller's. False: there is no --data. The
 * directory must have been read (durable_loaded). */
bool durable_prepare_backup(struct server *s, struct backup *b);

/* It has been written: for INFO. */
void durable_note_backup(struct server *s, const struct backup *b);

/* A setting, or the role of this daemon, has changed. To be called before others can make requests that rely on it: with several reactors
 * they may do so before the end of this turn. From now on the log keeps what --keep-log says. If changes need followers now, replies wait
 * until leader.h has counted these. */
void durable_settings_changed(struct server *s);

/* ---- for followers (server/follow) ---- */

/* The directory; NULL without --data, and while it is being read. */
struct datadir *durable_dir(const struct server *s);

/* The log's state as it was last read; NULL: as durable_dir. */
const struct log_status *durable_status(const struct server *s);

/* Why changes cannot be saved now; NULL: they can, or there is no data directory. */
const char *durable_fault(const struct server *s);

/* Whether the log has lost changes that a snapshot has: nothing can continue from it. */
bool durable_has_gap(const struct server *s);

/* Whether more records may be appended now: the log is not behind, and the disk works, or is full: then a later record may
 * free space. */
bool durable_has_room(const struct server *s);

/* From now on --keep-log bytes of log stay for followers, also after restarts. */
void durable_keep_log(struct server *s);

/* The digest of all changes of a follower, kept up to date by the caller, which it borrows. */
void durable_set_digest(struct server *s, const uint64_t *digest);

/* New segments have this lineage from now on; sets have versions of its life. */
void durable_set_lineage(struct server *s, const struct lineage *l);

/* Whether the log writes RECORD_CLOSE when it ends: not that of a follower, whose leader's log has other records. */
void durable_close_mark(struct server *s, bool writes);

/* Replaces everything by what has been read from `incoming` (aside.h): files, log and sets (registry_replace, with its
 * conditions). False: the disk has failed, or memory is short; the daemon must end. */
bool durable_replace(struct server *s, struct recovery *r, const struct lineage *l, bool same);

/* The lsn of the last change of the set, of the last DROP (set NULL), or of the last change of all. A reply that
 * acknowledges or shows it waits until it is durable. 0: none. */
uint64_t durable_lsn(const struct server *s, const struct dataset *set);
uint64_t durable_last_lsn(const struct server *s);

/* NULL without --data, and while the directory is being read. */
struct log *durable_log(const struct server *s);

/* The log of changes of the set; NULL also if the set is temporary. */
struct log *durable_log_of(const struct server *s, const struct dataset *set);

/* Appends a change that has been applied to the set: c->lsn, 0 if there is no log. Items and values of a change that needs several
 * records move to the log. Any thread may call while nobody else reads or edits the set. */
void durable_append(struct log *log, const struct dataset *set, struct change *c);

/* When snapshots are written, and how the log does; all zero without --data, and while the directory is being read. */
const struct saver *durable_saver(const struct server *s);

/* Appends the section DURABILITY of INFO. */
void durable_facts(const struct server *s, struct facts *f);
