/* bulk.c - sends a million points and receives their triangles, all in binary form and pipelined: the load, the
 * triangulation and the dump are sent before the first reply is read.
 *
 *     cc bulk.c $(pkg-config --cflags --libs delaunay) -lm -o bulk && ./bulk localhost 6374 1000000
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <delaunay_client.h>

/* A spiral, so that no random numbers are needed. */
static double *make_points(size_t n)
{
    double *xy = malloc(n * 2 * sizeof *xy);
    for (size_t i = 0; xy != NULL && i < n; i++) {
        double angle = 2.399963229728653 * (double)i, radius = sqrt((double)i + 0.5);
        xy[2 * i] = radius * cos(angle);
        xy[2 * i + 1] = radius * sin(angle);
    }
    return xy;
}

/* Reads a little-endian word, on a machine of any byte order. */
static uint32_t word(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static enum delaunay_result send_text(struct delaunay_client *c, const char *line)
{
    return delaunay_send(c, line, strlen(line));
}

static enum delaunay_result run(struct delaunay_client *c, const double *xy, size_t n)
{
    void *bytes = NULL;
    size_t size = 0;
    enum delaunay_result r = delaunay_send_points(c, "bulk", xy, n, NULL, NULL);
    if (r == DELAUNAY_OK)
        r = send_text(c, "TRIANGULATE bulk");
    if (r == DELAUNAY_OK)
        r = send_text(c, "TRIANGLES bulk BINARY");
    if (r == DELAUNAY_OK)
        r = send_text(c, "DROP bulk");
    for (int i = 0; i < 2 && r == DELAUNAY_OK; i++) {
        r = delaunay_receive(c, NULL, NULL);
        if (r == DELAUNAY_OK)
            printf("%s\n", delaunay_status(c)->text);
    }
    if (r == DELAUNAY_OK)
        r = delaunay_receive_bytes(c, &bytes, &size);
    if (r == DELAUNAY_OK && size >= 12) {
        const unsigned char *t = bytes;
        printf("%zu triangles, the first of them %u %u %u\n", size / 12, word(t), word(t + 4),
               word(t + 8));
    }
    free(bytes);
    return r == DELAUNAY_OK ? delaunay_receive(c, NULL, NULL) : r;
}

int main(int argc, char **argv)
{
    char why[256] = "out of memory";
    size_t n = argc > 3 ? strtoul(argv[3], NULL, 10) : 1000000;
    double *xy = make_points(n);
    struct delaunay_client *c =
        xy == NULL ? NULL
                   : delaunay_connect(argc > 1 ? argv[1] : DELAUNAY_HOST,
                                      argc > 2 ? argv[2] : DELAUNAY_PORT, why, sizeof why);
    if (c == NULL) {
        fprintf(stderr, "%s\n", why);
        free(xy);
        return 1;
    }
    enum delaunay_result r = run(c, xy, n);
    if (r != DELAUNAY_OK)
        fprintf(stderr, "%s: %s\n", delaunay_result_text(r), delaunay_status(c)->text);
    delaunay_close(c);
    free(xy);
    return r == DELAUNAY_OK ? 0 : 1;
}
