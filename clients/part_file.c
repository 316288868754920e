/* part_file.c - see part_file.h. */
#include "clients/part_file.h"

#include <errno.h>
#include <unistd.h>

const char *part_file_open(struct part_file *f, const char *path)
{
    f->path = path;
    if ((size_t)snprintf(f->part, sizeof f->part, "%s.part", path) >= sizeof f->part) {
        errno = ENAMETOOLONG;
        return path;
    }
    f->out = fopen(f->part, "w");
    return f->out == NULL ? f->part : NULL;
}

bool part_file_close(struct part_file *f)
{
    bool written = !ferror(f->out);
    return fclose(f->out) == 0 && written;
}

bool part_file_keep(struct part_file *f)
{
    return rename(f->part, f->path) == 0;
}

void part_file_drop(struct part_file *f)
{
    unlink(f->part);
}
