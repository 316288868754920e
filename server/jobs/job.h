/* job.h - a piece of work on one set, done at once if it is light, by a worker if it is heavy.
 *
 * A command's job begins with a struct job, followed by its own arguments and results:
 *
 *     run    computes with job->dt and sets job->status. On a worker: it touches the job and
 *            job->dt, nothing else.
 *     done   on the I/O thread: writes the reply, or the error for job->status.
 *     clear  frees the arguments; may be NULL.
 *     record on the I/O thread, once a writer has succeeded: appends the change to the journal; may
 *            be NULL.
 *
 * A reading job pins the version it reads and holds its lock while it runs, so it must be short: it
 * reads one piece, or searches for about a millisecond. A writing job is the set's only writer until
 * it is done. It edits in place, or it edits or triangulates a copy of the points, which becomes the
 * current version once the job has succeeded. A job beside the set only reads, for as long as it takes;
 * queries go on meanwhile, edits wait. */
#ifndef SERVER_JOB_H
#define SERVER_JOB_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct job {
    struct work work; /* first: the workers' view */
    struct job *prev, *next;
    void (*run)(struct job *j);
    void (*done)(struct server *s, struct job *j, struct answer *a);
    void (*clear)(struct job *j);
    void (*record)(struct server *s, struct job *j);
    const char *what; /* for the progress line */
    uint64_t owner;   /* whom to answer: a connection's id */
    uint64_t *also;   /* owns: who else waits for the result, by id */
    unsigned also_n;
    uint64_t lsn;      /* when it is done: of the last change that the reply acknowledges, */
    uint64_t shown;    /* and of the last one that it shows; 0: none */
    int64_t queued_ns; /* when the workers got it, and when one of them began; 0: it ran at once */
    int64_t began_ns;
    struct dataset *set;   /* a writer's set; NULL for a reader */
    struct version *base;  /* pinned: what it reads or edits */
    struct version *fresh; /* a writer on a copy: becomes the current version */
    bool beside;           /* a writer that only reads */
    size_t changes;        /* a writer's: points that it adds, deletes or moves */
    struct dt *dt;         /* base's set or the copy */
    struct dt_options options;
    atomic_bool cancel;
    atomic_uint progress;
    enum dt_status status;
    struct reservation memory; /* that it takes beyond what the set holds; until it is freed */
};

/* How to carry out a job. */
enum {
    JOB_HEAVY = 1, /* by a worker */
    JOB_COPY = 2,  /* a writer leaves the current version to readers, if there is memory for two */
    JOB_BRIEF = 4  /* heavy, but a matter of milliseconds: not to wait behind builds */
};

/* A job of size bytes, all zero but for the callbacks; NULL when out of memory. job_read or
 * job_write takes it over, else free it with job_free. */
void *job_new(size_t size, void (*run)(struct job *),
              void (*done)(struct server *, struct job *, struct answer *));
void job_free(struct job *j);

/* Carries out a job that reads version v (job->dt must not be edited). Without JOB_HEAVY the reply
 * is there on return, else a->next is ANSWER_JOB. ERR BUSY if too many heavy jobs wait already. */
void job_read(struct server *s, struct answer *a, struct job *j, struct version *v, unsigned how);

/* The same for a job that edits the set, which has no other writer now. */
void job_write(struct server *s, struct answer *a, struct job *j, struct dataset *set,
               unsigned how);

/* The options of a job that workers do, as far as its size goes. */
struct dt_options job_options(const struct server *s);

/* Reserves what a build of the set takes; false: a says why not, or to wait. */
bool job_reserve_build(struct server *s, struct answer *a, const struct dataset *set,
                       struct reservation *r);

/* The same for a job that only reads the set, which has no writer now, but for long: edits of the set
 * wait for it, queries do not. */
void job_beside(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                unsigned how);

/* Single flight: whoever asks for what the job is doing already waits for its result, too: ANSWER_JOB.
 * False when out of memory. */
bool job_join(struct server *s, struct answer *a, struct job *j);

/* One of those who wait does so no longer. True: the job goes on for the others, and knows the
 * leaver no more; false: there are none, so it is cancelled. */
bool job_leave(struct job *j, uint64_t who);

/* Cancels the job when the server is about to stop, unless it changes points or makes a piece of a
 * reply, which are finished. */
void job_drain(struct job *j);

/* Whether a job that read a set may have seen what is not in the log yet: it ends when the edit has. */
bool job_is_early(const struct server *s, const struct job *j);

/* If the job is one of those (server.early), takes it from them, to be ended now, as cancelled. */
bool job_give_up_early(struct server *s, struct job *j);

/* Answers one of those who joined, as the owner is answered. */
void job_tell(struct server *s, struct job *j, struct answer *a);

/* Ends a job that the workers have done: publishes what it wrote, answers through a, frees it;
 * those who joined have been told by server.tell_joined before. */
void job_finish(struct server *s, struct job *j, struct answer *a);

/* Gives a job that is about no set to a worker. Nobody is answered. */
void job_aside(struct server *s, struct job *j);

/* Frees a set that nothing refers to any more, by a worker if it is large. */
void job_discard(struct server *s, struct dt *dt);

#endif
