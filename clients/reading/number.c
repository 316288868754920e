/* number.c - see number.h. A number is first cut into its sign, its digits with the marks among them, and its exponent. */
#include "clients/reading/number.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "proto/number.h"
#include "proto/text.h"

enum { ROOM = 64 };

#define GROUP_MARK 'g' /* a blank or an apostrophe */

struct cut {
    char mantissa[ROOM]; /* digits, ',', '.' and GROUP_MARK */
    size_t n;
    bool negative;
    struct value exponent; /* without its letter; len 0: none */
    size_t commas, points, groups;
};

static bool begins(struct value v, const char *what)
{
    size_t n = strlen(what);
    return v.len >= n && memcmp(v.text, what, n) == 0;
}

static void skip(struct value *v, size_t n)
{
    v->text += n;
    v->len -= n;
}

/* The length of a sign at the front: '+', '-' or U+2212. */
static size_t sign_length(struct value v, bool *negative)
{
    *negative = begins(v, "-") || begins(v, "\xE2\x88\x92");
    return begins(v, "\xE2\x88\x92") ? 3 : begins(v, "-") || begins(v, "+");
}

/* The length of a mark between groups of digits: blanks of all kinds, apostrophes. */
static size_t group_mark_length(struct value v)
{
    static const char *const marks[] = {
        " ", "'", "\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89", "\xE2\x80\x99", "\xA0"};
    for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++)
        if (begins(v, marks[i]))
            return strlen(marks[i]);
    return 0;
}

/* An exponent at the front: e or E; d or D if the mantissa has a point. */
static bool is_exponent(const struct cut *c, struct value v)
{
    char letter = (char)tolower((unsigned char)v.text[0]);
    return letter == 'e' || (letter == 'd' && c->points + c->commas > 0);
}

static bool cut(struct value v, struct cut *c)
{
    *c = (struct cut){.n = 0};
    skip(&v, sign_length(v, &c->negative));
    while (v.len > 0 && c->n < ROOM) {
        size_t mark = group_mark_length(v);
        char letter = mark > 0 ? GROUP_MARK : v.text[0];
        if (is_exponent(c, v))
            break;
        if (!text_is_digit(letter) && letter != ',' && letter != '.' && letter != GROUP_MARK)
            return false;
        c->commas += letter == ',';
        c->points += letter == '.';
        c->groups += letter == GROUP_MARK;
        c->mantissa[c->n++] = letter;
        skip(&v, mark > 0 ? mark : 1);
    }
    if (v.len > 0 && c->n == ROOM)
        return false;
    if (v.len > 0) {
        skip(&v, 1);
        c->exponent = v;
        if (v.len == 0)
            return false;
    }
    return c->n > 0;
}

/* Whether the mark splits digits into groups of three, after one to three that do not begin with 0, up to the decimal mark. */
static bool has_groups(const struct cut *c, char mark, char decimal)
{
    size_t run = 0, marks = 0, i = 0;
    if (c->mantissa[0] == '0')
        return false;
    for (; i < c->n && c->mantissa[i] != decimal; i++) {
        if (c->mantissa[i] != mark) {
            run += text_is_digit(c->mantissa[i]);
            continue;
        }
        if (marks == 0 ? run < 1 || run > 3 : run != 3)
            return false;
        marks++;
        run = 0;
    }
    if (run != 3)
        return false;
    for (; i < c->n; i++)
        if (c->mantissa[i] == mark)
            return false;
    return true;
}

static enum number_shape shape_of(const struct cut *c)
{
    const char *comma = memchr(c->mantissa, ',', c->n), *point = memchr(c->mantissa, '.', c->n);
    if (c->groups > 0) {
        char decimal = c->commas > 0 ? ',' : '.';
        if (c->commas + c->points > 1 || !has_groups(c, GROUP_MARK, decimal))
            return SHAPE_NONE;
        return c->commas > 0 ? SHAPE_COMMA : c->points > 0 ? SHAPE_POINT : SHAPE_INTEGER;
    }
    if (c->commas > 0 && c->points > 0) {
        bool last_is_point = point > comma;
        if (last_is_point)
            return c->points == 1 && has_groups(c, ',', '.') ? SHAPE_COMMA_GROUPS : SHAPE_NONE;
        return c->commas == 1 && has_groups(c, '.', ',') ? SHAPE_POINT_GROUPS : SHAPE_NONE;
    }
    if (c->n == c->commas + c->points)
        return SHAPE_NONE;
    bool plain = c->exponent.len == 0;
    if (c->commas > 1 || c->points > 1)
        return !has_groups(c, c->commas > 0 ? ',' : '.', 0) ? SHAPE_NONE
               : c->commas > 0                              ? SHAPE_COMMA_GROUPS
                                                            : SHAPE_POINT_GROUPS;
    if (c->commas == 1)
        return plain && has_groups(c, ',', 0) ? SHAPE_COMMA_EITHER : SHAPE_COMMA;
    if (c->points == 1)
        return plain && has_groups(c, '.', 0) ? SHAPE_POINT_EITHER : SHAPE_POINT;
    return SHAPE_INTEGER;
}

/* The mark before the decimals; 0 if there are none. False if the style does not decide. */
static bool decimal_of(const struct number_style *style, const struct cut *c, char *decimal)
{
    *decimal = 0;
    switch (shape_of(c)) {
    case SHAPE_NONE:
    case SHAPE_COUNT:
        return false;
    case SHAPE_INTEGER:
        return true;
    case SHAPE_POINT:
        *decimal = '.';
        return true;
    case SHAPE_POINT_EITHER:
        *decimal = style->point_groups ? 0 : '.';
        return true;
    case SHAPE_POINT_GROUPS:
        *decimal = ',';
        return true;
    case SHAPE_COMMA_GROUPS:
        *decimal = '.';
        return true;
    case SHAPE_COMMA:
        *decimal = ',';
        return c->groups > 0 || style->comma == COMMA_DECIMAL;
    case SHAPE_COMMA_EITHER:
        *decimal = style->comma == COMMA_DECIMAL ? ',' : 0;
        return style->comma != COMMA_UNKNOWN;
    }
    return false;
}

enum number_shape number_shape(struct value v)
{
    static const struct number_style any = {.comma = COMMA_DECIMAL};
    struct cut c;
    double x;
    return cut(v, &c) && number_read(&any, v, &x) ? shape_of(&c) : SHAPE_NONE;
}

static bool read_cut(const struct number_style *style, const struct cut *c, double *x)
{
    char text[2 * ROOM + 4], decimal;
    size_t n = 0;
    if (!decimal_of(style, c, &decimal) || c->exponent.len >= ROOM)
        return false;
    if (c->negative)
        text[n++] = '-';
    for (size_t i = 0; i < c->n; i++)
        if (text_is_digit(c->mantissa[i]))
            text[n++] = c->mantissa[i];
        else if (c->mantissa[i] == decimal)
            text[n++] = '.';
    if (c->exponent.len > 0) {
        text[n++] = 'e';
        memcpy(text + n, c->exponent.text, c->exponent.len);
        n += c->exponent.len;
    }
    return proto_read_double(text, n, x);
}

/* The usual number with a decimal comma: without groups. */
static bool read_comma(struct value v, double *x)
{
    char text[ROOM];
    const char *comma = v.len < ROOM ? memchr(v.text, ',', v.len) : NULL;
    if (comma == NULL)
        return false;
    memcpy(text, v.text, v.len);
    text[comma - v.text] = '.';
    return proto_read_double(text, v.len, x);
}

static bool read_any(const struct number_style *style, struct value v, double *x)
{
    struct cut c;
    return cut(v, &c) && read_cut(style, &c, x);
}

bool number_read(const struct number_style *style, struct value v, double *x)
{
    if (style->comma == COMMA_DECIMAL && read_comma(v, x))
        return true;
    return (!style->point_groups && proto_read_double(v.text, v.len, x)) || read_any(style, v, x);
}

/* ---- degrees ---- */

/* Removes a letter of a hemisphere from one end. */
static bool split_letter(struct value *v, char *letter)
{
    if (v->len < 2)
        return false;
    char first = (char)toupper((unsigned char)v->text[0]);
    char last = (char)toupper((unsigned char)v->text[v->len - 1]);
    bool at_end = strchr("NSEW", last) != NULL;
    if (!at_end && strchr("NSEW", first) == NULL)
        return false;
    *letter = at_end ? last : first;
    *v = at_end ? value_trim(v->text, v->text + v->len - 1)
                : value_trim(v->text + 1, v->text + v->len);
    return true;
}

/* The length of the marks after degrees, minutes or seconds, blanks included. *sign: one of them says that these are
 * degrees. */
static size_t degree_mark_length(struct value v, bool *sign)
{
    static const struct {
        const char *text;
        bool sign;
    } marks[] = {{" ", false},
                 {"'", false},
                 {"\"", false},
                 {"\xC2\xB0", true},
                 {"\xC2\xBA", true},
                 {"\xB0", true},
                 {":", true},
                 {"\xE2\x80\xB2", false},
                 {"\xE2\x80\xB3", false},
                 {"\xE2\x80\x99", false},
                 {"\xE2\x80\x9D", false}};
    struct value rest = v;
    for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++)
        if (begins(rest, marks[i].text)) {
            skip(&rest, strlen(marks[i].text));
            *sign |= marks[i].sign;
            i = (size_t)-1;
        }
    return v.len - rest.len;
}

bool number_read_degrees(const struct number_style *style, struct value v, int axis, double *x)
{
    char letter = 0;
    bool negative, sign = split_letter(&v, &letter);
    double part[3] = {0, 0, 0};
    int parts = 0;
    skip(&v, sign_length(v, &negative));
    while (v.len > 0 && parts < 3) {
        size_t n = 0;
        while (n < v.len && (text_is_digit(v.text[n]) || v.text[n] == '.' || v.text[n] == ','))
            n++;
        if (n == 0 || (parts > 0 && part[parts - 1] != (double)(long)part[parts - 1]) ||
            !number_read(style, (struct value){v.text, n}, &part[parts]) || part[parts] > 360 ||
            (parts > 0 && part[parts] >= 60))
            return false;
        parts++;
        skip(&v, n);
        n = degree_mark_length(v, &sign);
        if (n == 0 && v.len > 0)
            return false;
        skip(&v, n);
    }
    if (parts == 0 || v.len > 0 || !sign || (letter != 0 && negative) ||
        (letter != 0 && strchr(axis == 0 ? "EW" : "NS", letter) == NULL))
        return false;
    *x = part[0] + part[1] / 60 + part[2] / 3600;
    if (negative || letter == 'S' || letter == 'W')
        *x = -*x;
    return true;
}

/* ---- units, and what is missing ---- */

bool number_split_unit(struct value *v, struct value *unit)
{
    static const char *const units[] = {"m",        "km",       "cm",     "mm",    "ft",
                                        "feet",     "meter",    "meters", "metre", "metres",
                                        "deg",      "degrees",  "masl",   "m asl", "m.",
                                        "m a.s.l.", "\xC2\xB0", "\xB0",   "m NHN", "m AMSL"};
    size_t n = v->len;
    while (n > 0 && !text_is_digit(v->text[n - 1]))
        n--;
    *unit = value_trim(v->text + n, v->text + v->len);
    for (size_t i = 0; n > 0 && i < sizeof units / sizeof units[0]; i++)
        if (value_is_word(*unit, units[i])) {
            v->len = n;
            return true;
        }
    return false;
}

bool number_is_missing(struct value v)
{
    static const char *const words[] = {"",     "-",       "--",      "na",      "n/a",  "nan",
                                        "null", "none",    "?",       "nil",     "#n/a", "\\n",
                                        ".",    "nodata",  "no data", "no_data", "-nan", "missing",
                                        "#na",  "#value!", "<na>",    "n.a.",    "k.a."};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (value_is_word(v, words[i]))
            return true;
    for (size_t i = 0; i < v.len; i++)
        if (v.text[i] != '*')
            return false;
    return true;
}
