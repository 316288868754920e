/* memory_bounds_test.c - operations use no more memory than dt_build_memory and similar functions return,
 * nor much less: measured by the peak resident memory of this process. */
#include "core/delaunay_constraints.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <malloc.h>
#include <string.h>

enum { SLACK = 3 << 20 };

/* Under a sanitizer nothing is measured: begin() says so. */
static size_t many(void)
{
    return test_is_sanitized() ? 20000 : 150000;
}

/* A figure of this process's status in bytes, by its key; 0 if the system does not provide it. */
static size_t bytes_of(const char *key)
{
    char line[256];
    size_t kib = 0;
    FILE *f = fopen("/proc/self/status", "r");
    while (f != NULL && fgets(line, sizeof line, f) != NULL)
        if (strncmp(line, key, strlen(key)) == 0)
            kib = strtoul(line + strlen(key) + 1, NULL, 10);
    if (f != NULL)
        fclose(f);
    return kib * 1024;
}

static size_t resident;

/* Resets VmHWM, so that it is the peak from now on. False: the system does not support that, or a
 * sanitizer keeps freed memory. */
static bool begin(void)
{
    if (test_is_sanitized())
        return false;
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    FILE *f = fopen("/proc/self/clear_refs", "w");
    bool ok = f != NULL && fputs("5", f) >= 0;
    ok = f != NULL && fclose(f) == 0 && ok;
    resident = bytes_of("VmRSS");
    return ok && resident > 0;
}

/* Checks that the memory used since begin is at most `said`, and more than a fifth of `said`. */
static void check_peak(const char *what, const char *family, size_t said)
{
    size_t peak = bytes_of("VmHWM"), took = peak > resident ? peak - resident : 0;
    CHECK_MSG(took <= said + SLACK, "%s of %s takes %zu bytes, said: %zu", what, family, took,
              said);
    CHECK_MSG(took + SLACK >= said / 5, "%s of %s takes %zu bytes, said: %zu", what, family, took,
              said);
}

static void build(struct dt *t, const struct family *f, const struct dt_options *opt,
                  const char *what)
{
    bool counting = begin();
    size_t said = dt_build_memory(t, opt);
    CHECK(dt_triangulate(t, opt) == DT_OK && dt_refresh(t, opt) == DT_OK);
    if (counting)
        check_peak(what, f->name, said);
}

static void add(struct dt *t, const struct family *f, const struct dt_point *p, size_t n,
                const struct dt_options *opt, const char *what)
{
    struct dt_added done;
    bool counting = begin();
    size_t said = dt_add_memory(t, n, opt);
    CHECK(dt_add_many(t, p, n, opt, &done) == DT_OK && dt_refresh(t, opt) == DT_OK);
    if (counting)
        check_peak(what, f->name, said);
}

static void prepare(struct dt *t, const struct family *f)
{
    bool counting = begin();
    size_t said = dt_prepare_memory(t);
    CHECK(dt_prepare(t, NULL) == DT_OK);
    if (counting)
        check_peak("a grid", f->name, said);
}

/* Deletes every second of the first n points. */
static void thin_out(struct dt *t, uint32_t n)
{
    uint32_t deleted, missing, *id = malloc((size_t)n * sizeof *id);
    CHECK(id != NULL);
    for (uint32_t i = 0; i < n; i++)
        id[i] = i / 2 * 2;
    CHECK(dt_delete(t, id, n, &deleted, &missing) == DT_OK);
    free(id);
}

static void live_through(const struct family *f, unsigned threads, size_t n, double tol)
{
    struct dt_point *p = malloc(2 * n * sizeof *p);
    struct dt_pool pool = threads_pool(threads);
    struct dt_options opt = {.pool = threads > 1 ? &pool : NULL}, again = opt;
    CHECK(p != NULL);
    family_points(f, p, 2 * n, test_random());
    struct dt *t = dt_new_in(tol, NULL);
    CHECK(t != NULL);
    again.rebuild = true;
    add(t, f, p, n, &opt, "a load");
    build(t, f, &opt, "a build");
    prepare(t, f);
    build(t, f, &again, "a second build");
    add(t, f, p + n, n / 10, &opt, "a batch");
    add(t, f, p + n + n / 10, n / 2, &opt, "a large batch");
    thin_out(t, (uint32_t)n);
    build(t, f, &opt, "a refresh with gaps");
    dt_free(t);
    free(p);
}

TEST_TIMEOUT(work_needs_no_more_memory_than_predicted, 120)
{
    static const char *const names[] = {"uniform", "kuzmin", "duplicates", "nested"};
    unsigned most = test_is_sanitized() ? 8 : 64; /* a sanitizer takes its time to start threads */
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (unsigned threads = 1; threads <= most; threads *= 8)
            live_through(family_find(names[i]), threads, many(), 0);
}

TEST_TIMEOUT(small_sets_and_sets_with_a_tolerance_need_no_more_memory_than_predicted, 60)
{
    for (size_t n = 1000; n <= 20000; n *= 4) {
        live_through(family_find("uniform"), 2, n, 0);
        live_through(family_find("same_place"), 2, n, 0);
    }
    live_through(family_find("uniform"), 1, many(), 1e-9);
    live_through(family_find("lattice"), 1, many(), 2);
}

/* ---- small sets, to the byte ---- */

static size_t said_most, before;

static void watch(size_t said)
{
    said_most = said;
    before = test_alloc_in_use();
    test_watch_alloc();
}

static void check_most(const char *what, const struct family *f, size_t n, unsigned threads)
{
    size_t took = test_alloc_most(before);
    CHECK_MSG(took <= said_most, "%s of %zu points of %s by %u threads takes %zu bytes, said: %zu",
              what, n, f->name, threads, took, said_most);
}

static void live_small(const struct family *f, unsigned threads, size_t n)
{
    struct dt_pool pool = threads_pool(threads);
    struct dt_options opt = {.pool = threads > 1 ? &pool : NULL}, again = opt;
    struct dt_point *p = malloc(2 * n * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(p != NULL && t != NULL);
    again.rebuild = true;
    family_points(f, p, 2 * n, test_random());
    watch(dt_add_memory(t, n, &opt));
    CHECK(dt_add_many(t, p, n, &opt, &added) == DT_OK);
    check_most("a load", f, n, threads);
    watch(dt_build_memory(t, &opt));
    CHECK(dt_triangulate(t, &opt) == DT_OK);
    check_most("a build", f, n, threads);
    watch(dt_add_memory(t, n / 9, &opt) + dt_prepare_memory(t));
    CHECK(dt_add_many(t, p, n / 9, &opt, &added) == DT_OK && added.coincident == n / 9);
    check_most("a batch of coincident points that makes the grid", f, n, threads);
    watch(dt_build_memory(t, &again));
    CHECK(dt_triangulate(t, &again) == DT_OK);
    check_most("a second build", f, n, threads);
    watch(dt_prepare_memory(t));
    CHECK(dt_prepare(t, &opt) == DT_OK);
    check_most("a grid", f, n, threads);
    watch(dt_add_memory(t, n / 2, &opt));
    CHECK(dt_add_many(t, p + n, n / 2, &opt, &added) == DT_OK && dt_refresh(t, &opt) == DT_OK);
    check_most("a large batch", f, n, threads);
    dt_free(t);
    free(p);
}

TEST_TIMEOUT(small_sets_ask_malloc_for_no_more_than_predicted_on_any_number_of_threads, 120)
{
    size_t most = test_is_sanitized() ? 2000 : 8000; /* malloc is asked for the same bytes */
    for (const struct family *f = families; f->name != NULL; f++)
        for (unsigned threads = 1; threads <= 8; threads += threads == 1 ? 1 : 6)
            for (size_t n = 500; n <= most; n *= 4)
                live_small(f, threads, n);
    live_small(family_find("uniform"), 64, 8000);
    live_small(family_find("kuzmin"), 64, 8000);
}

TEST_TIMEOUT(papers_engine_needs_no_more_memory_than_predicted, 60)
{
    static const char *const names[] = {"uniform", "clusters"};
    for (size_t i = 0; i < 2; i++) {
        const struct family *f = family_find(names[i]);
        struct dt_point *p = malloc(many() * sizeof *p);
        struct dt_options opt = {.method = DT_SHELLING};
        struct dt *t = dt_new(0);
        CHECK(p != NULL && t != NULL);
        family_points(f, p, many(), 1);
        add(t, f, p, many(), &opt, "a load");
        build(t, f, &opt, "a build by shelling");
        dt_free(t);
        free(p);
    }
}

/* Every cell of a lattice is a region of its own. */
TEST(a_survey_of_many_regions_needs_no_more_memory_than_predicted)
{
    enum { SIDE = 300 };
    struct dt *t = dt_new(0);
    struct dt_added a;
    struct dt_point *p = malloc(SIDE * SIDE * sizeof *p);
    struct dt_constraint *c = malloc(4 * SIDE * SIDE * sizeof *c);
    size_t n = 0, added;
    uint32_t missing;
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        p[i] = (struct dt_point){i % SIDE, i / SIDE};
    for (uint32_t i = 0; i < SIDE * (SIDE - 1); i++)
        for (uint32_t k = 0; k < 4 && (i + 1) % SIDE != 0; k++) {
            const uint32_t ring[] = {i, i + 1, i + SIDE + 1, i + SIDE};
            c[n++] = (struct dt_constraint){ring[k], ring[(k + 1) % 4], true, i};
        }
    CHECK(dt_add(t, p, SIDE * SIDE, &a) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_constrain(t, c, n, NULL, &added, &missing) == DT_OK && added == n);
    bool counting = begin();
    size_t said = dt_survey_memory(t);
    CHECK(dt_survey(t, NULL) == DT_OK);
    if (counting)
        check_peak("survey", "cells", said);
    free(p);
    free(c);
    dt_free(t);
}
