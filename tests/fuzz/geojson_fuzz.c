/* geojson_fuzz.c - libFuzzer target: any bytes as GeoJSON. Points have coordinates that the daemon takes; a text without faults gives
 * the same points when bad ones may be skipped, and the same number of them with all properties as fields. */
#include "clients/files/geojson_file.h"

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

static bool read_text(struct points_file *f, const char *text, size_t n, bool all, bool skip_bad)
{
    struct table_fields *t = calloc(1, sizeof *t);
    struct geojson_notes notes;
    f->skip_bad = skip_bad;
    t->all = all;
    bool ok = geojson_text_read(f, text, n, t, &notes);
    require(ok == (f->fault == NULL) || (ok && f->skipped > 0));
    require(f->fields == t->n);
    for (size_t i = 0; i < 2 * f->n; i++)
        require(f->xy[i] == 0 || (fabs(f->xy[i]) >= 0x1p-142 && fabs(f->xy[i]) <= 0x1p201));
    for (size_t i = 0; i < f->paths.n; i++)
        for (size_t k = 0; k < f->paths.path[i].n; k++)
            require(f->paths.corner[f->paths.path[i].first + k] < f->n);
    for (size_t i = 0; i < f->fields * f->n; i++)
        require(!isinf(f->value[i]));
    free(t);
    return ok;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct points_file strict = {0}, lenient = {0}, full = {0};
    char *text = malloc(size + 1); /* of this size, so that reading beyond it is noticed */
    memcpy(text, data, size);
    text = realloc(text, size > 0 ? size : 1);
    bool ok = read_text(&strict, text, size, false, false);
    bool skipped = read_text(&lenient, text, size, false, true);
    require(read_text(&full, text, size, true, false) == ok);
    if (ok) {
        require(skipped && lenient.skipped == 0 && lenient.n == strict.n && full.n == strict.n);
        require(strict.n == 0 ||
                memcmp(strict.xy, lenient.xy, 2 * strict.n * sizeof strict.xy[0]) == 0);
    }
    require(lenient.n >= strict.n || !skipped);
    points_file_free(&strict);
    points_file_free(&lenient);
    points_file_free(&full);
    free(text);
    return 0;
}
