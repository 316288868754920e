/* row.c - see row.h. */
#include "clients/reading/row.h"

#include <string.h>
#include <strings.h>

struct value value_trim(const char *s, const char *end)
{
    while (s < end && value_is_blank(*s))
        s++;
    while (end > s && value_is_blank(end[-1]))
        end--;
    return (struct value){s, (size_t)(end - s)};
}

bool value_is_word(struct value v, const char *word)
{
    return v.len == strlen(word) && strncasecmp(v.text, word, v.len) == 0;
}

enum row_kind row_kind(const char *s, const char *end)
{
    if (s<end && * s> '/' && *s < '>') /* most often a digit */
        return ROW_VALUES;
    while (s < end && value_is_blank(*s))
        s++;
    if (s == end)
        return ROW_BLANK;
    if (*s == '#' || *s == '%' || (*s == '/' && end - s > 1 && s[1] == '/'))
        return ROW_COMMENT;
    return *s == '>' ? ROW_SEGMENT : ROW_VALUES;
}

/* ---- values ---- */

static bool separates(char separator, char c)
{
    return separator == ' ' ? value_is_blank(c) : c == separator;
}

/* The closing quote of the value whose opening one is at s; NULL if no quote closes it as it should. */
static const char *closing_quote(const struct row_style *style, const char *s, const char *end)
{
    const char *p = s + 1;
    while ((p = memchr(p, '"', (size_t)(end - p))) != NULL) {
        if (p + 1 < end && p[1] == '"') {
            p += 2;
            continue;
        }
        const char *after = p + 1;
        while (after < end && value_is_blank(*after) && !separates(style->separator, *after))
            after++;
        bool closes =
            after == end || separates(style->separator, *after) || *after == style->line_end;
        return closes ? p : NULL;
    }
    return NULL;
}

/* The end of the value at s, which is not quoted. */
static inline const char *value_end(char separator, const char *s, const char *end)
{
    if (separator == ' ')
        while (s < end && ((unsigned char)*s > ' ' || !value_is_blank(*s)))
            s++;
    else
        while (s < end && *s != separator)
            s++;
    return s;
}

size_t row_split(const struct row_style *style, const char *s, const char *end, struct value *value,
                 size_t room)
{
    const char separator = style->separator;
    for (size_t n = 0;; s++) {
        while (s < end && (unsigned char)*s <= ' ' && value_is_blank(*s) &&
               (separator == ' ' || *s != separator))
            s++;
        if (separator == ' ' && s >= end)
            return n;
        const char *close = s < end && *s == '"' ? closing_quote(style, s, end) : NULL;
        const char *p = value_end(separator, close != NULL ? close + 1 : s, end);
        if (n < room) {
            const char *stop = close != NULL ? close : p;
            s += close != NULL;
            while (close == NULL && stop > s && value_is_blank(stop[-1]))
                stop--;
            value[n] = (struct value){s, (size_t)(stop - s)};
        }
        n++;
        s = p;
        if (s >= end)
            return n;
    }
}

/* ---- ends of rows ---- */

/* Whether s .. end, which has line breaks, consists of lines that are rows with all columns. */
static bool are_rows(const struct row_style *style, const char *s, const char *end)
{
    while (s < end) {
        const char *lf = memchr(s, style->line_end, (size_t)(end - s));
        const char *stop = lf != NULL ? lf : end;
        if (row_split(style, s, stop, NULL, 0) != style->columns)
            return false;
        s = stop + 1;
    }
    return true;
}

/* The end of a line in which there are quotes. */
static const char *quoted_end(const struct row_style *style, const char *row, const char *end,
                              bool last, struct row_quotes *quotes)
{
    const char *s = row, *lf = NULL;
    for (;; s++) {
        while (s < end && value_is_blank(*s) && *s != style->separator)
            s++;
        if (s < end && *s == '"') {
            const char *close = closing_quote(style, s, end);
            lf = memchr(s, style->line_end, (size_t)(end - s));
            if (close == NULL && !last && memchr(s + 1, '"', (size_t)(end - s) - 1) == NULL)
                return NULL; /* it may be closed by what has not been read yet */
            bool spans = close != NULL && lf != NULL && close > lf;
            if (spans) {
                const char *stop = memchr(close, style->line_end, (size_t)(end - close));
                if (stop == NULL && !last)
                    return NULL;
                spans = style->columns == 0 || !are_rows(style, row, stop != NULL ? stop : end);
            }
            if (close == NULL || (lf != NULL && close > lf && !spans)) {
                quotes->lone = true;
                return lf;
            }
            for (const char *p = s; spans && p < close; p++)
                quotes->breaks += *p == style->line_end;
            s = close + 1;
        }
        while (s < end && *s != style->separator && *s != style->line_end)
            s++;
        if (s >= end)
            return NULL;
        if (*s == style->line_end)
            return s;
    }
}

const char *row_end(const struct row_style *style, const char *s, const char *end, bool last,
                    struct row_quotes *quotes)
{
    const char *lf = memchr(s, style->line_end, (size_t)(end - s));
    const char *stop = lf != NULL ? lf : end;
    if (style->separator == ' ' || memchr(s, '"', (size_t)(stop - s)) == NULL ||
        row_kind(s, stop) != ROW_VALUES)
        return lf;
    *quotes = (struct row_quotes){0};
    const size_t line = (size_t)(stop - s) + (lf != NULL);
    const size_t most = line > ROW_MOST_BYTES ? line : ROW_MOST_BYTES;
    if ((size_t)(end - s) > most) { /* what spans more is no row */
        end = s + most;
        last = true;
    }
    return quoted_end(style, s, end, last, quotes);
}
