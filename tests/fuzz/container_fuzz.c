/* container_fuzz.c - libFuzzer target: any bytes as an archive, as LAS and as a header of LAS. */
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "clients/files/las_file.h"
#include "clients/files/zip_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

static int as_file(const uint8_t *data, size_t size)
{
    int fd = memfd_create("fuzz", MFD_CLOEXEC);
    require(fd >= 0 && write(fd, data, size) == (ssize_t)size && lseek(fd, 0, SEEK_SET) == 0);
    return fd;
}

static void read_las(int fd, bool all)
{
    struct points_file f = {.skip_bad = true};
    struct table_fields *t = calloc(1, sizeof *t);
    struct las_notes notes;
    bool compressed;
    t->all = all;
    require(lseek(fd, 0, SEEK_SET) == 0);
    las_is_compressed(&f, fd, &compressed);
    if (las_file_read(&f, fd, t, &notes))
        require(!compressed && f.fields == t->n && f.fields == (all ? 3 : 1));
    for (size_t i = 0; i < 2 * f.n; i++)
        require(isfinite(f.xy[i]));
    points_file_free(&f);
    free(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct zip_member m = {.fd = -1};
    struct las_header h;
    char why[300] = "";
    int fd = as_file(data, size);
    if (zip_open(fd, &m, why, sizeof why)) {
        require(m.fd >= 0 && memchr(m.name, 0, sizeof m.name) != NULL);
        close(m.fd);
    } else {
        require(why[0] != '\0');
    }
    read_las(fd, false);
    read_las(fd, true);
    if (las_read_header(&h, data, size) == NULL)
        require(h.record >= 20 && h.format < 11 && h.scale[0] != 0);
    close(fd);
    return 0;
}
