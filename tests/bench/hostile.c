/* hostile.c - how much slower families, sizes and orders of input are per point than uniform points. Most are about as
 * fast. Coordinates of extreme exponents are about 5 times slower. Points on exact circles, where every decision is a
 * tie, are about 10 times slower (README.md has the table). Runs alternate between uniform points and the
 * others. */
#include "tests/bench/hostile.h"

#include "tests/bench/measure.h"
#include "tests/bench/orders.h"

#include <stdio.h>
#include <string.h>

enum { MAX_INPUTS = 64, MAX_SIZES = 5, ROUNDS = 3 };

static size_t enter_all(struct contender *c, const struct family *f, size_t n)
{
    size_t inputs = 0;
    for (; f->name != NULL && inputs < MAX_INPUTS; f++)
        c[inputs++] = (struct contender){.build = {f, n, DT_DIVIDE, 1, true}, .rounds = ROUNDS};
    return inputs;
}

static double whole_ns(const struct contender *c)
{
    return c->best.add_ns + c->best.build_ns;
}

static void print_row(struct contender (*of_size)[MAX_INPUTS], size_t sizes, size_t i)
{
    printf("| %s |", of_size[0][i].build.family->name);
    for (size_t k = 0; k < sizes; k++) {
        const struct contender *c = &of_size[k][i], *uniform = &of_size[k][0];
        printf(" %.0f | %.2f | %.2f |", c->best.build_ns, c->best.build_ns / uniform->best.build_ns,
               whole_ns(c) / whole_ns(uniform));
    }
    printf("\n");
}

void hostile_tables(size_t min_n, size_t max_n)
{
    static struct contender of_size[MAX_SIZES][MAX_INPUTS]; /* the first input is uniform */
    size_t sizes = 0, inputs = 0;
    printf("All families, and uniform points in hostile orders, one thread, warm memory: ns per "
           "point; the ratio to\nuniform points of the same number; the same with the time that "
           "adding them takes.\n\n| input |");
    for (size_t n = min_n; n <= max_n && sizes < MAX_SIZES; n *= 10, sizes++) {
        struct contender *c = of_size[sizes];
        inputs = enter_all(c, families, n);
        inputs += enter_all(c + inputs, orders, n);
        measure_alternately(c, inputs);
        printf(" %zu points | / uniform | with adding |", n);
        fflush(stdout);
    }
    printf("\n|---|");
    for (size_t k = 0; k < sizes; k++)
        printf("---|---|---|");
    printf("\n");
    for (size_t i = 0; i < inputs; i++)
        print_row(of_size, sizes, i);
    printf("\n");
}
