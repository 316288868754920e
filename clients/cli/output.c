/* output.c - see output.h. */
#include "clients/cli/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/message.h"
#include "clients/cli/part_file.h"
#include "clients/cli/request.h"

int output_fault(const char *about, const char *what)
{
    message_print("%s%s%s", about, about[0] != '\0' ? ": " : "", what);
    return EXIT_REFUSED;
}

int output_failed(const char *path)
{
    return output_fault(path, strerror(errno));
}

bool output_is_plain(void)
{
    const char *no_color = getenv("NO_COLOR"); /* no-color.org */
    return !isatty(STDOUT_FILENO) || (no_color != NULL && no_color[0] != '\0');
}

bool output_is_standard(const char *path)
{
    return strcmp(path, "-") == 0;
}

int output_check(const char *path, bool force)
{
    if (output_is_standard(path) || force || !part_file_is_foreign(path))
        return EXIT_DONE;
    return output_fault(path, "there is such a file, not written by delaunay or changed since; "
                              "--force replaces it");
}

bool output_beside(const char *path, const char *ending, char *to, size_t room)
{
    const char *dot = strrchr(path, '.');
    size_t n = dot != NULL && strchr(dot, '/') == NULL ? (size_t)(dot - path) : strlen(path);
    return (size_t)snprintf(to, room, "%.*s.%s", (int)n, path, ending) < room;
}

int output_check_beside(const char *path, const char *ending, bool force, char to[OUTPUT_PATH])
{
    return output_beside(path, ending, to, OUTPUT_PATH)
               ? output_check(to, force)
               : output_fault(path, "the name is too long");
}

const char *output_form(const char *named, const char *path, const char *standard)
{
    const char *dot = strrchr(path, '.');
    if (named != NULL)
        return named;
    return output_is_standard(path) || dot == NULL || strchr(dot, '/') != NULL ? standard : dot + 1;
}

int output_write(const char *path, output_write_fn *write, void *ctx, output_convert_fn *convert)
{
    struct part_file f;
    if (output_is_standard(path)) {
        int status = write(ctx, stdout);
        return status == EXIT_DONE && fflush(stdout) != 0 ? output_failed("standard output")
                                                          : status;
    }
    const char *fault = part_file_open(&f, path);
    if (fault != NULL)
        return output_failed(fault);
    setvbuf(f.out, NULL, _IOFBF, 1 << 18);
    int status = write(ctx, f.out);
    bool written = part_file_close(&f);
    if (status == EXIT_DONE && !written)
        status = output_failed(path);
    if (status == EXIT_DONE && convert != NULL)
        status = convert(f.part, path);
    if (status == EXIT_DONE && !part_file_keep(&f))
        status = output_failed(path);
    if (status != EXIT_DONE)
        part_file_drop(&f);
    return status;
}
