/* local.h - a server without sockets: request lines in, replies out. */
#pragma once

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct local {
    struct config config;
    struct server server;
    struct buf out; /* the replies so far */
    bool closed;    /* a reply asked for the connection to be closed, or could not be completed */
};

/* Starts a server; with 0 threads every job is done at once. */
void local_start(struct local *l, unsigned threads);
void local_stop(struct local *l);

/* Sets --max-memory. */
void local_limit(struct local *l, size_t bytes);

/* Carries out request lines, the bodies of loads among them, and waits for each reply. Returns the
 * replies, which live until the next call. */
const char *local_ask(struct local *l, const char *lines);

/* Carries out one request, whose reply comes from a stream, without refilling it. */
struct answer local_begin(struct local *l, const char *request);

/* The same in two steps: without waiting for a job before the stream, and that. */
struct answer local_run(struct local *l, const char *request);
void local_wait(struct local *l, struct answer *a);

/* Waits for all jobs, whose results nobody gets; pieces of streams stay with them. */
void local_collect_all(struct local *l);

/* The set of this name; NULL: there is none. */
struct dataset *local_set(const struct local *l, const char *name);
