/* lines_fuzz.c - libFuzzer target: any bytes as a .poly file, with points of its own or after a NUL byte, and as an OBJ file. The corners
 * of the lines that are read are points; a bad text has a fault. */
#include "clients/lines/obj_file.h"
#include "clients/lines/poly_file.h"
#include "clients/points/clean_paths.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

static void check(struct points_file *f, bool ok)
{
    require(ok || f->fault != NULL);
    for (size_t i = 0; i < 2 * f->n; i++)
        require(isfinite(f->xy[i]));
    for (size_t i = 0; ok && i < f->paths.n; i++)
        for (size_t k = 0; k < f->paths.path[i].n; k++)
            require(f->paths.corner[f->paths.path[i].first + k] < f->n);
    if (ok) {
        size_t n, points = f->n;
        require(paths_clean(f) && f->n == points);
        struct segment *segment = paths_segments(&f->paths, &n);
        require(segment != NULL && n <= f->paths.segments);
        free(segment);
    }
    points_file_free(f);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct points_file f = {0};
    struct table_fields *t = calloc(2, sizeof *t);
    struct poly_notes poly;
    struct obj_notes obj;
    char *text = malloc(size + 1); /* of this size, so that reading beyond it is noticed */
    memcpy(text, data, size);
    text = realloc(text, size > 0 ? size : 1);
    const char *nul = memchr(text, '\0', size);
    size_t n = nul != NULL ? (size_t)(nul - text) : size;
    check(&f, poly_text_read(&f, text, n, nul != NULL ? nul + 1 : NULL,
                             nul != NULL ? size - n - 1 : 0, &t[0], &poly));
    f.skip_bad = size % 2 == 0;
    check(&f, obj_text_read(&f, text, size, &t[1], &obj));
    free(t);
    free(text);
    return 0;
}
