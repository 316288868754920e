/* wkt_fuzz.c - libFuzzer target: any bytes as a geometry in well-known text. The geometry is read as a whole, or not at all. */
#include "clients/lines/wkt_lines.h"
#include "clients/points/clean_paths.h"
#include "clients/reading/wkt.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

static void check_paths(const struct points_file *f)
{
    size_t corners = 0;
    for (size_t i = 0; i < f->paths.n; i++) {
        const struct path *path = &f->paths.path[i];
        require(path->first + path->n <= f->paths.corners && path->number <= PATHS_MOST_NUMBER);
        corners += path->n;
        for (size_t k = 0; k < path->n; k++)
            require(f->paths.corner[path->first + k] < f->n);
    }
    require(corners <= f->paths.corners);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct points_file f = {.fields = 1};
    struct wkt_name name = {.named = size % 3 == 0, .border = size % 2 == 0, .number = 7};
    double z = 0;
    bool solid;
    size_t n;
    char *text = malloc(size + 1); /* of this size, so that reading beyond it is noticed */
    memcpy(text, data, size);
    text = realloc(text, size > 0 ? size : 1);
    struct value v = {text, size};
    f.row = &z;
    bool geometry = wkt_is_geometry(v, &solid);
    bool ok = wkt_lines_read(&f, v, &name, &z);
    require(ok ? geometry : f.n == 0 && f.paths.n == 0);
    check_paths(&f);
    const size_t before = f.n;
    require(paths_clean(&f) && f.n <= before);
    check_paths(&f);
    struct segment *segment = paths_segments(&f.paths, &n);
    require(segment != NULL && n <= f.paths.segments);
    for (size_t i = 0; i < n; i++)
        require(segment[i].a < segment[i].b && segment[i].b < f.n);
    free(segment);
    points_file_free(&f);
    free(text);
    return 0;
}
