/* in_process.c - triangulates without a server, edits the points, and reads triangles and neighbours.
 *
 *     cc in_process.c $(pkg-config --cflags --libs delaunay-core) -o in_process && ./in_process */
#include <stdio.h>
#include <stdlib.h>

#include <delaunay_core.h>

static enum dt_status print_triangles(const struct dt *t)
{
    uint32_t words[3 * 1000];
    size_t rows, wanted;
    struct dt_cursor c;
    enum dt_status s = dt_table_begin(t, NULL, DT_TRIANGLES, false, &c);
    while (s == DT_OK) {
        s = dt_table_read(t, &c, words, sizeof words / sizeof words[0], 1000, &rows, &wanted);
        if (s != DT_OK || rows == 0)
            break;
        for (size_t i = 0; i < rows; i++)
            printf("%u %u %u\n", words[3 * i], words[3 * i + 1], words[3 * i + 2]);
    }
    return s;
}

static enum dt_status run(struct dt *t, struct dt_ids *found)
{
    static const struct dt_point square[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}}, centre = {2, 2};
    struct dt_added added;
    struct dt_summary sum;
    enum dt_status s = dt_add(t, square, 4, &added);
    if (s == DT_OK)
        s = dt_triangulate(t, NULL);
    if (s == DT_OK)
        s = dt_add(t, &centre, 1, &added); /* from now on every edit is followed */
    if (s == DT_OK)
        s = dt_refresh(t, NULL);
    if (s == DT_OK)
        s = dt_nearest(t, (struct dt_point){3, 1}, 2, found);
    if (s != DT_OK)
        return s;
    dt_summary(t, &sum);
    printf("%u points, %u triangles; near 3 1:", sum.points, sum.triangles);
    for (size_t i = 0; i < found->n; i++)
        printf(" %u", found->v[i]);
    printf("\n");
    return print_triangles(t);
}

int main(void)
{
    struct dt_ids found = {0};
    struct dt *t = dt_new(0);
    enum dt_status s = t != NULL ? run(t, &found) : DT_NOMEM;
    if (s != DT_OK)
        fprintf(stderr, "failed: %s\n", dt_status_text(s));
    free(found.v);
    dt_free(t);
    return s == DT_OK ? 0 : 1;
}
