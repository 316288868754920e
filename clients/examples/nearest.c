/* nearest.c - adds some points, triangulates, asks for the nearest ones.
 *
 *     cc nearest.c $(pkg-config --cflags --libs delaunay) -o nearest && ./nearest localhost 6374 */
#include <stdio.h>

#include <delaunay_client.h>

static bool print(void *ctx, const struct delaunay_part *part)
{
    if (part->kind != DELAUNAY_PART_COMMENT)
        fprintf(ctx, "%.*s\n", (int)part->len, part->text);
    return true;
}

int main(int argc, char **argv)
{
    static const char *const requests[] = {"ADD example 0 0  4 0  4 4  0 4  2 2",
                                           "TRIANGULATE example", "NEAREST example 3 1 2",
                                           "DROP example"};
    char why[256];
    struct delaunay_client *c = delaunay_connect(
        argc > 1 ? argv[1] : DELAUNAY_HOST, argc > 2 ? argv[2] : DELAUNAY_PORT, why, sizeof why);
    if (c == NULL) {
        fprintf(stderr, "%s\n", why);
        return 1;
    }
    enum delaunay_result r = DELAUNAY_OK;
    for (int i = 0; i < 4 && r == DELAUNAY_OK; i++)
        r = delaunay_request(c, requests[i], print, stdout);
    if (r != DELAUNAY_OK)
        fprintf(stderr, "%s\n", delaunay_result_text(r));
    delaunay_close(c);
    return r == DELAUNAY_OK ? 0 : 1;
}
