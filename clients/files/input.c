/* input.c - see input.h. A file is recognised by its first bytes. tee(2) copies the first bytes of a pipe, because it
 * does not consume them. */
#include "clients/files/input.h"

#include "clients/files/ogr_file.h"
#include "clients/files/zip_file.h"
#include "clients/grids/asc_grid.h"
#include "clients/grids/raster_file.h"
#include "clients/reading/program.h"
#include "proto/text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PEEK = 64 };

static const struct {
    const char *magic;
    size_t len;
    const char *argument[6];
} converters[] = {
    {"\x1F\x8B", 2, {"gzip", "-dc", NULL}},
    {"\xFF\xFE", 2, {"iconv", "-f", "UTF-16", "-t", "UTF-8", NULL}},
    {"\xFE\xFF", 2, {"iconv", "-f", "UTF-16", "-t", "UTF-8", NULL}},
    {"BZh", 3, {"bzip2", "-dc", NULL}},
    {"\xFD"
     "7zXZ",
     5,
     {"xz", "-dc", NULL}},
    {"\x28\xB5\x2F\xFD", 4, {"zstd", "-dc", NULL}},
};

static size_t peek(int fd, char *to)
{
    int pipes[2];
    ssize_t n = pread(fd, to, PEEK, 0);
    if (n >= 0 || errno != ESPIPE)
        return n > 0 ? (size_t)n : 0;
    if (pipe2(pipes, O_CLOEXEC) != 0)
        return 0;
    n = tee(fd, pipes[1], PEEK, 0);
    if (n > 0)
        n = read(pipes[0], to, PEEK);
    close(pipes[0]);
    close(pipes[1]);
    return n > 0 ? (size_t)n : 0;
}

/* Starts the program with fd as its input, and replaces fd by its output. */
static bool convert(struct input *in, const char *const *argument)
{
    int out, failed = program_start(&in->child, argument, in->fd, &out, false);
    if (failed != 0) {
        in->child = 0;
        errno = failed;
        return false;
    }
    if (!in->standard)
        close(in->fd);
    in->standard = false;
    in->fd = out;
    return true;
}

static char first_character(const char *text, size_t n)
{
    size_t i = text_mark_length(text, n);
    while (i < n && strchr(" \t\r\n", text[i]) != NULL)
        i++;
    return i < n ? text[i] : '\0';
}

/* Replaces the archive by the file in it. */
static bool open_member(struct input *in, char *why, size_t room)
{
    struct zip_member m;
    if (!zip_open(in->fd, &m, why, room)) {
        input_close(in, false, why, room);
        return false;
    }
    if (!in->standard)
        close(in->fd);
    in->standard = false;
    in->fd = m.fd;
    in->size = 0;
    memcpy(in->member, m.name, sizeof in->member);
    return true;
}

static bool open_by_ogr(struct input *in, const char *path, char *why, size_t room)
{
    close(in->fd);
    in->size = 0;
    in->first = '{';
    in->program = ogr_program;
    return ogr_start(path, &in->child, &in->fd, why, room);
}

/* Looks at the first bytes of the content. */
static size_t look(struct input *in, char *head)
{
    size_t n = peek(in->fd, head);
    in->first = first_character(head, n);
    in->las = n >= 4 && memcmp(head, "LASF", 4) == 0;
    in->grid = asc_begins(head, n);
    in->raster = raster_begins(head, n);
    return n;
}

bool input_open(struct input *in, const char *path, char *why, size_t room)
{
    char head[PEEK];
    struct stat st;
    *in = (struct input){.standard = strcmp(path, "-") == 0};
    in->fd = in->standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (in->fd < 0) {
        snprintf(why, room, "%s", strerror(errno));
        return false;
    }
    if (fstat(in->fd, &st) == 0 && S_ISREG(st.st_mode))
        in->size = (uint64_t)st.st_size;
    if (!in->standard && ogr_is_name(path))
        return open_by_ogr(in, path, why, room);
    size_t n = look(in, head);
    in->raster |= !in->standard && !in->grid && raster_is_name(path);
    if (n >= 4 && memcmp(head, "PK\3\4", 4) == 0) {
        if (!open_member(in, why, room))
            return false;
        n = look(in, head);
        in->raster |= !in->grid && raster_is_name(in->member);
    }
    for (size_t i = 0; i < sizeof converters / sizeof converters[0]; i++) {
        if (n < converters[i].len || memcmp(head, converters[i].magic, converters[i].len) != 0)
            continue;
        in->program = converters[i].argument[0];
        in->size = 0;
        if (convert(in, converters[i].argument)) {
            look(in, head);
            return true;
        }
        snprintf(why, room, "to read this file the program %s is needed: %s", in->program,
                 strerror(errno));
        input_close(in, false, head, sizeof head);
        return false;
    }
    return true;
}

bool input_close(struct input *in, bool all, char *why, size_t room)
{
    if (!in->standard)
        close(in->fd);
    if (in->child == 0)
        return true;
    int status = program_end(in->child);
    if (status != 0 && all)
        snprintf(why, room, "%s could not read all of it%s", in->program,
                 in->program == ogr_program ? ogr_hint : "");
    return status == 0 || !all;
}
