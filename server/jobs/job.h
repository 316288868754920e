/* job.h - a piece of work: done at once if it is light, by a worker if it is heavy.
 *
 * A command's job begins with a struct job, followed by its own arguments and results. It has two functions:
 *
 *     run    computes with job->dt and sets job->status. It may run on a worker, so it uses only the job and job->dt.
 *     end    on a reactor that is alone, once: writes the reply (job_succeeded), and frees the arguments. Without an answer
 *            (NULL) the job was not carried out, and `end` only frees.
 *
 * and reads, changes, or has no set:
 *
 *     job_read    reads a version, which it pins, and is a visitor of its gate while it runs, so it must be short: it reads one
 *                 piece, or searches for about a millisecond. If job->set is set, it may run for long, since edits of
 *                 the set wait while a worker has it; queries go on.
 *     job_change  is the only writer of a set. It edits in place, or it edits or triangulates a copy of the points,
 *                 which becomes the current version when the job has succeeded. With job_beside, before that, a result is
 *                 made beside the set, for as long as it takes. Then `run` installs it in microseconds.
 *     job_aside   has no set.
 *
 * A job whose answer is NULL gives no reply, and is never refused. */
#pragma once

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct job {
    struct work work;      /* first: the workers' view */
    struct list_link link; /* in server.jobs */
    void (*run)(struct job *j);
    void (*end)(struct server *s, struct job *j, struct answer *a);
    const char *what;    /* for the progress line; NULL: none */
    uint64_t owner;      /* the id of the connection that gets the reply; 0: none */
    int64_t queued_ns;   /* when it was submitted to the workers; 0: it ran at once */
    int64_t began_ns;    /* when a worker began */
    struct dataset *set; /* its edits wait while a worker has the job; NULL: they do not */
    /* borrows; of requests that wait for its end, beside those that wait for the set; NULL: none */
    struct request_queue *waiting;
    bool changes;          /* it was submitted by job_change */
    bool acknowledges;     /* the reply acknowledges the last change of the set, else it shows it */
    struct change *change; /* borrows; for the log if the job succeeds; NULL: none */
    /* Borrows; gets the change of a job that edits in place a set that is born; NULL: none. The change that creates a set is
     * logged when the set is born, because a snapshot has born sets only. */
    struct log *log;
    bool copies;   /* it changes a copy if there is memory, so that the set can be read meanwhile */
    size_t points; /* that it adds, deletes or moves */
    bool plans;    /* it first computes what to change: no edit that a stopping server completes */
    struct version *base; /* pinned: the version that it reads or changes; NULL: none */
    bool views;           /* its view, of the triangulation, begins when `run` does */
    struct dt_view *view; /* owns: the moment of base that it reads; NULL: now. Ended after `end` */
    struct version *fresh; /* of a change of a copy: the version to be */
    struct dt *dt;         /* of base, or the copy */
    struct dt_options options;
    atomic_bool cancel;
    atomic_uint progress;
    enum dt_status status;
    bool busy;                 /* out of memory because of other requests (job_reserve) */
    struct reservation memory; /* beyond that of the set, until the job ends */
};

/* The amount of its work. */
enum job_weight {
    JOB_LIGHT, /* done at once; by a worker if it exceeds a limit on steps, or if somebody is reading the set to change */
    JOB_TRY, /* the same for a job that reads. Beyond options.steps its `run` returns DT_TOOLONG, and runs again, as JOB_LONG */
    JOB_SHORT, /* for a worker, but it takes only milliseconds: it does not wait behind builds */
    JOB_LONG,  /* ERR BUSY if too many of these wait already */
    JOB_SLOW   /* a row of a reply that takes long: never on all workers (WORK_SLOW) */
};

/* A job of `size` bytes, all zero except the functions; NULL when out of memory. It moves to job_read, job_change or
 * job_aside; without one of these, free it with job_free. */
void *job_new(size_t size, void (*run)(struct job *),
              void (*end)(struct server *, struct job *, struct answer *));
void job_free(struct server *s, struct job *j);

/* The same for job_read and a reply: its memory is that of replies. NULL: out of memory, or the reactor shares the
 * world, as the answer says. */
void *job_new_reading(struct server *s, struct answer *a, size_t size, void (*run)(struct job *),
                      void (*end)(struct server *, struct job *, struct answer *), const char *what,
                      struct dataset *set);

/* Carries out a job that reads version v (job->dt must not be edited). A light job has been done on return and the reply is
 * complete. Else a->next is ANSWER_WORK, or the request waits until edits of job->set may wait, or an ERR line has been
 * written. */
void job_read(struct server *s, struct answer *a, struct job *j, struct version *v,
              enum job_weight weight);

/* The same for a job that changes the set, which must have no writer. */
void job_change(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                enum job_weight weight);

/* The same, but first `make` is called on a worker, which reads j->dt, polls j->options, and sets j->status. If it fails, the job
 * ends without having run. */
void job_beside(struct server *s, struct answer *a, struct job *j, struct dataset *set,
                void (*make)(struct job *j), enum job_weight weight);

/* The same for a job without a set, which a worker carries out. */
void job_aside(struct server *s, struct answer *a, struct job *j, enum job_weight weight);

/* Whether a job that ends has a result to answer with. If not, the error has been written, unless a is NULL. */
bool job_succeeded(const struct job *j, struct answer *a);

/* Makes job->memory, an empty reservation at first, that large: DT_OK, or DT_NOMEM with job->busy. */
enum dt_status job_reserve(struct job *j, size_t bytes);

/* Makes room for n more words of a result, which is all that the job reserves memory for. */
enum dt_status job_grow(struct job *j, struct dt_ids *words, size_t n);

/* Of a job that reads a version and is running: ends the visit, so that edits continue, and begins another. They do nothing
 * on a reactor, which is no visitor. */
void job_end_visit(const struct job *j);
void job_visit(const struct job *j);

/* Both, after a piece of that status, if it is DT_OK. Returns the status, or DT_CANCELLED if the job is to end. */
enum dt_status job_pause(const struct job *j, enum dt_status status);

/* Begins the job's view, of the version as it is now, before job_read. False: out of memory, which is the answer, and the job is freed. */
bool job_begin_view(struct server *s, struct answer *a, struct job *j, const struct version *v,
                    bool rings);

/* The options of a job of the workers, for estimates of its memory. */
struct dt_options job_options(const struct server *s);

/* Reserves the memory of a build of the set. False: the ERR line has been written, or the request waits. */
bool job_reserve_build(struct server *s, struct answer *a, const struct dataset *set,
                       struct reservation *r);

/* Cancels the job because the server is stopping, unless it changes points that a client has named or makes a piece of a reply. */
void job_drain(struct job *j);

/* The first job of the workers, and the next one; NULL: there is none. */
static inline struct job *job_first(const struct server *s)
{
    return list_owner(list_first(&s->jobs), offsetof(struct job, link));
}

static inline struct job *job_next(const struct server *s, const struct job *j)
{
    return list_owner(list_next(&s->jobs, &j->link), offsetof(struct job, link));
}

/* Ends a job that the workers have done, and frees it: its end answers its owner through a, which may be NULL. */
void job_finish(struct server *s, struct job *j, struct answer *a);

/* Frees a set that nothing refers to any more; a worker does that if it is large. */
void job_discard(struct server *s, struct dt *dt);
