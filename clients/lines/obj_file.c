/* obj_file.c - see obj_file.h. */
#include "clients/lines/obj_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lines/text_lines.h"
#include "proto/number.h"

struct obj {
    struct points_file *f;
    struct table_fields *fields;
    struct obj_notes *notes;
    struct text_lines_scan scan;
    double z;
    bool named, border; /* the group has a name of our files */
    uint32_t number;
};

static bool is(const struct obj *o, const char *word)
{
    return o->scan.n > 0 && value_is_word(o->scan.word[0], word);
}

static bool bad_number(struct obj *o, struct value v)
{
    char text[60];
    return points_file_bad(o->f, "not a number: \"%s\"",
                           report_clean(text, sizeof text, v.text, v.len));
}

/* Without it the numbers of the others would be wrong, so it cannot be skipped. */
static bool read_point(struct obj *o)
{
    double v[3] = {0, 0, 0};
    bool ok = o->scan.n >= 3 || points_file_fault(o->f, "a point needs x and y");
    for (size_t k = 0; ok && k < 3 && k + 1 < o->scan.n; k++)
        ok = proto_read_double(o->scan.word[k + 1].text, o->scan.word[k + 1].len, &v[k]) ||
             bad_number(o, o->scan.word[k + 1]);
    o->z = isfinite(v[2]) ? v[2] : (double)NAN;
    if (isnan(o->z) && o->notes->heights)
        table_fields_note_odd(o->fields, 0, o->f->line, o->scan.word[3].text, o->scan.word[3].len);
    ok = ok && points_file_append(o->f, v[0], v[1]);
    o->f->fatal |= !ok;
    return ok;
}

/* `7`, `7/3`, or counted back from the last point, `-1`. */
static bool read_corner(struct obj *o, struct value v)
{
    const char *slash = memchr(v.text, '/', v.len);
    size_t len = slash != NULL ? (size_t)(slash - v.text) : v.len;
    bool back = len > 0 && v.text[0] == '-';
    uint32_t i;
    if (!proto_read_u32(v.text + back, len - back, &i))
        return bad_number(o, v);
    if (i == 0 || i > o->f->n)
        return points_file_bad(o->f, "there is no point %.*s before", (int)(len < 20 ? len : 20),
                               v.text);
    return paths_corner(&o->f->paths, back ? o->f->n - i : i - 1) ||
           points_file_stop(o->f, "out of memory");
}

static bool read_line(struct obj *o)
{
    uint32_t number = o->number;
    if (o->scan.n < 3)
        return points_file_fault(o->f, "a line needs two points");
    if (!o->named && !points_file_number(o->f, &number))
        return false;
    if (!points_file_begin_path(o->f, o->named && o->border, number, 0))
        return false;
    for (size_t k = 1; k < o->scan.n; k++)
        if (!read_corner(o, o->scan.word[k])) {
            text_lines_take_back(o->f);
            return false;
        }
    points_file_end_path(o->f, false);
    return true;
}

static bool read_element(struct obj *o)
{
    if (is(o, "v"))
        return read_point(o);
    if (is(o, "l"))
        return read_line(o);
    if (is(o, "g") || is(o, "o"))
        o->named = o->scan.n == 2 && paths_read_name(o->scan.word[1].text, o->scan.word[1].len,
                                                     &o->border, &o->number);
    else if (is(o, "f"))
        o->notes->faces++;
    else
        o->notes->others++;
    return true;
}

/* Learns whether there are heights. */
static void look(struct obj *o, const char *text, size_t n)
{
    struct text_lines_scan s = text_lines_begin(text, n);
    double z;
    while (text_lines_next(&s, o->f))
        if (s.n > 3 && value_is_word(s.word[0], "v"))
            o->notes->heights |= proto_read_double(s.word[3].text, s.word[3].len, &z) && z != 0;
    o->f->fault = NULL;
    o->f->fatal = false;
    o->scan = s;
    text_lines_end(&o->scan);
}

bool obj_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                   struct obj_notes *notes)
{
    struct obj o = {.f = f, .fields = t, .notes = notes};
    bool ok = true;
    *notes = (struct obj_notes){.heights = false};
    look(&o, text, n);
    if (notes->heights)
        table_fields_add_height(t, 0, "z", 1);
    f->fields = t->n;
    f->row = &o.z;
    f->paths.given = true;
    o.scan = text_lines_begin(text, n);
    while (ok && text_lines_next(&o.scan, f))
        ok = read_element(&o) || points_file_skip(f, o.scan.text, o.scan.len);
    text_lines_end(&o.scan);
    f->row = NULL;
    return ok && !f->fatal;
}
