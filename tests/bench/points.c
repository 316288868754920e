/* points.c - prints a family of point sets as text, a line `x y` per point.
 *
 *     points FAMILY N [SEED]        without arguments: what families there are */
#include "tests/oracle/families.h"

#include <stdio.h>
#include <stdlib.h>

static int list_families(void)
{
    for (const struct family *f = families; f->name != NULL; f++)
        printf("%-18s %s\n", f->name, f->what);
    return 2;
}

int main(int argc, char **argv)
{
    const struct family *f = argc > 2 ? family_find(argv[1]) : NULL;
    if (f == NULL)
        return list_families();
    size_t n = strtoul(argv[2], NULL, 10);
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    if (p == NULL)
        return 1;
    family_points(f, p, n, argc > 3 ? strtoul(argv[3], NULL, 10) : 1);
    for (size_t i = 0; i < n; i++)
        printf("%.17g %.17g\n", p[i].x, p[i].y);
    free(p);
    return 0;
}
