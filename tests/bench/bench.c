/* bench.c - tables of the cost of building a triangulation, in ns per point, for both engines and CGAL.
 *
 *     bench [--min N] [--max N] [--cgal PROGRAM] paper|sizes|families|hostile|edits ...
 *
 * The tables are Markdown for README.md in this folder; chart.awk draws them. Every figure except those of
 * edits is the best of several processes, and runs alternate between the programs that are compared. A
 * process builds different sets with a million points in total. "fresh" builds in memory that was never
 * touched before, "warm" in pages that the process has used already. One thread is timed by its CPU clock,
 * two by the wall clock. */
#include "tests/bench/hostile.h"
#include "tests/bench/hostile_edits.h"
#include "tests/bench/measure.h"
#include "tests/bench/paper.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *cgal = "";
static size_t min_n = 1000, max_n = 1000000;

static const struct family *family_named(const char *name)
{
    const struct family *f = family_find(name);
    if (f == NULL)
        exit(2);
    return f;
}

/* The rest of a row: "-" where nothing could be measured. */
static void cell(double v)
{
    if (v > 0)
        printf(" %.*f |", v < 10 ? 2 : 0, v);
    else
        printf(" - |");
}

static void ratio(double a, double b)
{
    cell(b > 0 ? a / b : 0);
}

/* ---- the programs that are measured ---- */

enum { ONE, TWO, FRESH, PAPER, BARE, LIST, BARE_FRESH, CONTENDERS };

/* Many rounds for figures of which ratios are computed, fewer for others and for long runs. */
static void enter(struct contender *c, const struct family *f, size_t n)
{
    bool large = n > 1000000;
    struct build build = {f, n, DT_DIVIDE, 1, true};
    for (int k = 0; k < CONTENDERS; k++)
        c[k] = (struct contender){.build = build, .rounds = large ? 1 : 3};
    c[ONE].rounds = c[TWO].rounds = c[BARE].rounds = large ? 3 : 5;
    c[LIST].rounds = large ? 1 : 2;
    c[TWO].build.threads = 2;
    c[PAPER].build.method = DT_SHELLING;
    c[FRESH].build.warm = c[BARE_FRESH].build.warm = false;
    c[BARE].cgal = c[LIST].cgal = c[BARE_FRESH].cgal = cgal;
    c[LIST].list = true;
}

static double ns(const struct contender *c)
{
    return c->best.build_ns;
}

/* ---- sizes: uniform points; runs alternate between sizes, because these are compared, too ---- */

enum { MAX_ROWS = 8 };

static void sizes_row(const struct contender *c)
{
    printf("| %zu |", c->build.n);
    cell(ns(&c[ONE]));
    cell(ns(&c[TWO]));
    cell(ns(&c[FRESH]));
    cell(c[ONE].best.add_ns);
    cell(ns(&c[PAPER]));
    cell(ns(&c[BARE]));
    cell(ns(&c[LIST]));
    ratio(ns(&c[ONE]), ns(&c[BARE]));
    ratio(ns(&c[TWO]), ns(&c[BARE]));
    ratio(ns(&c[FRESH]), ns(&c[BARE_FRESH]));
    printf("\n");
}

static void growth(struct contender (*row)[CONTENDERS], size_t rows, size_t from)
{
    const struct contender *last = row[rows - 1];
    for (size_t i = 0; i + 1 < rows; i++)
        if (row[i]->build.n == from && ns(row[i]) > 0)
            printf("ns per point of one thread, %zu points / %zu points: %.2f\n", last->build.n,
                   from, ns(&last[ONE]) / ns(&row[i][ONE]));
}

static void sizes(void)
{
    struct contender row[MAX_ROWS][CONTENDERS];
    size_t rows = 0;
    for (size_t n = min_n; n <= max_n && rows < MAX_ROWS; n *= 10)
        enter(row[rows++], family_named("uniform"), n);
    if (rows == 0)
        return;
    measure_alternately(row[0], rows * CONTENDERS);
    printf("Uniform points, ns per point; warm memory and one thread unless said.\n\n"
           "| n | divide | 2 threads | fresh | adding the points | shelling | CGAL | "
           "CGAL, ids and list | divide / CGAL | 2 threads / CGAL | both fresh |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < rows; i++)
        sizes_row(row[i]);
    printf("\n");
    growth(row, rows, 10000);
    growth(row, rows, 100000);
    printf("\n");
}

/* ---- families ---- */

static void family_row(const struct contender *c)
{
    bool large = c->build.n >= 100000; /* below this, other memory of the process dominates */
    printf("| %s |", c->build.family->name);
    cell(ns(&c[ONE]));
    cell(ns(&c[TWO]));
    cell(c[ONE].best.grid_ns);
    cell(ns(&c[BARE]));
    cell(ns(&c[LIST]));
    ratio(ns(&c[ONE]), ns(&c[BARE]));
    ratio(ns(&c[TWO]), ns(&c[BARE]));
    ratio(ns(&c[ONE]), ns(&c[TWO]));
    cell(ns(&c[FRESH]));
    cell(ns(&c[BARE_FRESH]));
    ratio(ns(&c[FRESH]), ns(&c[BARE_FRESH]));
    cell(large ? c[ONE].best.held_bytes : 0);
    cell(large ? c[FRESH].best.peak_bytes : 0);
    cell(large ? c[BARE_FRESH].best.peak_bytes : 0);
    printf("\n");
    fflush(stdout);
}

static void families_table(size_t n)
{
    static const char *const names[] = {
        "uniform",          "gaussian",   "clusters",       "kuzmin",    "lattice",
        "lattice_shuffled", "duplicates", "near_collinear", "thin_line", "circle"};
    enum { FAMILIES = sizeof names / sizeof names[0] };
    printf("Families, %zu points, ns per point; fresh: one thread in fresh memory. Bytes per point "
           "that a triangulated set holds with its grid for searches, and that a build needs at "
           "its peak.\n\n"
           "| family | 1 thread | 2 threads | grid for searches | CGAL | CGAL, ids and list | "
           "1 thread / CGAL | 2 threads / CGAL | 1 thread / 2 threads | fresh | CGAL fresh | "
           "fresh / CGAL fresh | set | peak | CGAL peak |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
           n);
    for (size_t i = 0; i < FAMILIES; i++) {
        struct contender row[CONTENDERS];
        enter(row, family_named(names[i]), n);
        row[PAPER].rounds = 0;
        measure_alternately(row, CONTENDERS);
        family_row(row);
    }
    printf("\n");
}

static void families_tables(void)
{
    for (size_t n = min_n; n <= max_n; n *= 10)
        families_table(n);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--min") == 0 && i + 1 < argc)
            min_n = strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--max") == 0 && i + 1 < argc)
            max_n = strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--cgal") == 0 && i + 1 < argc)
            cgal = argv[++i];
        else if (strcmp(argv[i], "paper") == 0)
            paper_table();
        else if (strcmp(argv[i], "sizes") == 0)
            sizes();
        else if (strcmp(argv[i], "families") == 0)
            families_tables();
        else if (strcmp(argv[i], "hostile") == 0)
            hostile_tables(min_n, max_n);
        else if (strcmp(argv[i], "edits") == 0)
            hostile_edits_table();
        else
            return 2;
    }
    return 0;
}
