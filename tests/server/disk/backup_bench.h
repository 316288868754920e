/* backup_bench.h - a daemon whose backups are tested. Any failure ends the test. */
#pragma once

#include "tests/server/directory.h"

/* A data directory and, in a directory `backups` beside it, the backups. */
struct bench {
    struct directory root, data;
    char backups[64];
    struct daemon d;
};

/* Eleven changes, and the sets that exist after them. */
extern const char backup_history[];
extern const char *const backup_names[];

/* The directories are in `root`, or for backups in another one. */
void begin_on(struct bench *b, struct directory root, const char *backups);

/* Starts a daemon there, with further arguments up to a NULL. */
void start(struct bench *b, const char *const *more);

/* Both, in a directory of its own; kills the daemon and removes everything. */
void begin(struct bench *b, const char *const *more);
void end(struct bench *b);

struct directory backup_path(const struct bench *b, const char *name);
bool exists(const struct bench *b, const char *name);

/* The reply to one request; it lives until the next call. */
const char *ask(const struct daemon *d, const char *request);

/* It begins with `want`. */
void expect_reply(const struct daemon *d, const char *request, const char *want);

/* The number after the key. */
uint64_t number_in(const char *line, const char *key);

/* Snapshot number `number` is in place. */
void snapshot(const struct daemon *d, uint64_t number);

/* --check accepts the directory. */
void check_good(const struct directory *dir);

/* It does, and a daemon on the backup has this state and can continue. */
void check_restored(const struct bench *b, const char *name, const char *want);
