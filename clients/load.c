/* load.c - `delaunay load SET FILE`: reads the whole file first, so that a bad line leaves the set
 * as it was. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clients/command.h"
#include "clients/points_file.h"
#include "clients/progress.h"

struct reading {
    struct progress bar;
    uint64_t size; /* bytes of the file, 0 if unknown */
};

static void show_reading(void *ctx, uint64_t bytes, size_t points)
{
    struct reading *r = ctx;
    progress_update(&r->bar, bytes, r->size, points);
}

static void show_sending(void *ctx, size_t done, size_t total)
{
    progress_update(ctx, done, total, done);
}

/* Reads the file into *f; says what is wrong if anything is. */
static bool read_points(struct points_file *f, const char *path)
{
    bool standard = strcmp(path, "-") == 0;
    int fd = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    const char *name = standard ? "standard input" : path;
    if (fd < 0) {
        fprintf(stderr, "delaunay: %s: %s\n", name, strerror(errno));
        return false;
    }
    struct reading r = {0};
    struct stat st;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode))
        r.size = (uint64_t)st.st_size;
    progress_start(&r.bar, "reading");
    bool ok = points_file_read(f, fd, show_reading, &r);
    progress_end(&r.bar);
    if (!standard)
        close(fd);
    if (!ok && f->line > 0)
        fprintf(stderr, "delaunay: %s:%ju: %s; nothing was loaded\n", name, (uintmax_t)f->line,
                f->fault);
    else if (!ok)
        fprintf(stderr, "delaunay: %s: %s; nothing was loaded\n", name, f->fault);
    return ok;
}

int command_load(struct delaunay_client *c, const char *set, const char *path)
{
    struct points_file f = {0};
    if (!read_points(&f, path)) {
        points_file_free(&f);
        return EXIT_REFUSED;
    }
    struct progress bar;
    progress_start(&bar, "sending");
    enum delaunay_result r = delaunay_send_points(c, set, f.xy, f.n, show_sending, &bar);
    progress_end(&bar);
    points_file_free(&f);
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, command_show_comment, NULL);
    if (r == DELAUNAY_OK)
        puts(delaunay_status(c)->text);
    return command_outcome(c, r);
}
