/* raster_file.c - see raster_file.h. GDAL writes values with all digits into an ASCII grid, but its header with 12 decimal places. So where
 * the cells lie is read from another output, a VRT. */
#include "clients/grids/raster_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/grids/vrt_frame.h"
#include "clients/reading/program.h"
#include "clients/reading/word_list.h"

bool raster_is_name(const char *name)
{
    return word_list_has_end(".tif .tiff .dem .hgt .img .vrt .bil .flt .grd", name, strlen(name));
}

bool raster_begins(const char *head, size_t n)
{
    return n >= 4 && (memcmp(head, "II*", 4) == 0 || memcmp(head, "MM\0*", 4) == 0 ||
                      memcmp(head, "II+", 4) == 0 || memcmp(head, "MM\0+", 4) == 0);
}

static bool start(struct points_file *f, const char *const *word, pid_t *pid, int *out)
{
    int failed = program_start(pid, word, -1, out, false);
    return failed == 0 ||
           points_file_stop(
               f, "to read this raster the program gdal_translate is needed (Debian: gdal-bin): %s",
               strerror(failed));
}

/* Starts gdal_translate into a description of the raster. With the option -mo it also describes a raster that is a description itself. */
static bool start_frame(struct points_file *f, const char *name, pid_t *pid, int *out)
{
    const char *word[] = {"gdal_translate",  "-q", "-of",         "VRT", "-mo",
                          "reader=delaunay", name, "/vsistdout/", NULL};
    return start(f, word, pid, out);
}

/* Starts gdal_translate into an ASCII grid of cells of 1 x 1, whose first row is the northernmost one: GDAL reverses the rows of others.
 * GDAL scales all values but the one that means: none, so a scaled value may equal that one; nan equals none. */
static bool start_values(struct points_file *f, const char *name, const struct grid_frame *frame,
                         pid_t *pid, int *out)
{
    char columns[16], rows[16];
    const char *word[] = {"gdal_translate",
                          "-q",
                          "-of",
                          "AAIGrid",
                          "-ot",
                          "Float64",
                          "-unscale",
                          "-a_ullr",
                          "0",
                          rows,
                          columns,
                          "0",
                          name,
                          "/vsistdout/",
                          frame->scaled ? "-a_nodata" : NULL,
                          "nan",
                          NULL};
    snprintf(columns, sizeof columns, "%ju", (uintmax_t)frame->columns);
    snprintf(rows, sizeof rows, "%ju", (uintmax_t)frame->rows);
    return start(f, word, pid, out);
}

/* Waits for it; `ok`: what was read is right so far. */
static bool end(struct points_file *f, pid_t pid, int out, bool ok)
{
    close(out);
    int failed = program_end(pid);
    if (!ok || failed == 0)
        return ok;
    f->line = 0;
    return points_file_stop(f, "gdal_translate could not read all of it");
}

static bool read_frame(struct points_file *f, const char *name, struct grid_frame *frame)
{
    char *text = NULL;
    size_t n;
    pid_t pid;
    int out;
    if (!start_frame(f, name, &pid, &out))
        return false;
    bool ok = points_file_read_all(f, out, &text, &n);
    ok = end(f, pid, out, ok);
    const char *fault = ok ? vrt_read_frame(text, n, frame) : NULL;
    free(text);
    return ok && (fault == NULL || points_file_stop(f, "%s", fault));
}

bool raster_file_read(struct points_file *f, const char *path, const char *member,
                      struct table_fields *t, struct grid_notes *notes)
{
    char name[4500];
    struct grid_frame frame;
    pid_t pid;
    int out;
    *notes = (struct grid_notes){.empty = 0};
    if (member[0] != '\0')
        snprintf(name, sizeof name, "/vsizip/{%s}/%s", path, member);
    else /* a path that begins with '-' is no option */
        snprintf(name, sizeof name, "%s%s", path[0] == '-' ? "./" : "", path);
    if (!read_frame(f, name, &frame) || !start_values(f, name, &frame, &pid, &out))
        return false;
    bool ok = asc_file_read(f, out, &frame, t, notes);
    return end(f, pid, out, ok);
}
