/* laz_file.c - see laz_file.h. The header is not compressed: it says how many points and decimal places there are. The programs write
 * a line `x,y,z` for each point. */
#include "clients/files/laz_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "clients/files/las_file.h"
#include "clients/reading/program.h"
#include "proto/number.h"

enum { USUAL_PLACES = 9 };

/* pdal [pdal.org/stages/writers.text.html], then las2txt. Returns an errno; *name gets the program's. */
static int start_any(const char *path, const struct las_header *h, pid_t *pid, int *out,
                     const char **name)
{
    int places = h->digits >= 0 ? h->digits : USUAL_PLACES;
    char order[80], in[4200];
    /* a path that begins with '-' is no option */
    snprintf(in, sizeof in, "%s%s", path[0] == '-' ? "./" : "", path);
    snprintf(order, sizeof order, "--writers.text.order=X:%d,Y:%d,Z:%d", places, places, places);
    const char *pdal[] = {"pdal",
                          "translate",
                          "--writer",
                          "writers.text",
                          order,
                          "--writers.text.keep_unspecified=false",
                          "--writers.text.write_header=false",
                          in,
                          "STDOUT",
                          NULL};
    const char *las2txt[] = {"las2txt", "-i",   in,      "-stdout", "-parse",
                             "xyz",     "-sep", "comma", NULL};
    *name = "pdal";
    int failed = program_start(pid, pdal, -1, out, false);
    if (failed == ENOENT) {
        *name = "las2txt";
        failed = program_start(pid, las2txt, -1, out, false);
    }
    return failed;
}

/* A line `x,y,z`. */
static bool read_line(struct points_file *f, const char *s, size_t len)
{
    const char *end = s + len, *word[3] = {s, NULL, NULL};
    double z;
    int n = 1;
    while (len > 0 && (end[-1] == '\r' || end[-1] == '\n'))
        end--, len--;
    for (const char *p = s; p < end && n < 3; p++)
        if (*p == ',')
            word[n++] = p + 1;
    if (n < 3 || !proto_read_double(word[2], (size_t)(end - word[2]), &z))
        return points_file_stop(f, "the program has written a line that is not x,y,z: %.*s",
                                len < 60 ? (int)len : 60, s);
    f->row = &z;
    bool ok = points_file_add(f, word[0], (size_t)(word[1] - word[0]) - 1, word[1],
                              (size_t)(word[2] - word[1]) - 1) ||
              points_file_skip(f, s, len);
    f->row = NULL;
    return ok;
}

static bool read_lines(struct points_file *f, int fd)
{
    FILE *in = fdopen(fd, "r");
    char line[400];
    bool ok = in != NULL || points_file_stop(f, "out of memory");
    while (ok && fgets(line, sizeof line, in) != NULL) {
        f->line++;
        ok = read_line(f, line, strlen(line));
    }
    if (in != NULL)
        fclose(in);
    else
        close(fd);
    return ok;
}

bool laz_file_read(struct points_file *f, const char *path, int fd, struct table_fields *t)
{
    unsigned char bytes[LAS_HEADER];
    struct las_header h;
    const char *name = NULL;
    int out = -1;
    pid_t pid;
    ssize_t n = pread(fd, bytes, sizeof bytes, 0);
    const char *fault = las_read_header(&h, bytes, n > 0 ? (size_t)n : 0);
    if (fault != NULL)
        return points_file_stop(f, "%s", fault);
    int failed = start_any(path, &h, &pid, &out, &name);
    if (failed != 0)
        return points_file_stop(
            f, "to read LAZ the program pdal (Debian: pdal) or las2txt is needed: %s",
            strerror(failed));
    table_fields_add(t, 2, "z", 1);
    f->fields = 1;
    bool ok = read_lines(f, out);
    int status = program_end(pid);
    f->line = ok ? 0 : f->line;
    if (ok && status != 0)
        return points_file_stop(f, "%s could not read all of it", name);
    if (ok && f->n + f->skipped != h.points)
        return points_file_stop(f, "%s has written %zu of %ju points", name, f->n,
                                (uintmax_t)h.points);
    return ok;
}
