/* points.c - prints a family of point sets as text, a line `x y` per point, or as the body of LOADB, two
 * doubles per point.
 *
 *     points [--binary] FAMILY N [SEED]        without arguments: lists the families */
#include "tests/oracle/families.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int list_families(void)
{
    for (const struct family *f = families; f->name != NULL; f++)
        printf("%-18s %s\n", f->name, f->what);
    return 2;
}

static void print_text(const struct dt_point *p, size_t n)
{
    for (size_t i = 0; i < n; i++)
        printf("%.17g %.17g\n", p[i].x, p[i].y);
}

int main(int argc, char **argv)
{
    bool binary = argc > 1 && strcmp(argv[1], "--binary") == 0;
    argc -= binary;
    argv += binary;
    const struct family *f = argc > 2 ? family_find(argv[1]) : NULL;
    if (f == NULL)
        return list_families();
    size_t n = strtoul(argv[2], NULL, 10);
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    if (p == NULL)
        return 1;
    family_points(f, p, n, argc > 3 ? strtoul(argv[3], NULL, 10) : 1);
    if (binary)
        fwrite(p, sizeof *p, n, stdout);
    else
        print_text(p, n);
    free(p);
    return fflush(stdout) == 0 ? 0 : 1;
}
