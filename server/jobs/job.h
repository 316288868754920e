/* job.h - a piece of work on one set: done at once if it is light, by a worker if it is heavy.
 *
 * A command's job begins with a struct job, followed by its own arguments and results:
 *
 *     run    computes with job->dt and sets job->status. It may run on a worker, so it uses only the job
 *            and job->dt.
 *     done   on the I/O thread: writes the reply, or the error for job->status.
 *     clear  frees the arguments; may be NULL.
 *     install  of a job beside the set, unless it was cancelled: edits the set in place, in microseconds. It runs on the
 *            I/O thread, or on a worker if a piece of the set is being read; may be NULL.
 *     record on the I/O thread, after a writer has succeeded: appends the change to the log; may be
 *            NULL.
 *
 * A reading job pins a version and holds its lock while it runs, so it must be short: it reads one piece, or
 * searches for about a millisecond. A writing job is the set's only writer until it is done. It edits in
 * place, or it edits or triangulates a copy of the points, which becomes the current version when the job
 * has succeeded. A job beside the set (job_beside) only reads, but for long: queries go on meanwhile, edits
 * wait; what it has made, such as the triangulation of sorted points, is installed at its end. */
#ifndef SERVER_JOB_H
#define SERVER_JOB_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct job {
    struct work work;      /* first: the workers' view */
    struct list_link link; /* in server.jobs */
    void (*run)(struct job *j);
    void (*done)(struct server *s, struct job *j, struct answer *a);
    void (*clear)(struct job *j);
    void (*record)(struct server *s, struct job *j);
    void (*install)(struct job *j);
    const char *what;      /* for the progress line; NULL: none */
    uint64_t owner;        /* the id of the connection that gets the reply */
    int64_t queued_ns;     /* when it was submitted to the workers; 0: it ran at once */
    int64_t began_ns;      /* when a worker began */
    struct dataset *set;   /* of a writer; NULL for a reader */
    struct version *base;  /* pinned: the version that it reads or edits */
    struct version *fresh; /* of a writer on a copy: the version to be */
    bool beside;           /* it only reads, but counts as the writer (job_beside) */
    size_t changes;        /* points that it adds, deletes or moves */
    struct dt *dt;         /* of base, or the copy */
    struct dt_options options;
    atomic_bool cancel;
    atomic_uint progress;
    enum dt_status status;
    struct reservation memory; /* beyond that of the set, until the job ends */
};

/* How to carry out a job. */
enum {
    JOB_HEAVY = 1, /* by a worker */
    JOB_COPY = 2,  /* on a copy, if there is memory, so that the set can be read meanwhile */
    JOB_BRIEF = 4, /* heavy, but it takes only milliseconds: it does not wait behind builds */
    JOB_BEGUN = 8, /* for a reply that has begun: never refused */
    JOB_SLOW =
        16 /* heavy, a row of a reply that takes long: never on all workers (WORK_SLOW), never refused */
};

/* A job of `size` bytes, all zero except the callbacks; NULL when out of memory. It moves to job_read,
 * job_write, job_beside or job_aside; without one of these, free it with job_free. */
void *job_new(size_t size, void (*run)(struct job *),
              void (*done)(struct server *, struct job *, struct answer *));
void job_free(struct job *j);

/* Carries out a job that reads version v (job->dt must not be edited). Without JOB_HEAVY the reply is
 * complete on return, else a->next is ANSWER_WORK. ERR BUSY if too many long jobs are queued already. */
void job_read(struct server *s, struct answer *a, struct job *j, struct version *v, unsigned how);

/* The same for a job that edits the set, which must have no writer. */
void job_write(struct server *s, struct answer *a, struct job *j, struct dataset *set,
               unsigned how);

/* The options of a job of the workers, for estimates of its memory. */
struct dt_options job_options(const struct server *s);

/* Reserves the memory of a build of the set. False: the ERR line has been written, or the request waits. */
bool job_reserve_build(struct server *s, struct answer *a, const struct dataset *set,
                       struct reservation *r);

/* As job_write, for a job that only reads the set, but for long: edits of the set wait for it, queries do
 * not. If it has something to install, it must be heavy, and there must be workers. */
void job_beside(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                unsigned how);

/* The same for a job without a set, which a worker carries out. */
void job_apart(struct server *s, struct answer *a, struct job *j);

/* Cancels the job because the server is stopping, unless it changes points or makes a piece of a reply. */
void job_drain(struct job *j);

/* Whether a finished job may have read an edit that is not in the log yet: then it is kept in server.early
 * until the edit ends. */
bool job_is_early(const struct server *s, const struct job *j);

/* The first job of the workers, and the next one; NULL: there is none. */
static inline struct job *job_first(const struct server *s)
{
    return list_owner(list_first(&s->jobs), offsetof(struct job, link));
}

static inline struct job *job_next(const struct server *s, const struct job *j)
{
    return list_owner(list_next(&s->jobs, &j->link), offsetof(struct job, link));
}

/* Removes the job from server.early, if it is there, to be ended now as cancelled. */
bool job_give_up_early(struct server *s, struct job *j);

/* Installs what a job beside its set has made. False: a worker will do so, and the job has not ended. */
bool job_install(struct server *s, struct job *j);

/* Ends a job that the workers have done: publishes its result, answers its owner through a, and frees it. */
void job_finish(struct server *s, struct job *j, struct answer *a);

/* Submits a job without a set and without a reply to the workers. */
void job_aside(struct server *s, struct job *j);

/* Frees a set that nothing refers to any more; a worker does that if it is large. */
void job_discard(struct server *s, struct dt *dt);

#endif
