/* text_lines.c - see text_lines.h. */
#include "clients/lines/text_lines.h"

#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"

struct text_lines_scan text_lines_begin(const char *text, size_t n)
{
    return (struct text_lines_scan){.p = text + text_mark_length(text, n), .end = text + n};
}

static bool add_word(struct text_lines_scan *s, const char *from, const char *to)
{
    if (!array_reserve((void **)&s->word, &s->cap, s->n + 1, sizeof s->word[0]))
        return false;
    s->word[s->n++] = (struct value){from, (size_t)(to - from)};
    return true;
}

static bool split(struct text_lines_scan *s)
{
    const char *p = s->text, *end = s->text + s->len;
    s->n = 0;
    while (p < end) {
        while (p < end && value_is_blank(*p))
            p++;
        const char *from = p;
        while (p < end && !value_is_blank(*p))
            p++;
        if (p > from && !add_word(s, from, p))
            return false;
    }
    return true;
}

bool text_lines_next(struct text_lines_scan *s, struct points_file *f)
{
    s->n = 0;
    while (s->p < s->end) {
        const char *lf = memchr(s->p, '\n', (size_t)(s->end - s->p));
        const char *stop = lf != NULL ? lf : s->end;
        const char *comment = memchr(s->p, '#', (size_t)(stop - s->p));
        s->text = s->p;
        s->len = (size_t)((comment != NULL ? comment : stop) - s->p);
        s->p = lf != NULL ? lf + 1 : s->end;
        f->line = ++s->line;
        if (!split(s)) {
            points_file_stop(f, "out of memory");
            return false;
        }
        if (s->n > 0)
            return true;
    }
    return false;
}

void text_lines_end(struct text_lines_scan *s)
{
    free(s->word);
    s->word = NULL;
    s->n = s->cap = 0;
}

void text_lines_take_back(struct points_file *f)
{
    f->paths.n--;
    f->paths.corners = f->paths.path[f->paths.n].first;
}
