/* apply.h - submits the changes in a leader's log, so that this server writes the same records into its own log.
 * On a reactor. */
#pragma once

#include "proto/records/record.h"
#include "server/changes/assembly.h"
#include "server/jobs/submit.h"

/* The owner of its jobs, instead of the id of a connection. */
#define APPLY_OWNER UINT64_MAX

enum applied {
    APPLY_DONE,  /* carried out; the next record can follow */
    APPLY_WAIT,  /* not possible yet: pass the same record again when `resume` is called */
    APPLY_JOB,   /* a worker carries it out; the next record can follow when `resume` is called */
    APPLY_LATER, /* out of memory: pass the same record again later */
    APPLY_FAILED /* it contradicts the sets; `why` has the reason */
};

struct apply {
    struct server *server; /* borrows */
    void (*resume)(struct apply *p);
    char why[160]; /* of the last APPLY_LATER or APPLY_FAILED */
    /* private */
    struct buf out;
    struct waiter waiter;
    enum applied job;     /* how the last job has ended */
    struct assembly load; /* a LOAD that is not complete; skipped if the sets have it already, */
    struct buf copied;    /* and these are its records, which only the log lacks */
    struct reservation copies; /* of their memory */
    struct submission *next;   /* owns: has been read and not been carried out; NULL: none */
};

void apply_init(struct apply *p, struct server *s, void (*resume)(struct apply *p));

/* Drops an incomplete LOAD. No worker may be carrying out a record (APPLY_JOB). */
void apply_clear(struct apply *p);

/* Carries out a record, bytes[n]. The records of a LOAD take effect with the last one. A set that came with a snapshot may
 * have changes after the snapshot's lsn: their records are only written into the log. */
enum applied apply_record(struct apply *p, const struct record *r, const char *bytes, size_t n);

/* Whether a LOAD has begun and is not complete. */
bool apply_in_load(const struct apply *p);

/* Ends the job, which has run, and calls p->resume; apply_result then returns its outcome. */
void apply_job_done(struct apply *p, struct job *j);
enum applied apply_result(struct apply *p);
