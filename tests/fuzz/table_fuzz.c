/* table_fuzz.c - libFuzzer target: any bytes as a table of points, with options that the first byte chooses. A table is refused
 * with a reason, or read: then every point is in the server's range, and no line gives two. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "clients/files/survey.h"
#include "clients/files/table_file.h"
#include "clients/reading/plan_make.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

static void check_points(const struct table_file *t, const struct points_file *f)
{
    struct coincidence c;
    require(f->n <= f->line && f->fields == t->fields.n);
    for (size_t i = 0; i < 2 * f->n; i++)
        require(f->xy[i] == 0 || (fabs(f->xy[i]) >= 0x1p-142 && fabs(f->xy[i]) <= 0x1p201));
    for (size_t i = 0; i < f->n * f->fields; i++)
        require(!isinf(f->value[i]));
    require(survey_coincident(f, &c) && c.points < f->n + 1 && c.different <= c.points);
}

static void check_names(const struct table_file *t)
{
    for (size_t i = 0; i < t->fields.n; i++)
        for (size_t k = 0; k < i; k++)
            require(strcmp(t->fields.name[i], t->fields.name[k]) != 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct table_file t;
    static struct points_file f;
    const struct survey_wish wish = {.nodata = {-9999}, .nodata_n = 1};
    unsigned options = size > 0 ? data[0] : 0;
    int fd = memfd_create("table", MFD_CLOEXEC);
    require(fd >= 0 && (size < 2 || write(fd, data + 1, size - 1) == (ssize_t)size - 1) &&
            lseek(fd, 0, SEEK_SET) == 0);
    memset(&t, 0, sizeof t);
    memset(&f, 0, sizeof f);
    t.wish.xy = options % 8 == 1;
    t.wish.xyz = options % 8 == 2;
    t.wish.node = options % 8 == 3;
    if (options % 8 == 4)
        wish_columns(&t.wish, "2,1,3");
    else if (options % 8 == 5)
        wish_columns(&t.wish, "x,y,z");
    t.fields.all = (options & 8) != 0;
    f.skip_bad = (options & 16) != 0;
    t.wish.skip_lines = options >> 6;
    bool ok = table_file_read(&t, &f, fd, NULL, NULL);
    require(ok || (f.fault != NULL && f.fault[0] != '\0'));
    if (ok && survey(&f, &t, &wish))
        check_points(&t, &f);
    check_names(&t);
    close(fd);
    points_file_free(&f);
    table_file_free(&t);
    return 0;
}
