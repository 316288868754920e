/* file_options.c - see file_options.h. */
#include "clients/cli/file_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/request.h"
#include "clients/reading/plan_make.h"
#include "proto/number.h"

/* ---- options ---- */

static int read_change(struct file_options *r, bool negate, char **argv)
{
    struct survey_wish *w = &r->from.wish;
    double nodata;
    size_t *n = negate ? &w->negate_n : &w->nodata_n;
    if (*n == SURVEY_CHANGES)
        return options_wrong(argv[0], "at most %d values of one option", SURVEY_CHANGES);
    if (negate) {
        w->negate[(*n)++] = optarg;
        return EXIT_DONE;
    }
    if (!proto_read_double(optarg, strlen(optarg), &nodata) || !isfinite(nodata))
        return options_wrong(argv[0], "--nodata %s is not a number, or too large", optarg);
    w->nodata[(*n)++] = nodata;
    return EXIT_DONE;
}

static bool read_number(const char *text, uint32_t *number)
{
    return proto_read_u32(text, strlen(text), number) && *number <= PATHS_MOST_NUMBER;
}

int file_options_take(struct file_options *r, const char *option, char **argv, bool *known)
{
    struct source *s = &r->from;
    uint32_t lines;
    *known = true;
    if (options_is(option, "skip-bad"))
        s->skip_bad = true;
    else if (options_is(option, "fields"))
        s->table.fields.all = true;
    else if (options_is(option, "dry-run"))
        r->dry_run = true;
    else if (options_is(option, "format") && !source_read_form(optarg, s))
        return options_wrong(
            argv[0],
            "unknown format %s; there are xy, csv, geojson, node, xyz, gpx, las, poly, obj, asc",
            optarg);
    else if (options_is(option, "columns") && !wish_columns(&s->table.wish, optarg))
        return options_wrong(argv[0], "--columns %s is not X,Y or X,Y,Z: names, or numbers from 1",
                             optarg);
    else if (options_is(option, "skip-lines") && !proto_read_u32(optarg, strlen(optarg), &lines))
        return options_wrong(argv[0], "--skip-lines %s is not a number of lines", optarg);
    else if (options_is(option, "skip-lines"))
        s->table.wish.skip_lines = lines;
    else if (options_is(option, "points"))
        s->points_only = true;
    else if (options_is(option, "border"))
        s->lines_border = true;
    else if (options_is(option, "split"))
        r->split = true;
    else if (options_is(option, "of") && !read_number(optarg, &s->first_number))
        return options_wrong(argv[0], "--of %s is not a number up to %d", optarg,
                             PATHS_MOST_NUMBER);
    else if (options_is(option, "nodata") || options_is(option, "negate"))
        return read_change(r, options_is(option, "negate"), argv);
    else
        *known = options_is(option, "format") || options_is(option, "columns") ||
                 options_is(option, "of");
    return EXIT_DONE;
}

/* ---- JSON ---- */

static void put_number(const char *key, double v)
{
    char text[PROTO_NUMBER_MAX];
    json_key(key);
    if (isfinite(v))
        printf("%.*s", (int)proto_write_double(text, v), text);
    else
        fputs("null", stdout);
}

static void put_range(const struct file_options *r, size_t column)
{
    struct range range = survey_range(&r->file, column);
    put_number("from", range.least);
    put_number("to", range.greatest);
    json_number("missing", range.missing);
}

/* The place of a table's column among x, y and the fields; SIZE_MAX: it is not used. */
static size_t field_of(const struct file_options *r, size_t column)
{
    const struct table_file *t = &r->from.table;
    for (size_t k = 0; k < t->fields.n; k++)
        if (t->fields.column[k] == column && !(t->plan.geometry && column == t->plan.x))
            return k + 2;
    return !t->plan.geometry && column == t->plan.x   ? 0
           : !t->plan.geometry && column == t->plan.y ? 1
                                                      : SIZE_MAX;
}

static const char *name_of(const struct file_options *r, size_t place)
{
    return place == 0 ? "x" : place == 1 ? "y" : r->from.table.fields.name[place - 2];
}

static void put_column(const struct file_options *r, size_t i)
{
    const struct plan *p = &r->from.table.plan;
    size_t place = field_of(r, i);
    printf("%s{\"column\":%zu", i > 0 ? "," : "", i + 1);
    if (p->column[i].heading[0] != '\0')
        json_text("heading", p->column[i].heading);
    if (place == SIZE_MAX)
        json_text("use", p->column[i].role == COLUMN_POINT ? "point" : "none");
    else
        json_text("use", name_of(r, place));
    if (place != SIZE_MAX)
        put_range(r, place);
    putchar('}');
}

static void put_skipped(const struct points_file *f)
{
    json_number("skipped", f->skipped);
    json_key("skipped_lines");
    putchar('[');
    for (size_t i = 0; i < f->skipped && i < SKIPPED_SHOWN; i++) {
        char text[4 * sizeof f->skip[0].text];
        printf("%s{\"line\":%ju", i > 0 ? "," : "", (uintmax_t)f->skip[i].line);
        json_text("fault", f->skip[i].fault);
        json_text("text",
                  report_clean(text, sizeof text, f->skip[i].text, strlen(f->skip[i].text)));
        putchar('}');
    }
    putchar(']');
}

static void put_notes(const struct report *report)
{
    json_key("notes");
    putchar('[');
    for (size_t i = 0; i < report->n; i++) {
        printf("%s{\"kind\":\"%s\"", i > 0 ? "," : "", report_kind(report->note[i].kind));
        json_text("text", report->note[i].text);
        putchar('}');
    }
    putchar(']');
}

void file_options_json(const struct file_options *r)
{
    const struct table_file *t = &r->from.table;
    json_key("input");
    fputs("{\"name\":", stdout);
    const char *name = source_name(&r->from);
    json_string(name, strlen(name));
    json_number("points", r->file.n);
    if (r->file.paths.n > 0) {
        json_number("paths", r->file.paths.n);
        json_number("segments", r->file.paths.segments);
    }
    if (t->using[0] != '\0')
        json_text("using", t->using);
    put_skipped(&r->file);
    if (t->plan.columns > 0) {
        json_number("heading_line", t->plan.heading_line);
        json_key("columns");
        putchar('[');
        for (size_t i = 0; i < t->plan.columns; i++)
            put_column(r, i);
        putchar(']');
    }
    put_notes(&r->file.report);
    putchar('}');
}

/* ---- --dry-run ---- */

static const char *shown(double v, char *room)
{
    if (!isfinite(v))
        return "-";
    room[proto_write_double(room, v)] = '\0';
    return room;
}

static void show_row(const char *column, const char *use, const struct file_options *r,
                     size_t place)
{
    char from[PROTO_NUMBER_MAX + 1], to[PROTO_NUMBER_MAX + 1];
    if (place == SIZE_MAX) {
        printf("  %-24s %s\n", column, use);
        return;
    }
    struct range range = survey_range(&r->file, place);
    printf("  %-24s %-10s %16s %16s %9ju\n", column, use, shown(range.least, from),
           shown(range.greatest, to), (uintmax_t)range.missing);
}

static void show_columns(const struct file_options *r)
{
    const struct plan *p = &r->from.table.plan;
    printf("  %-24s %-10s %16s %16s %9s\n", "column", "use", "from", "to", "missing");
    for (size_t i = 0; i < p->columns; i++) {
        char column[PLAN_NAME + 24];
        size_t place = field_of(r, i);
        snprintf(column, sizeof column, "%zu %s", i + 1, p->column[i].heading);
        show_row(column,
                 place != SIZE_MAX                   ? name_of(r, place)
                 : p->column[i].role == COLUMN_POINT ? "point"
                                                     : "not used",
                 r, place);
    }
    for (size_t k = 0; k < r->file.fields + 2; k++)
        if (p->columns == 0 ||
            (p->geometry && (k < 2 || r->from.table.fields.column[k - 2] == p->x)))
            show_row("", name_of(r, k), r, k);
}

static const char *separator_name(const struct plan *p)
{
    switch (p->row.separator) {
    case ' ':
        return "blanks";
    case '\t':
        return "tabs";
    case ',':
        return "commas";
    case ';':
        return "semicolons";
    default:
        return "bars";
    }
}

static void show_plan(const struct file_options *r)
{
    const struct plan *p = &r->from.table.plan;
    printf("  values between %s%s%s", separator_name(p),
           p->number.commas && p->number.comma == COMMA_DECIMAL ? ", with decimal commas" : "",
           p->number.comma == COMMA_GROUPS ? ", with commas between thousands" : "");
    if (p->heading_line > 0)
        printf("; heading in line %ju", (uintmax_t)p->heading_line);
    else
        fputs("; no heading", stdout);
    if (r->file.n > 0)
        printf("; points from line %ju on\n", (uintmax_t)p->first_line);
    else
        putchar('\n');
}

static void show(const struct file_options *r)
{
    struct coincidence c = {0};
    bool known = survey_coincident(&r->file, &c);
    if (json_chosen()) {
        json_begin(true);
        json_key("dry_run");
        fputs("true", stdout);
        if (known)
            json_number("coincident", c.points);
        file_options_json(r);
        json_finish();
        return;
    }
    printf("%s: points: %zu, lines skipped: %ju", source_name(&r->from), r->file.n,
           (uintmax_t)r->file.skipped);
    if (known)
        printf(", coincident with earlier points: %ju", (uintmax_t)c.points);
    if (r->file.paths.n > 0)
        printf(", paths: %zu of %zu segments", r->file.paths.n, r->file.paths.segments);
    putchar('\n');
    if (r->from.table.plan.columns > 0)
        show_plan(r);
    show_columns(r);
}

/* ---- the file ---- */

/* That is what has been added to the report since the file was read. */
void file_options_note_coincident(struct file_options *r)
{
    struct report *report = &r->file.report;
    size_t before = report->n;
    survey_note_coincident(&r->file, &r->from.table);
    for (size_t i = before; i < report->n; i++)
        fprintf(stderr, "delaunay: %s: %s\n", source_name(&r->from), report->note[i].text);
}

int file_options_read(struct file_options *r, bool *go_on)
{
    *go_on = false;
    if (!source_read(&r->from, &r->file)) {
        if (!json_chosen())
            return EXIT_REFUSED;
        json_begin(false);
        json_text("error", "REFUSED");
        json_text("message", r->from.message);
        file_options_json(r);
        json_finish();
        return EXIT_REFUSED;
    }
    *go_on = !r->dry_run;
    if (r->dry_run) {
        file_options_note_coincident(r);
        show(r);
    }
    return EXIT_DONE;
}

void file_options_free(struct file_options *r)
{
    points_file_free(&r->file);
    source_free(&r->from);
}
