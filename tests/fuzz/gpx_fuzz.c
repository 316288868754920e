/* gpx_fuzz.c - libFuzzer target: any bytes as GPX. Points have coordinates that the daemon takes, and a text without faults gives the
 * same points when bad ones may be skipped. */
#include "clients/files/gpx_file.h"

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

static bool read_text(struct points_file *f, const char *text, size_t n, bool skip_bad)
{
    struct table_fields *t = calloc(1, sizeof *t);
    struct gpx_notes notes;
    char how[120];
    f->skip_bad = skip_bad;
    bool ok = gpx_text_read(f, text, n, t, &notes);
    require(f->fields == t->n && f->fields == notes.heights);
    require(notes.points[0] + notes.points[1] + notes.points[2] == f->n);
    for (size_t i = 0; i < 2 * f->n; i++)
        require(f->xy[i] == 0 || (fabs(f->xy[i]) >= 0x1p-142 && fabs(f->xy[i]) <= 0x1p201));
    gpx_describe(&notes, how, sizeof how);
    free(t);
    return ok;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct points_file strict = {0}, lenient = {0};
    char *text =
        malloc(size > 0 ? size : 1); /* of this size, so that reading beyond it is noticed */
    memcpy(text, data, size);
    bool ok = read_text(&strict, text, size, false);
    bool skipped = read_text(&lenient, text, size, true);
    if (ok)
        require(skipped && lenient.skipped == 0 && lenient.n == strict.n);
    require(lenient.n >= strict.n);
    points_file_free(&strict);
    points_file_free(&lenient);
    free(text);
    return 0;
}
