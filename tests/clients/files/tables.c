/* tables.c - see tables.h. */
#include "tests/clients/files/tables.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/test.h"

static void show(struct outcome *o, const struct source *s, const struct points_file *f)
{
    size_t n = 0;
    for (size_t i = 0; i < f->n && n + 200 < sizeof o->points; i++) {
        n += (size_t)snprintf(o->points + n, sizeof o->points - n, "%s%.10g %.10g",
                              i > 0 ? "; " : "", f->xy[2 * i], f->xy[2 * i + 1]);
        for (size_t k = 0; k < f->fields; k++)
            n += (size_t)snprintf(o->points + n, sizeof o->points - n, " %.10g",
                                  f->value[i * f->fields + k]);
    }
    n = 0;
    if (s->table.using[0] != '\0')
        n += (size_t)snprintf(o->notes, sizeof o->notes, "using %s\n", s->table.using);
    for (size_t i = 0; i < f->report.n && n + 500 < sizeof o->notes; i++)
        n += (size_t)snprintf(o->notes + n, sizeof o->notes - n, "%s: %s\n",
                              report_kind(f->report.note[i].kind), f->report.note[i].text);
}

void tables_read(struct outcome *o, const char *ending, const char *text, size_t n,
                 void (*choose)(struct source *s))
{
    char path[64];
    struct points_file f = {0};
    *o = (struct outcome){.read = false};
    snprintf(path, sizeof path, "/tmp/delaunay_tables_XXXXXX%s", ending);
    int fd = mkstemps(path, (int)strlen(ending));
    CHECK(fd >= 0 && write(fd, text, n) == (ssize_t)n && close(fd) == 0);
    struct source s = {.path = path, .form = SOURCE_GUESS};
    if (choose != NULL)
        choose(&s);
    o->read = source_read(&s, &f);
    unlink(path);
    show(o, &s, &f);
    if (!o->read)
        snprintf(o->points, sizeof o->points, "%ju: %s", (uintmax_t)f.line, f.fault);
    points_file_free(&f);
    source_free(&s);
}

void tables_expect(const char *ending, const char *text, const char *points, const char *note)
{
    struct outcome o;
    tables_read(&o, ending, text, strlen(text), NULL);
    CHECK_MSG(o.read && strcmp(o.points, points) == 0, "%s\n-> %s\n%s", text, o.points, o.notes);
    if (note != NULL)
        CHECK_MSG(note[0] == '\0' ? o.notes[0] == '\0' : strstr(o.notes, note) != NULL,
                  "%s\n-> %s\n%s", text, o.points, o.notes);
}

void tables_refuse(const char *ending, const char *text, const char *fault)
{
    struct outcome o;
    tables_read(&o, ending, text, strlen(text), NULL);
    CHECK_MSG(!o.read && strstr(o.points, fault) != NULL, "%s\n-> %s\n%s", text, o.points, o.notes);
}
