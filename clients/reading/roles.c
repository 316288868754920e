/* roles.c - see roles.h. */
#include "clients/reading/roles.h"

#include <stdarg.h>
#include <string.h>
#include <strings.h>

bool plan_fault(struct plan *p, bool list, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    size_t n = (size_t)vsnprintf(p->fault, sizeof p->fault, format, values);
    va_end(values);
    if (!list || n + 300 > sizeof p->fault)
        return false;
    n += (size_t)snprintf(p->fault + n, sizeof p->fault - n, "; columns found:");
    for (size_t i = 0; i < p->columns; i++) {
        const char *name = p->column[i].heading;
        if (n + 200 > sizeof p->fault) {
            n += (size_t)snprintf(p->fault + n, sizeof p->fault - n, " ...");
            break;
        }
        n += (size_t)snprintf(p->fault + n, sizeof p->fault - n, " %zu=%.40s", i + 1, name);
    }
    snprintf(p->fault + n, sizeof p->fault - n, "; choose with --columns X,Y, names or numbers");
    return false;
}

static bool has_numbers(const struct column *c)
{
    return c->numbers + c->degrees > 0 && c->numbers + c->degrees >= c->texts;
}

static void take(struct plan *p, size_t x, size_t y)
{
    p->x = x;
    p->y = y;
    if (x < p->columns)
        p->column[x].role = COLUMN_X;
    if (y < p->columns)
        p->column[y].role = COLUMN_Y;
}

/* ---- chosen by the caller ---- */

static bool find_named(struct plan *p, const struct wish *w, int which, size_t *column)
{
    const char *name = w->name[which];
    *column = w->column[which];
    if (name[0] == '\0') /* an empty file has no columns */
        return p->columns == 0 || *column < p->columns ||
               plan_fault(p, true, "there is no column %zu", *column + 1);
    for (size_t i = 0; i < p->columns; i++) {
        const char *heading = p->column[i].heading;
        if (value_is_word((struct value){heading, strlen(heading)}, name)) {
            *column = i;
            return true;
        }
    }
    return plan_fault(p, true, "no column is named %s", name);
}

static bool take_chosen(struct plan *p, const struct wish *w)
{
    size_t column[3];
    for (int i = 0; i < (w->has_z ? 3 : 2); i++) {
        if (!find_named(p, w, i, &column[i]))
            return false;
        if (column[i] >= PLAN_COLUMNS)
            return plan_fault(p, false, "columns after number %d cannot be chosen", PLAN_COLUMNS);
    }
    take(p, column[0], column[1]);
    p->geometry = column[0] == column[1];
    if (p->geometry && column[0] < p->columns)
        p->column[column[0]].role = COLUMN_POINT;
    if (w->has_z && column[2] < p->columns && p->column[column[2]].role == COLUMN_UNUSED)
        p->column[column[2]].role = COLUMN_HEIGHT;
    p->obvious = true;
    return true;
}

/* ---- chosen by headings ---- */

static bool search_headings(const struct plan *p, bool all, size_t column[2], bool *obvious)
{
    struct heading_search search = {0};
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (all || has_numbers(c))
            heading_search_add(&search, i, c->heading, strlen(c->heading));
    }
    return heading_search_end(&search, column, obvious);
}

/* Other columns that could be x and y are a doubt. */
static void note_others(const struct plan *p, struct report *report)
{
    char list[200];
    size_t n = 0, found = 0;
    list[0] = '\0';
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        bool other = i != p->x && i != p->y && has_numbers(c) &&
                     heading_read(c->heading, strlen(c->heading)).axis != AXIS_NONE;
        if (other && n + PLAN_NAME + 10 < sizeof list)
            n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", found > 0 ? " and " : "",
                                  c->heading);
        found += other;
    }
    if (found > 1)
        report_add(report, NOTE_DOUBT, "x and y are %s and %s, not %s; --columns chooses others",
                   p->column[p->x].heading, p->column[p->y].heading, list);
}

static bool take_headed(struct plan *p, struct report *report)
{
    size_t column[2];
    bool obvious;
    if (!search_headings(p, false, column, &obvious) && !search_headings(p, true, column, &obvious))
        return false;
    take(p, column[0], column[1]);
    p->obvious = obvious && !p->comment;
    for (int i = 0; i < 2; i++) {
        const char *name = p->column[column[i]].heading;
        struct heading h = heading_read(name, strlen(name));
        p->pair = h.pair;
        p->reversed[i] = h.reversed;
    }
    note_others(p, report);
    return true;
}

/* Degrees, minutes and seconds in columns of their own make no coordinate. */
static bool check_parts(struct plan *p)
{
    for (int i = 0; i < 2; i++) {
        const char *name = p->column[i == 0 ? p->x : p->y].heading;
        enum axis axis, other;
        char part = heading_part(name, strlen(name), &axis);
        for (size_t k = 0; part != 0 && k < p->columns; k++) {
            const char *heading = p->column[k].heading;
            char second = heading_part(heading, strlen(heading), &other);
            if (second != 0 && second != part && other == axis)
                return plan_fault(p, false,
                                  "%s and %s have degrees and parts of them, which are not put "
                                  "together; one column of them, as 53:20:30, is read",
                                  name, heading);
        }
    }
    return true;
}

/* Whether all values of a column are N, S, E or W; *reversed: some are S or W. */
static bool has_hemispheres(struct sample *s, const struct plan *p, size_t column, bool *reversed)
{
    size_t found = 0;
    *reversed = false;
    for (size_t i = s->first; i < s->n; i++) {
        if (s->row[i].kind != ROW_VALUES || sample_split(s, &p->row, i) <= column)
            continue;
        struct value v = s->value[column];
        if (v.len > 1 || (v.len == 1 && strchr("NSEWnsew", v.text[0]) == NULL))
            return false;
        found += v.len;
        *reversed |= v.len == 1 && strchr("SWsw", v.text[0]) != NULL;
    }
    return found > 0;
}

static void note_hemispheres(const struct plan *p, struct sample *s, struct report *report)
{
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        const size_t axis = strchr("NSns", c->text[0]) != NULL ? p->y : p->x;
        bool reversed;
        if (c->role == COLUMN_UNUSED && c->texts > 0 && strchr("NSEWnsew", c->text[0]) != NULL &&
            has_hemispheres(s, p, i, &reversed) && reversed && p->column[axis].least >= 0)
            report_add(report, NOTE_DOUBT,
                       "%s has S or W, which changes no sign: points there are on the wrong side; "
                       "values as 33.1S are read",
                       c->heading);
    }
}

static bool take_points(struct plan *p)
{
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (c->points == 0 || c->points < c->texts)
            continue;
        p->column[i].role = COLUMN_POINT;
        p->x = p->y = i;
        p->geometry = true;
        p->obvious = false;
        return true;
    }
    return false;
}

/* ---- without headings ---- */

static bool are_dates(const struct column *c)
{
    return c->least >= 19000101 && c->greatest <= 21001231 && c->decimals == 0;
}

static bool are_years_and_months(const struct column *c)
{
    return c[0].least >= 1900 && c[0].greatest <= 2100 && c[1].least >= 1 && c[1].greatest <= 12 &&
           c[2].least >= 1 && c[2].greatest <= 31 && c[0].decimals + c[1].decimals == 0;
}

/* Without a heading: a first column that numbers the points is not a coordinate. */
static bool check_first_column(struct plan *p, struct report *report)
{
    const struct column *c = p->column;
    size_t decimals = 0;
    for (size_t i = 1; i < p->columns; i++)
        decimals += c[i].decimals > 0;
    if (are_dates(c) || (p->columns > 3 && are_years_and_months(c)))
        return plan_fault(p, true, "no header, and the first column has dates");
    bool whole = c->decimals == 0 && c->numbers > 1 && c->least >= 0;
    if (!whole || (!c->ascending && decimals < 2))
        return true;
    if (c->counting && c->numbers > 2 && c->least <= 1)
        return plan_fault(p, false,
                          "no header, and the first column counts rows; choose with --columns, for "
                          "instance 2,3");
    if (c->ascending && c->numbers > 2 && (c->counting || (decimals > 1 && !c->even)))
        return plan_fault(p, false,
                          "no header, and the first column seems to number the points; choose with "
                          "--columns, for instance 2,3");
    report_add(report, NOTE_DOUBT,
               "the first column has only whole numbers; if it numbers the points or has years, "
               "choose with --columns, for instance 2,3");
    return true;
}

/* 12,5,48,1 may be two numbers with decimal commas. */
static bool check_commas(struct plan *p, struct sample *s, struct report *report)
{
    bool zeros = false;
    if (p->row.separator != ',' || p->columns < 4 || p->columns % 2 != 0)
        return true;
    for (size_t i = 0; i < p->columns; i++)
        if (p->column[i].decimals + p->column[i].texts + p->column[i].missing > 0)
            return true;
    for (size_t i = s->first; i < s->n; i++) {
        size_t n = s->row[i].kind == ROW_VALUES ? sample_split(s, &p->row, i) : 0;
        for (size_t k = 1; k < n; k += 2)
            zeros |= s->value[k].len > 1 && s->value[k].text[0] == '0';
        for (size_t k = 1; k < n; k += 2)
            if (s->value[k].len > 0 && s->value[k].text[0] == '-')
                return true;
    }
    if (zeros)
        return plan_fault(p, true,
                          "no header, and the commas seem to be decimal commas, too; other "
                          "separators are needed");
    report_add(report, NOTE_DOUBT,
               "no value has decimals; if commas are decimal commas, other "
               "separators are needed");
    return true;
}

/* The values of the first row in the place of headings, for faults that list columns; or none. */
static void borrow_headings(struct plan *p, struct sample *s, bool borrow)
{
    size_t n = borrow && s->n > 0 ? sample_split(s, &p->row, s->first < s->n ? s->first : 0) : 0;
    for (size_t i = 0; i < p->columns && !p->headed; i++) {
        struct value v = i < n ? s->value[i] : (struct value){"", 0};
        report_clean(p->column[i].heading, PLAN_NAME, v.text, v.len);
    }
}

/* 12:30:05 is a time unless the next column has degrees, too. */
static bool is_time(const struct column *c)
{
    return c->degrees > 0 && c->numbers == 0 && strchr(c->text, ':') != NULL;
}

static bool take_unheaded(struct plan *p, const struct wish *w, struct sample *s,
                          struct report *report)
{
    if (p->columns < 2)
        return plan_fault(p, false,
                          has_numbers(&p->column[0]) ? "a point needs x and y" : "not a number");
    if (!has_numbers(&p->column[0]) || !has_numbers(&p->column[1]))
        return plan_fault(p, true, "no header, and the first two columns are not numbers");
    if (is_time(&p->column[0]) && p->column[1].degrees == 0)
        return plan_fault(p, true, "no header, and the first column seems to have times");
    take(p, 0, 1);
    p->obvious = p->columns == 2 || w->xyz;
    if (p->columns > 2 && !w->xyz && !check_first_column(p, report))
        return false;
    if (!w->xyz && !check_commas(p, s, report))
        return false;
    if ((p->columns == 3 || (w->xyz && p->columns > 3)) &&
        p->column[2].texts <= p->column[2].numbers)
        p->column[2].role = COLUMN_HEIGHT;
    return true;
}

/* ---- fields ---- */

static bool may_be_field(const struct column *c)
{
    return c->numbers >= c->texts + c->degrees + c->points;
}

/* A column z precedes others, such as h. */
static void take_height(struct plan *p)
{
    bool z = false;
    for (size_t i = 0; i < p->columns; i++)
        z |= strcasecmp(p->column[i].heading, "z") == 0 && may_be_field(&p->column[i]);
    for (size_t i = 0; i < p->columns; i++) {
        struct column *c = &p->column[i];
        size_t len = strlen(c->heading);
        if (c->role != COLUMN_UNUSED || !heading_is_height(c->heading, len) || !may_be_field(c) ||
            (z && strcasecmp(c->heading, "z") != 0))
            continue;
        c->role = COLUMN_HEIGHT;
        p->depth = heading_is_depth(c->heading, len);
        return;
    }
}

static void take_fields(struct plan *p)
{
    for (size_t i = 0; i < p->columns; i++)
        if (p->column[i].role == COLUMN_UNUSED && may_be_field(&p->column[i]))
            p->column[i].role = COLUMN_FIELD;
}

/* ---- reports ---- */

static void note_height_of_text(const struct plan *p, struct report *report)
{
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (p->headed && c->role == COLUMN_UNUSED && c->texts > c->numbers &&
            heading_is_height(c->heading, strlen(c->heading)))
            report_add(report, NOTE_DOUBT, "%s has %s numbers; the first %s \"%s\" in line %ju",
                       c->heading, c->numbers > 0 ? "few" : "no",
                       c->numbers > 0 ? "other value is" : "value is", c->text,
                       (uintmax_t)c->text_line);
    }
}

static void note_units(const struct plan *p, struct report *report)
{
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (c->role != COLUMN_UNUSED && c->units > 0)
            report_add(report, NOTE_READ, "the unit %s of %s is left out", c->unit,
                       c->heading[0] != '\0' ? c->heading : "the values");
        if ((c->role == COLUMN_X || c->role == COLUMN_Y) && c->degrees > 0)
            report_add(report, NOTE_READ, "%s is read in degrees, as \"%s\" in line %ju",
                       c->heading[0] != '\0' ? c->heading
                       : c->role == COLUMN_X ? "x"
                                             : "y",
                       c->text, (uintmax_t)c->text_line);
    }
}

static bool is_text(const struct column *c)
{
    return c->texts > c->numbers;
}

/* Whether rows of another length may have values in other columns, and which column of text shows that, too. */
static void decide_lengths(struct plan *p, const struct wish *w)
{
    const bool blanks = p->row.separator == ' ';
    size_t last = 0, first_text = p->columns, last_text = p->columns;
    for (size_t i = 0; i < p->columns; i++) {
        const struct column *c = &p->column[i];
        if (c->role != COLUMN_UNUSED)
            last = i;
        if (!is_text(c))
            continue;
        if (first_text == p->columns)
            first_text = i;
        last_text = i;
    }
    if (p->x >= p->columns || p->y >= p->columns)
        last = p->columns;
    bool text_before = first_text <= last && first_text < p->columns;
    bool text_at_end = first_text + 1 == p->columns;
    p->exact = blanks && !w->xy && (p->headed || text_before);
    p->any_length = !w->xy && !(blanks && text_before) &&
                    (w->xyz || (p->headed ? blanks && text_at_end : w->chosen));
    if (blanks && text_before && last_text > last && last_text < p->columns &&
        10 * p->column[last_text].numbers <= p->column[last_text].texts + 10)
        p->text = last_text;
}

static bool choose(struct plan *p, const struct wish *w, struct sample *s, struct report *report)
{
    if (w->chosen)
        return take_chosen(p, w);
    if (p->headed && take_headed(p, report)) {
        if (p->pair == PAIR_LON_LAT)
            note_hemispheres(p, s, report);
        return check_parts(p);
    }
    if (take_points(p))
        return true;
    if (p->headed)
        return plan_fault(p, true, "no headings that are known for x and y");
    if (s->first == s->n)
        return plan_fault(p, p->columns > 1, p->columns > 1 ? "no numbers" : "not a number");
    return take_unheaded(p, w, s, report);
}

bool roles_choose(struct plan *p, const struct wish *w, struct sample *s, struct report *report)
{
    p->text = SIZE_MAX;
    borrow_headings(p, s, true);
    if (!choose(p, w, s, report))
        return false;
    borrow_headings(p, s, false);
    if (p->headed && !w->chosen)
        take_height(p);
    if (w->all)
        take_fields(p);
    note_height_of_text(p, report);
    note_units(p, report);
    decide_lengths(p, w);
    return true;
}
