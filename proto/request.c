/* request.c - see request.h. ASCII only: the locale has no effect. */
#include "proto/request.h"

#include "proto/text.h"

#include <stdlib.h>
#include <string.h>

static bool grow(struct request *q, size_t need)
{
    size_t cap = q->cap == 0 ? 16 : 2 * q->cap;
    cap = cap < need ? need : cap;
    struct word *word = realloc(q->word, cap * sizeof *word);
    if (word == NULL)
        return false;
    q->word = word;
    q->cap = cap;
    return true;
}

bool request_add(struct request *q, const char *text, size_t len)
{
    if (q->n == q->cap && !grow(q, q->n + 1))
        return false;
    q->word[q->n++] = (struct word){text, len};
    return true;
}

bool request_set(struct request *q, const struct word *word, size_t n)
{
    q->n = 0;
    if (n > q->cap && !grow(q, n))
        return false;
    for (; q->n < n; q->n++)
        q->word[q->n] = word[q->n];
    return true;
}

bool request_split(struct request *q, const char *text, size_t len)
{
    const char *end = text + len;
    q->n = 0;
    for (const char *p = text;;) {
        while (p < end && text_is_blank(*p))
            p++;
        if (p == end)
            return true;
        const char *word = p;
        while (p < end && !text_is_blank(*p))
            p++;
        if (!request_add(q, word, (size_t)(p - word))) {
            q->n = 0;
            return false;
        }
    }
}

void request_free(struct request *q)
{
    free(q->word);
    *q = (struct request){0};
}

bool word_is_whole(const struct word *w, const char *upper)
{
    for (size_t i = 0; i < w->len; i++) {
        char c = w->text[i], u = upper[i];
        if (u == '\0') /* a word in RESP framing may also contain NUL bytes */
            return false;
        if (c != u && (c < 'a' || c > 'z' || c - 'a' + 'A' != u))
            return false;
    }
    return upper[w->len] == '\0';
}

static bool may_name(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || text_is_digit(c) || c == '_' ||
           c == '.' || c == ':' || c == '-';
}

bool word_is_set_name(const struct word *w)
{
    if (w->len < 1 || w->len > SET_NAME_LIMIT)
        return false;
    for (size_t i = 0; i < w->len; i++)
        if (!may_name(w->text[i]))
            return false;
    return true;
}

bool word_is_field_name(const struct word *w)
{
    return word_is_set_name(w) && w->text[0] > ':'; /* of those: letters and `_` */
}

static size_t skip(const char *text, size_t len, size_t at, bool blanks)
{
    while (at < len && text_is_blank(text[at]) == blanks)
        at++;
    return at;
}

bool line_is_whole_request(const char *text, size_t len)
{
    for (size_t i = 0; i < len; i++)
        if (text[i] == '\n' || text[i] == '\r' || text[i] == '\0')
            return false;
    for (size_t at = 0;;) {
        at = skip(text, len, at, true);
        struct word command = {text + at, skip(text, len, at, false) - at};
        if (command.len == 0 || command.text[0] == '#')
            return false;
        if (!word_is(&command, "TIMEOUT"))
            return !word_is(&command, "LOAD") && (command.text[command.len - 1] | 0x20) != 'b';
        at = skip(text, len, at + command.len, true);
        at = skip(text, len, at, false); /* the seconds */
        if (skip(text, len, at, true) == len)
            return true; /* a setting, or a request that is refused */
    }
}

bool line_is_http(const char *text, size_t len)
{
    static const char mark[] = " HTTP/1.";
    size_t n = sizeof mark - 1;
    return len > n && memcmp(text + len - n - 1, mark, n) == 0;
}
