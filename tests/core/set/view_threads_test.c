/* view_threads_test.c - views begin, are read part by part, and end on several threads, while
 * another one edits the set: a lock excludes edits from everything but the end of a view. */
#include <pthread.h>
#include <stdlib.h>

#include "tests/core/sets.h"
#include "tests/test.h"

enum { POINTS = 3000, DUMPERS = 3, DUMPS = 8, PARTS = 24, PIECE = 300 };

/* ---- a fair lock ---- */

struct turnstile {
    pthread_mutex_t gate; /* held by a writer, and by readers as they come in */
    pthread_rwlock_t lock;
};

static void enter(struct turnstile *l, bool writes)
{
    pthread_mutex_lock(&l->gate);
    if (writes)
        pthread_rwlock_wrlock(&l->lock);
    else
        pthread_rwlock_rdlock(&l->lock);
    pthread_mutex_unlock(&l->gate);
}

static void leave(struct turnstile *l)
{
    pthread_rwlock_unlock(&l->lock);
}

struct shared {
    struct turnstile lock;
    struct dt *t;
    atomic_uint dumpers; /* that are at work */
};

/* ---- random numbers of a thread's own ---- */

static uint32_t below(uint64_t *state, uint32_t n)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*state >> 33) * n >> 31);
}

static struct dt_point place(uint64_t *state)
{
    return (struct dt_point){below(state, 60), below(state, 60) + below(state, 100) * 0.25};
}

/* ---- the editor ---- */

static void edit(struct dt *t, uint64_t *state)
{
    uint32_t id = below(state, dt_next_id(t)), deleted, missing;
    struct dt_point p[5];
    struct dt_added added;
    for (int i = 0; i < 5; i++)
        p[i] = place(state);
    switch (below(state, 3)) {
    case 0:
        CHECK(dt_add(t, p, 1 + below(state, 5), &added) == DT_OK);
        break;
    case 1:
        dt_delete(t, &id, 1, &deleted, &missing);
        break;
    default:
        dt_move(t, id, p[0]);
    }
}

static void *edit_all_the_time(void *arg)
{
    struct shared *s = arg;
    uint64_t state = 1;
    while (s->dumpers > 0) {
        enter(&s->lock, true);
        if (below(&state, 10) == 0)
            dt_view_tidy(s->t);
        else
            edit(s->t, &state);
        leave(&s->lock);
    }
    return NULL;
}

/* ---- the readers ---- */

struct dump {
    struct shared *s;
    struct dt_view *v;
    struct dt_cursor part[PARTS];
    struct dt_ids out[PARTS];
    unsigned parts;
    atomic_uint next; /* part that nobody has taken yet */
};

static bool read_piece(const struct dt *t, struct dt_cursor *c, struct dt_ids *out)
{
    uint32_t piece[PIECE];
    size_t rows, words;
    CHECK(dt_table_read(t, c, piece, PIECE, PIECE, &rows, &words) == DT_OK);
    append_ids(out, piece, words);
    return rows > 0;
}

static void *read_parts(void *arg)
{
    struct dump *d = arg;
    for (unsigned i; (i = atomic_fetch_add(&d->next, 1)) < d->parts;) {
        bool more = true;
        while (more) {
            enter(&d->s->lock, false);
            more = read_piece(d->s->t, &d->part[i], &d->out[i]);
            leave(&d->s->lock);
        }
    }
    return NULL;
}

static void cut(struct dump *d, struct dt_cursor *c)
{
    bool more = true;
    while (more) {
        uint32_t ids = d->parts + 3 < PARTS ? POINTS / (PARTS / 2) : UINT32_MAX;
        enter(&d->s->lock, false);
        more = dt_table_cut(d->s->t, c, ids, &d->part[d->parts]);
        leave(&d->s->lock);
        d->parts += more;
    }
}

static void compare(struct dump *d, const struct dt *copy, enum dt_table table)
{
    struct dt_ids got = {0}, want = {0};
    struct dt_cursor c;
    CHECK(dt_table_begin(copy, NULL, table, false, &c) == DT_OK);
    while (read_piece(copy, &c, &want))
        ;
    for (unsigned i = 0; i < d->parts; i++) {
        append_ids(&got, d->out[i].v, d->out[i].n);
        free(d->out[i].v);
    }
    check_equal_ids("table", &got, &want);
    free(got.v);
    free(want.v);
}

static void dump(struct shared *s, enum dt_table table)
{
    struct dump *d = calloc(1, sizeof *d);
    struct dt_cursor c;
    struct dt *copy;
    pthread_t helper;
    d->s = s;
    enter(&s->lock, false);
    d->v = dt_view_begin(s->t, true);
    CHECK(d->v != NULL && dt_clone(s->t, &copy) == DT_OK);
    CHECK(dt_table_begin(s->t, d->v, table, false, &c) == DT_OK);
    leave(&s->lock);
    cut(d, &c);
    CHECK(pthread_create(&helper, NULL, read_parts, d) == 0);
    read_parts(d);
    pthread_join(helper, NULL);
    dt_view_end(d->v);
    compare(d, copy, table);
    dt_free(copy);
    free(d);
}

static void *dump_tables(void *arg)
{
    struct shared *s = arg;
    for (unsigned i = 0; i < DUMPS; i++)
        dump(s, (enum dt_table)(i % 6));
    s->dumpers--;
    return NULL;
}

TEST_TIMEOUT(views_are_read_by_several_threads_while_another_one_edits, 60)
{
    struct dt_point p[POINTS];
    struct shared s = {.dumpers = DUMPERS};
    pthread_t thread[DUMPERS + 1];
    uint64_t state = test_random();
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = place(&state);
    s.t = set_of(p, POINTS);
    pthread_mutex_init(&s.lock.gate, NULL);
    pthread_rwlock_init(&s.lock.lock, NULL);
    for (unsigned i = 0; i < DUMPERS; i++)
        CHECK(pthread_create(&thread[i], NULL, dump_tables, &s) == 0);
    CHECK(pthread_create(&thread[DUMPERS], NULL, edit_all_the_time, &s) == 0);
    for (unsigned i = 0; i <= DUMPERS; i++)
        pthread_join(thread[i], NULL);
    CHECK(dt_check(s.t, NULL, NULL) == DT_OK);
    dt_free(s.t);
}
