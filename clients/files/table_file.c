/* table_file.c - see table_file.h: the file is read a block at a time; the plan is made from the first block. */
#include "clients/files/table_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lines/wkt_lines.h"
#include "clients/reading/plan_make.h"
#include "clients/reading/wkt.h"
#include "proto/number.h"

enum { BLOCK = 256 * 1024 };

struct reader {
    struct table_file *t;
    struct points_file *f;
    struct value *value; /* owns PLAN_COLUMNS: of the row */
    char *block;         /* owns ROW_LONGEST + BLOCK bytes, `have` of them read */
    size_t have;
    bool all, has_nul;   /* the file ends with the block; the block has NUL bytes */
    size_t usual;        /* a row with this number of values needs no check; SIZE_MAX: none */
    bool plain;          /* numbers are plain ones most often */
    bool in_order;       /* and the columns are x, y and the fields, nothing else */
    char srid[24];       /* of the first geometry that has one; "" */
    uint32_t polygon;    /* the number of the last one */
    bool in_path;        /* rows are corners of a path, which a line > has begun */
    size_t kind, number; /* the columns that our files have beside a geometry; SIZE_MAX: none */
};

static void count(struct rows_seen *rows, uint64_t line)
{
    if (rows->n++ == 0)
        rows->line = line;
}

/* ---- columns ---- */

static bool name_fields(struct table_file *t)
{
    bool all = true;
    for (size_t pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < t->plan.columns; i++) {
            struct column *c = &t->plan.column[i];
            size_t len = strlen(c->heading);
            if (pass == 0 && c->role == COLUMN_HEIGHT)
                table_fields_add_height(&t->fields, i, c->heading, len);
            else if (pass == 0 && c->role == COLUMN_POINT && c->solid > 0 && t->fields.n == 0)
                table_fields_add(&t->fields, i, "z", 1);
            else if (pass == 1 && c->role == COLUMN_FIELD &&
                     !table_fields_add(&t->fields, i, c->heading, len)) {
                c->role = COLUMN_UNUSED;
                all = false;
            }
        }
    return all;
}

/* Notes which columns are used, if that is not obvious. */
static void note_using(struct table_file *t)
{
    const struct plan *p = &t->plan;
    const struct table_fields *e = &t->fields;
    size_t n = 0, room = sizeof t->using - 60;
    if (p->columns == 0 || (p->obvious && e->n == 0))
        return;
    const char *x = p->x < p->columns ? p->column[p->x].heading : "";
    const char *y = p->y < p->columns ? p->column[p->y].heading : "";
    if (p->geometry)
        n = (size_t)snprintf(t->using, room, "x y of %s", p->headed ? x : "points");
    else if (!t->wish.node && p->headed)
        n = (size_t)snprintf(t->using, room, "x=%s y=%s", x, y);
    else if (!t->wish.node)
        n = (size_t)snprintf(t->using, room, "x=%zu y=%zu", p->x + 1, p->y + 1);
    for (size_t i = 0; i < e->n && n + 2 * FIELDS_NAME < room; i++) {
        bool height = strcmp(e->name[i], "z") == 0 && e->height[0] != '\0';
        n += (size_t)snprintf(t->using + n, room - n, "%s%s%s%s", n > 0 ? " " : "", e->name[i],
                              height ? "=" : "", height ? e->height : "");
    }
    if (!p->headed && !t->wish.node && e->n + 2 < p->columns)
        n += (size_t)snprintf(t->using + n, sizeof t->using - n, " of %zu", p->columns);
    if (!p->headed && !t->wish.node)
        snprintf(t->using + n, sizeof t->using - n, ", without a header");
}

static bool is_unused(const struct table_file *t, size_t i)
{
    const struct column *c = &t->plan.column[i];
    bool values = c->numbers + c->degrees + c->points + c->texts > 0 || c->heading[0] != '\0';
    return c->role == COLUMN_UNUSED && values && !(t->wish.node && c->heading[0] == '\0');
}

static void note_unused(struct table_file *t, struct report *report)
{
    const struct plan *p = &t->plan;
    char list[300];
    size_t n = 0, found = 0;
    bool numbers = false;
    list[0] = '\0';
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (!is_unused(t, i))
            continue;
        numbers |= c->numbers > 0 && c->numbers >= c->texts;
        found++;
        if (n + PLAN_NAME + 40 >= sizeof list)
            continue;
        n += (size_t)snprintf(list + n, sizeof list - n, "%s", found > 1 ? ", " : "");
        n += (size_t)(c->heading[0] != '\0' ? snprintf(list + n, sizeof list - n, "%s", c->heading)
                                            : snprintf(list + n, sizeof list - n, "%zu", i + 1));
    }
    if (n + PLAN_NAME + 40 >= sizeof list)
        snprintf(list + n, sizeof list - n, ", ... (%zu in all)", found);
    if (found > 0)
        report_add(report, NOTE_UNUSED, "columns not used: %s%s", list,
                   numbers && !t->fields.all ? " (--fields keeps those of numbers)" : "");
}

/* ---- rows ---- */

static bool fault_length(struct points_file *f, size_t n, const struct plan *p)
{
    bool commas = p->row.separator == ',' && n == 2 * p->columns;
    return points_file_bad(f, "the row has too %s columns: %zu instead of %zu%s",
                           n < p->columns ? "few" : "many", n, p->columns,
                           commas ? " (decimal commas?)" : "");
}

/* The name of a column for messages, in room[PLAN_NAME]. */
static const char *column_name(const struct plan *p, size_t i, char *room)
{
    if (i < p->columns && p->column[i].heading[0] != '\0')
        return p->column[i].heading;
    snprintf(room, PLAN_NAME, "%zu", i + 1);
    return room;
}

static bool fault_value(struct points_file *f, const struct plan *p, size_t column, struct value v,
                        const char *what)
{
    char text[60], name[PLAN_NAME];
    return points_file_bad(f, "%s: \"%s\" in column %s", what,
                           report_clean(text, sizeof text, v.text, v.len),
                           column_name(p, column, name));
}

static bool has_unit(const struct plan *p, size_t column, struct value *v)
{
    struct value unit;
    return column < p->columns && p->column[column].units > 0 && number_split_unit(v, &unit) &&
           value_is_word(unit, p->column[column].unit);
}

static bool read_coordinate(struct reader *r, int axis, size_t column, double *x)
{
    const struct plan *p = &r->t->plan;
    struct value v = r->value[column], number = v;
    if (number_read(&p->number, v, x) || number_read_degrees(&p->number, v, axis, x) ||
        (has_unit(p, column, &number) && number_read(&p->number, number, x)))
        return true;
    bool comma = memchr(v.text, ',', v.len) != NULL && number_shape(v) != SHAPE_NONE;
    return fault_value(r->f, p, column, v,
                       comma ? "not a number without doubt, because of its comma" : "not a number");
}

static void read_fields(struct reader *r, size_t n)
{
    struct table_file *t = r->t;
    const struct plan *p = &t->plan;
    for (size_t k = 0; k < t->fields.n; k++) {
        const size_t column = t->fields.column[k];
        struct value v = column < n ? r->value[column] : (struct value){"", 0}, number = v;
        double x;
        if (p->geometry && column == p->x)
            continue; /* the geometry has it */
        if (number_read(&p->number, v, &x) ||
            (has_unit(p, column, &number) && number_read(&p->number, number, &x)))
            t->row[k] = isfinite(x) ? x : (double)NAN;
        else
            t->row[k] = (double)NAN;
        if (isnan(t->row[k]))
            table_fields_note_odd(&t->fields, k, r->f->line, v.text, v.len);
    }
}

static bool is_empty(const struct reader *r, size_t n)
{
    for (size_t i = 0; i < n && i < PLAN_COLUMNS; i++)
        if (r->value[i].len > 0)
            return false;
    return true;
}

/* Whether the row may have values in other columns than the plan says. */
static bool check_length(const struct reader *r, size_t n)
{
    const struct plan *p = &r->t->plan;
    if (r->t->wish.xy && n > 2)
        return points_file_fault(r->f, "more than x and y; --columns 1,2 takes the first two");
    if (n <= p->x || n <= p->y) {
        double x;
        bool lone =
            n == 1 && p->columns == 2 && !p->headed && number_read(&p->number, r->value[0], &x);
        return lone ? points_file_fault(r->f, "a point needs x and y") : fault_length(r->f, n, p);
    }
    if (p->exact && n < p->columns)
        return fault_length(r->f, n, p);
    if (!p->any_length)
        for (size_t i = p->columns; i < n; i++)
            if (i >= PLAN_COLUMNS || r->value[i].len > 0)
                return p->columns >= PLAN_COLUMNS || fault_length(r->f, n, p);
    if (p->text < n && number_shape(r->value[p->text]) != SHAPE_NONE)
        return fault_value(r->f, p, p->text, r->value[p->text], "the row seems to be shifted");
    return true;
}

/* Whether the point is in the reference system of the first point that names one. */
static bool check_system(struct reader *r, struct value point)
{
    struct value srid = wkt_srid(point);
    if (srid.len == 0 || srid.len >= sizeof r->srid)
        return true;
    if (r->srid[0] == '\0')
        memcpy(r->srid, srid.text, srid.len);
    return (strlen(r->srid) == srid.len && memcmp(r->srid, srid.text, srid.len) == 0) ||
           points_file_bad(r->f, "the point has another reference system (SRID) than %s", r->srid);
}

/* The place of the row that was split. */
static bool read_place(struct reader *r, double *point)
{
    const struct plan *p = &r->t->plan;
    const struct value x = r->value[p->x], y = r->value[p->y];
    if (r->plain && proto_read_double(x.text, x.len, &point[0]) &&
        proto_read_double(y.text, y.len, &point[1]))
        return true;
    return read_coordinate(r, 0, p->x, &point[0]) && read_coordinate(r, 1, p->y, &point[1]);
}

/* Reads the usual row of nothing but plain numbers x, y and fields. False if it is another one. */
static bool read_in_order(struct reader *r, const char *s, const char *end, double *point)
{
    const char separator = r->t->plan.row.separator;
    for (size_t left = r->usual; left > 0; left--) {
        const size_t k = r->usual - left;
        double *to = k < 2 ? &point[k] : &r->t->row[k - 2];
        while (s < end && (*s == ' ' || (separator == ' ' && value_is_blank(*s))))
            s++;
        size_t n = proto_read_leading_double(s, (size_t)(end - s), to);
        s += n;
        if (n == 0 || (k >= 2 && !isfinite(*to)))
            return false;
        if (left == 1)
            break;
        if (s == end || (separator == ' ' ? !value_is_blank(*s) : *s != separator))
            return false;
        s++;
    }
    while (s < end && value_is_blank(*s))
        s++;
    return s == end;
}

static bool append(struct reader *r, const double *point)
{
    return points_file_append(r->f, point[0], point[1]) &&
           (!r->in_path || points_file_corner(r->f));
}

/* A geometry, whose points have the values of its row. */
static bool read_geometry(struct reader *r, size_t n)
{
    const struct plan *p = &r->t->plan;
    const struct table_fields *t = &r->t->fields;
    struct wkt_name name = {.named = false};
    double *z = NULL;
    bool solid;
    if (!check_system(r, r->value[p->x]))
        return false;
    if (r->kind < n && r->number < n) {
        struct value kind = r->value[r->kind], number = r->value[r->number];
        name.border = value_is_word(kind, "border");
        name.named = (name.border || value_is_word(kind, "line")) &&
                     proto_read_u32(number.text, number.len, &name.number) &&
                     name.number <= PATHS_MOST_NUMBER;
    }
    for (size_t k = 0; k < t->n; k++)
        if (t->column[k] == p->x)
            z = &r->t->row[k];
    read_fields(r, n);
    const size_t before = r->f->n;
    if (!wkt_lines_read(r->f, r->value[p->x], &name, z))
        return !wkt_is_geometry(r->value[p->x], &solid) &&
               fault_value(r->f, p, p->x, r->value[p->x], "not a point");
    if (r->f->n == before)
        count(&r->t->nowhere, r->f->line);
    return true;
}

static bool read_values(struct reader *r, const char *s, const char *end)
{
    const struct plan *p = &r->t->plan;
    double point[2];
    if (r->in_order && read_in_order(r, s, end, point))
        return append(r, point);
    size_t n = row_split(&p->row, s, end, r->value, PLAN_COLUMNS);
    if (r->value[0].len == 0 && is_empty(r, n)) {
        count(&r->t->empty, r->f->line);
        return true;
    }
    if (n != r->usual && !check_length(r, n))
        return false;
    if (p->geometry)
        return read_geometry(r, n);
    if (!read_place(r, point))
        return false;
    read_fields(r, n);
    return append(r, point);
}

/* OGR writes `# @P` before the outer ring of a polygon, and `# @H` before its holes. */
static void look_at_mark(struct reader *r, const char *s, const char *end)
{
    struct value mark = value_trim(s, end);
    struct path *path = &r->f->paths.path[r->f->paths.n - 1];
    bool hole = mark.len >= 4 && memcmp(mark.text, "# @H", 4) == 0;
    if (!hole && (mark.len < 4 || memcmp(mark.text, "# @P", 4) != 0))
        return;
    path->border = true;
    if (hole)
        path->number = r->polygon;
    r->polygon = path->number;
}

/* A comment between rows that would be one without its mark. Between separators one coordinate shows it: the x of
 * `#N/A,5,1` is missing. */
static void look_at_comment(struct reader *r, const char *s, const char *end)
{
    const struct plan *p = &r->t->plan;
    double v;
    while (s < end && (value_is_blank(*s) || *s == '#' || *s == '%' || *s == '/'))
        s++;
    if (end - s > 5 && memcmp(s, "name:", 5) == 0) /* of Octave */
        count(&r->t->matrices, r->f->line);
    size_t n = row_split(&p->row, s, end, r->value, PLAN_COLUMNS);
    if (p->columns < 2 || n != p->columns || p->geometry || p->x >= n || p->y >= n)
        return;
    bool x = number_read(&p->number, r->value[p->x], &v);
    bool y = number_read(&p->number, r->value[p->y], &v);
    if ((x && y) || (p->row.separator != ' ' && (x || y)))
        count(&r->t->comments, r->f->line);
}

/* A line > begins a path, and the rows before the first one are a path, too. The rest of the line is a comment, unless it is the name that
 * our files have, `border 7`. */
static bool begin_path(struct reader *r, const char *s, const char *end)
{
    struct value mark = value_trim(s, end), name = value_trim(mark.text + 1, end);
    uint32_t number;
    bool border = false;
    if (!r->in_path && r->f->n > 0) {
        if (!points_file_number(r->f, &number) || !points_file_begin_path(r->f, false, number, 0))
            return false;
        for (size_t i = 0; i < r->f->n; i++)
            if (!paths_corner(&r->f->paths, i))
                return points_file_stop(r->f, "out of memory");
        r->f->paths.path[0].line = r->t->plan.first_line;
        r->in_path = true;
    }
    if (r->in_path)
        points_file_end_path(r->f, false);
    r->in_path = true;
    if (!paths_read_name(name.text, name.len, &border, &number) &&
        !points_file_number(r->f, &number))
        return false;
    return points_file_begin_path(r->f, border, number, 0);
}

static bool read_row(struct reader *r, const char *s, const char *end)
{
    if (r->has_nul && memchr(s, '\0', (size_t)(end - s)) != NULL)
        return points_file_stop(r->f, "not a text file: it has NUL bytes");
    const struct plan *p = &r->t->plan;
    const uint64_t first = p->headed ? p->heading_line + 1 : p->first_line;
    enum row_kind kind = row_kind(s, end);
    if (kind == ROW_SEGMENT)
        return begin_path(r, s, end);
    if (kind == ROW_COMMENT && r->in_path)
        look_at_mark(r, s, end);
    if (kind == ROW_COMMENT && r->f->line >= first)
        look_at_comment(r, s, end);
    return kind != ROW_VALUES || r->f->line < p->first_line || read_values(r, s, end);
}

/* ---- blocks ---- */

static bool read_line(struct reader *r, const char *s, const char *end,
                      const struct row_quotes *quotes)
{
    r->f->line++;
    if (quotes->breaks > 0 && r->t->spanning.n == 0)
        r->t->spanning_end = r->f->line + quotes->breaks;
    if (quotes->breaks > 0)
        count(&r->t->spanning, r->f->line);
    if (quotes->lone)
        count(&r->t->lone_quotes, r->f->line);
    if (!read_row(r, s, end) && !points_file_skip(r->f, s, (size_t)(end - s)))
        return false;
    r->f->line += quotes->breaks;
    return true;
}

/* Reads the whole rows of the block, and the last one if the file ends with it; removes them. */
static bool read_rows(struct reader *r)
{
    const struct row_style *style = &r->t->plan.row;
    const char *s = r->block, *end = r->block + r->have;
    if (r->f->line == 0)
        s += text_mark_length(s, r->have);
    while (s < end) {
        struct row_quotes quotes = {0};
        const char *stop = row_end(style, s, end, r->all, &quotes);
        if (stop == NULL && (!r->all || end - s > ROW_LONGEST))
            break;
        if (!read_line(r, s, stop != NULL ? stop : end, &quotes))
            return false;
        s = stop != NULL ? stop + 1 : end;
    }
    r->have = (size_t)(end - s);
    memmove(r->block, s, r->have);
    if (r->have <= ROW_LONGEST && !(r->all && r->have > 0))
        return true;
    r->f->line++;
    return points_file_stop(r->f, "a line has more than 16 MB");
}

/* Reads more of the file: BLOCK bytes, unless it ends. */
static bool read_block(struct reader *r, int fd)
{
    size_t want = r->have + BLOCK, from = r->have;
    while (r->have < want && !r->all) {
        ssize_t n = read(fd, r->block + r->have, want - r->have);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            r->f->line = 0;
            return points_file_stop(r->f, "%s", strerror(errno));
        }
        r->all = n == 0;
        r->have += (size_t)n;
    }
    r->has_nul = memchr(r->block + from, '\0', r->have - from) != NULL;
    return true;
}

static bool start(struct reader *r)
{
    struct table_file *t = r->t;
    t->wish.all = t->fields.all;
    if (!plan_make(&t->plan, &t->wish, r->block, r->have, r->all, &r->f->report)) {
        r->f->line = t->plan.fault_line;
        return points_file_stop(r->f, "%s", t->plan.fault);
    }
    if (!name_fields(t))
        report_add(&r->f->report, NOTE_UNUSED, "only the first %d columns become fields",
                   FIELDS_MOST);
    note_using(t);
    note_unused(t, &r->f->report);
    const struct plan *p = &t->plan;
    bool check = p->text != SIZE_MAX || p->x >= p->columns || p->y >= p->columns ||
                 (t->wish.xy && p->columns > 2);
    r->usual = check ? SIZE_MAX : p->columns;
    r->kind = r->number = SIZE_MAX;
    for (size_t i = 0; i < p->columns; i++)
        if (strcmp(p->column[i].heading, "kind") == 0)
            r->kind = i;
        else if (strcmp(p->column[i].heading, "number") == 0)
            r->number = i;
    r->plain = p->number.comma != COMMA_DECIMAL && !p->number.point_groups;
    r->in_order = r->plain && !check && !p->geometry && p->x == 0 && p->y == 1 &&
                  t->fields.n + 2 == p->columns;
    r->f->fields = t->fields.n;
    r->f->row = t->row;
    return true;
}

/* Whether there are at least three lines, from which a plan can be made. */
static bool has_lines(const struct reader *r)
{
    const char *p = r->block, *end = p + r->have;
    for (int i = 0; i < 3; i++, p++) {
        const char *lf = memchr(p, '\n', (size_t)(end - p));
        p = lf != NULL ? lf : memchr(p, '\r', (size_t)(end - p));
        if (p == NULL)
            return false;
    }
    return true;
}

static bool read_first(struct reader *r, int fd)
{
    do {
        if (!read_block(r, fd))
            return false;
    } while (!r->all && r->have < ROW_LONGEST && !has_lines(r));
    return start(r);
}

static bool read_all(struct reader *r, int fd, table_progress_fn *progress, void *ctx)
{
    uint64_t total = 0;
    if (!read_first(r, fd))
        return false;
    for (bool first = true; first || !r->all; first = false) {
        if (!first && !read_block(r, fd))
            return false;
        if (!read_rows(r))
            return false;
        total += BLOCK;
        if (progress != NULL)
            progress(ctx, total, r->f->n);
    }
    if (r->in_path)
        points_file_end_path(r->f, false);
    return true;
}

/* ---- what was seen ---- */

static void note(struct report *report, const struct rows_seen *rows, const char *one,
                 const char *many)
{
    if (rows->n == 1)
        report_add(report, NOTE_SKIPPED, "line %ju %s", (uintmax_t)rows->line, one);
    else if (rows->n > 1)
        report_add(report, NOTE_SKIPPED, "%ju lines %s, the first is line %ju", (uintmax_t)rows->n,
                   many, (uintmax_t)rows->line);
}

static void note_rows(const struct table_file *t, struct report *report)
{
    note(report, &t->empty, "has only empty values", "have only empty values");
    note(report, &t->nowhere, "has an empty geometry", "have an empty geometry");
    if (t->matrices.n > 0)
        report_add(report, NOTE_DOUBT,
                   "another matrix begins in line %ju; the rows of %ju matrices become one set",
                   (uintmax_t)t->matrices.line, (uintmax_t)t->matrices.n + 1);
    note(report, &t->comments, "looks like a row but is a comment, and is not read",
         "look like rows but are comments, and are not read");
    if (t->spanning.n > 0)
        report_add(report, NOTE_SPANNING, "%ju quoted value%s %s lines, %s lines %ju to %ju",
                   (uintmax_t)t->spanning.n, t->spanning.n > 1 ? "s" : "",
                   t->spanning.n > 1 ? "span" : "spans", t->spanning.n > 1 ? "the first" : "from",
                   (uintmax_t)t->spanning.line, (uintmax_t)t->spanning_end);
    if (t->lone_quotes.n > 0)
        report_add(report, NOTE_DOUBT,
                   "in %ju line%s a quote is not closed and taken as it is, %s line %ju",
                   (uintmax_t)t->lone_quotes.n, t->lone_quotes.n > 1 ? "s" : "",
                   t->lone_quotes.n > 1 ? "first in" : "in", (uintmax_t)t->lone_quotes.line);
}

bool table_file_read(struct table_file *t, struct points_file *f, int fd,
                     table_progress_fn *progress, void *ctx)
{
    struct reader r = {.t = t, .f = f, .block = malloc(ROW_LONGEST + BLOCK)};
    r.value = calloc(PLAN_COLUMNS, sizeof r.value[0]);
    bool ok = r.block != NULL && r.value != NULL;
    ok = ok ? read_all(&r, fd, progress, ctx) : points_file_stop(f, "out of memory");
    note_rows(t, &f->report);
    free(r.block);
    free(r.value);
    return ok;
}

void table_file_free(struct table_file *t)
{
    plan_clear(&t->plan);
}
