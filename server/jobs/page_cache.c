/* page_cache.c - see page_cache.h. */
#include "server/jobs/page_cache.h"

#include "server/jobs/job.h"
#include "server/system/machine.h"

enum {
    IDLE_TICKS = 10,       /* seconds without use after which the cache is emptied */
    PIECE_BYTES = 16 << 20 /* returned or prefaulted at a time */
};

/* A job that returns the pages beyond `leave` bytes; without pages, what malloc's heap does not use. */
struct release {
    struct job job;
    struct dt_pages *pages;
    size_t leave;
    bool idle;     /* because the cache is not used: it stops when it is */
    uint64_t uses; /* of the cache when the job began */
};

static void run_release(struct job *j)
{
    const struct release *r = (struct release *)j;
    struct dt_pages_summary now;
    size_t more;
    if (r->pages == NULL) {
        budget_trim_heap();
        return;
    }
    do {
        dt_pages_summary(r->pages, &now);
        if (j->cancel || now.kept <= r->leave || (r->idle && now.uses != r->uses))
            return;
        more = now.kept - r->leave;
    } while (dt_pages_trim(r->pages, more < PIECE_BYTES ? more : PIECE_BYTES) > 0);
}

static void end_release(struct server *s, struct job *j, struct answer *a)
{
    s->releasing = false;
}

static void release(struct server *s, struct dt_pages *pages, size_t leave, bool idle)
{
    struct release *r = s->releasing ? NULL : job_new(sizeof *r, run_release, end_release);
    if (r == NULL)
        return;
    r->pages = pages;
    r->leave = leave;
    r->idle = idle;
    r->uses = s->uses;
    s->releasing = true;
    job_aside(s, NULL, &r->job, JOB_SHORT);
}

/* ---- prefaulting ---- */

struct prepare {
    struct job job;
    struct dt_pages *pages;
    size_t done;
};

static void run_prepare(struct job *j)
{
    struct prepare *p = (struct prepare *)j;
    p->done = dt_pages_prepare(p->pages, PIECE_BYTES);
}

static void prepare_next(struct server *s);

static void end_prepare(struct server *s, struct job *j, struct answer *a)
{
    s->preparing = false;
    if (((struct prepare *)j)->done > 0 && !s->stopping)
        prepare_next(s);
}

static void prepare_next(struct server *s)
{
    struct dt_pages_summary now;
    dt_pages_summary(s->pages, &now);
    if (s->preparing || s->workers == NULL || now.kept >= s->expected)
        return;
    struct prepare *p = job_new(sizeof *p, run_prepare, end_prepare);
    if (p == NULL)
        return;
    p->pages = s->pages;
    s->preparing = true;
    job_aside(s, NULL, &p->job, JOB_SHORT);
}

void page_cache_expect(struct server *s, size_t more, size_t less)
{
    if ((more | less) == 0) /* perhaps of a reactor that shares the world */
        return;
    s->expected += more - less;
    if (more > 0)
        prepare_next(s);
}

/* ---- the limit ---- */

void page_cache_turn_end(struct server *s)
{
    struct dt_pages_summary now;
    if (!s->excess)
        return;
    s->excess = false;
    dt_pages_summary(s->pages, &now);
    size_t large = now.held - now.kept, limit = server_pages_limit(s, large);
    if (now.held > limit && now.kept > 0)
        release(s, s->pages, limit > large ? limit - large : 0, false);
}

void page_cache_tick(struct server *s)
{
    struct dt_pages_summary now;
    server_limit_pages(s);
    page_cache_turn_end(s);
    dt_pages_summary(s->pages, &now);
    s->idle_ticks = now.uses == s->uses ? s->idle_ticks + 1 : 0;
    s->uses = now.uses;
    if (s->idle_ticks >= IDLE_TICKS && now.kept > 0)
        release(s, s->pages, 0, true);
    /* small blocks that are free stay in malloc's heap, and no reservation counts them */
    if (machine_resident() > s->config->max_memory)
        release(s, NULL, 0, false);
}
