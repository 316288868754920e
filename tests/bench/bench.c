/* bench.c - tables of what building a triangulation costs, in ns per point, for both engines and
 * beside CGAL.
 *
 *     bench [--min N] [--max N] [--cgal PROGRAM] paper|sizes|families ...
 *
 * The tables are Markdown, ready for the README; chart.awk draws them. Every figure is the best of
 * three processes; a process builds as many different sets as make a million points. "fresh" builds
 * in memory never touched before, "warm" in pages that the process has used already. One thread is
 * timed by its CPU clock, two by the clock on the wall. */
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

/* A cell of a table: "-" where nothing could be measured. Returns v. */
static double cell(double v)
{
    if (v > 0)
        printf(" %.*f |", v < 10 ? 2 : 0, v);
    else
        printf(" - |");
    fflush(stdout);
    return v;
}

static double ratio(double a, double b)
{
    return b > 0 ? a / b : 0;
}

static double build_ns(const struct build *b)
{
    struct cost c;
    return measure(b, &c) ? c.build_ns : 0;
}

static double cgal_ns(const struct build *b, bool list)
{
    struct peer_cost c;
    return measure_cgal(cgal, b, list, &c) ? c.build_ns : 0;
}

/* ---- sizes: uniform points, 1e3 to --max ---- */

static void sizes_row(size_t n, double *divide_per_point)
{
    struct build b = {family_named("uniform"), n, DT_DIVIDE, 1, true};
    struct cost c = {0};
    printf("| %zu |", n);
    *divide_per_point = cell(measure(&b, &c) ? c.build_ns : 0);
    cell(c.add_ns);
    b.threads = 2;
    cell(build_ns(&b));
    b.threads = 1;
    b.warm = false;
    double fresh = cell(build_ns(&b));
    b.method = DT_SHELLING;
    b.warm = true;
    cell(build_ns(&b));
    double bare = cell(cgal_ns(&b, false));
    cell(cgal_ns(&b, true));
    cell(ratio(*divide_per_point, bare));
    b.warm = false;
    cell(ratio(fresh, cgal_ns(&b, false)));
    printf("\n");
}

static void sizes(void)
{
    double first = 0, last = 0, ns;
    printf(
        "Uniform points, ns per point; warm memory and one thread unless said.\n\n"
        "| n | divide | adding the points | divide, 2 threads | divide, fresh | shelling | CGAL | "
        "CGAL, ids and list | divide / CGAL | both fresh "
        "|\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t n = min_n; n <= max_n; n *= 10) {
        sizes_row(n, &ns);
        if (n == 10000)
            first = ns;
        last = ns;
    }
    if (first > 0 && max_n > 10000)
        printf("\ndivide: ns per point at the largest n / at 10000 = %.2f\n", last / first);
    printf("\n");
}

/* ---- families ---- */

static void families_row(const struct family *f, size_t n)
{
    struct build one = {f, n, DT_DIVIDE, 1, true}, two = {f, n, DT_DIVIDE, 2, true};
    struct build fresh = {f, n, DT_DIVIDE, 1, false};
    struct cost warm = {0}, c = {0};
    struct peer_cost peer = {0};
    printf("| %s | %zu |", f->name, n);
    double serial = cell(measure(&one, &warm) ? warm.build_ns : 0), parallel = cell(build_ns(&two));
    cell(measure(&fresh, &c) ? c.build_ns : 0);
    double bare = cell(cgal_ns(&one, false));
    cell(cgal_ns(&one, true));
    double fresh_bare = cell(measure_cgal(cgal, &fresh, false, &peer) ? peer.build_ns : 0);
    cell(ratio(serial, bare));
    cell(ratio(parallel, bare));
    cell(ratio(c.build_ns, fresh_bare));
    cell(n >= 100000 ? c.held_bytes : 0); /* below, what the process holds beside hides it */
    cell(n >= 100000 ? c.peak_bytes : 0);
    cell(n >= 100000 ? peer.peak_bytes : 0);
    cell(warm.grid_ns);
    printf("\n");
}

static void families_table(void)
{
    static const char *const names[] = {
        "uniform",          "gaussian",   "clusters",       "kuzmin",    "lattice",
        "lattice_shuffled", "duplicates", "near_collinear", "thin_line", "circle"};
    printf("Families, engine divide, ns per point; bytes per point.\n\n"
           "| family | n | 1 thread | 2 threads | fresh | CGAL | CGAL, ids and list | CGAL fresh | "
           "1 thread / CGAL | "
           "2 threads / CGAL | fresh / CGAL fresh | set | peak | CGAL peak | grid for searches |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t n = min_n; n <= max_n; n *= 10)
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            families_row(family_named(names[i]), n);
    printf("\n");
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
            families_table();
        else
            return 2;
    }
    return 0;
}
