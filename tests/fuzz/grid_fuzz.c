/* grid_fuzz.c - libFuzzer target: any bytes as an ASCII grid, in its own frame and in that of a VRT before a NUL byte. Each cell is a
 * point, is empty, or was skipped; a bad text has a fault. */
#include "clients/grids/vrt_frame.h"

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

static void read_text(const char *text, size_t n, const struct grid_frame *frame, bool skip_bad)
{
    struct points_file f = {.skip_bad = skip_bad};
    struct table_fields *t = calloc(1, sizeof *t);
    struct grid_notes notes;
    char how[120];
    bool ok = asc_text_read(&f, text, n, frame, t, &notes);
    uint64_t cells = (uint64_t)notes.frame.columns * notes.frame.rows;
    require(ok || f.fault != NULL);
    require(!ok || f.n + f.skipped + notes.empty == cells);
    require(skip_bad || f.skipped == 0);
    for (size_t i = 0; i < f.n; i++)
        require(isfinite(f.xy[2 * i]) && isfinite(f.xy[2 * i + 1]) && isfinite(f.value[i]));
    grid_describe(&notes, how, sizeof how);
    points_file_free(&f);
    free(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct grid_frame frame;
    char *text =
        malloc(size > 0 ? size : 1); /* of this size, so that reading beyond it is noticed */
    memcpy(text, data, size);
    const char *nul = memchr(text, '\0', size);
    size_t n = nul != NULL ? (size_t)(nul - text) : size;
    asc_begins(text, n);
    read_text(text, n, NULL, size % 2 == 0);
    if (nul != NULL && vrt_read_frame(text, n, &frame) == NULL)
        read_text(nul + 1, size - n - 1, &frame, size % 2 == 0);
    free(text);
    return 0;
}
