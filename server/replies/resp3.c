/* resp3.c - see resp3.h. */
#include "server/replies/resp3.h"

#include "proto/number.h"
#include "proto/resp.h"
#include "proto/text.h"

#include <string.h>

/* ---- values ---- */

static void put(struct buf *out, char mark, const char *text, size_t len)
{
    char *to = buf_reserve(out, len + 3);
    if (to == NULL)
        return;
    to[0] = mark;
    memcpy(to + 1, text, len);
    memcpy(to + 1 + len, "\r\n", 2);
    buf_commit(out, len + 3);
}

static bool is_digits(const char *text, size_t len)
{
    for (size_t i = 0; i < len; i++)
        if (!text_is_digit(text[i]))
            return false;
    return len > 0 && len <= 18; /* fits in 64 bits */
}

static bool is(const char *text, size_t len, const char *what)
{
    return len == strlen(what) && memcmp(text, what, len) == 0;
}

static bool is_infinite(const char *text, size_t len)
{
    return is(text, len, "inf") || is(text, len, "-inf");
}

/* One word. A number that is missing (nan) is null: old readers of RESP 3 do not know its nan. */
static void put_word(struct buf *out, char type, const char *text, size_t len)
{
    if (type == 'i' && is_digits(text, len))
        put(out, ':', text, len);
    else if (type == 'd' && is(text, len, "nan"))
        resp3_null(out);
    else if (type == 'd' && (proto_is_number(text, len) || is_infinite(text, len)))
        put(out, ',', text, len);
    else if (type == 'w' && (is_digits(text, len) || proto_is_number(text, len)))
        put_word(out, is_digits(text, len) ? 'i' : 'd', text, len);
    else
        resp_bulk(out, text, len);
}

void resp3_map(struct buf *out, size_t n)
{
    size_t mark = buf_len(out);
    resp_array(out, n);
    if (!out->failed)
        buf_head(out)[mark] = '%';
}

void resp3_null(struct buf *out)
{
    buf_append(out, "_\r\n", 3);
}

/* ---- facts: ` key=value key=value` ---- */

struct words {
    const char *at, *end;
};

/* The next word; false: there is none. */
static bool next_word(struct words *w, const char **text, size_t *len)
{
    while (w->at < w->end && *w->at == ' ')
        w->at++;
    *text = w->at;
    while (w->at < w->end && *w->at != ' ')
        w->at++;
    *len = (size_t)(w->at - *text);
    return *len > 0;
}

static size_t count_words(struct words w)
{
    const char *text;
    size_t len, n = 0;
    while (next_word(&w, &text, &len))
        n++;
    return n;
}

/* Facts that are doubles; the others are counts, yes or no, or texts. */
static bool is_double(const char *key, size_t len)
{
    return is(key, len, "ms") || is(key, len, "tol") || is(key, len, "ttl") ||
           is(key, len, "area") || is(key, len, "above") || is(key, len, "below");
}

/* A fact that is a text even if all its characters are digits. */
static bool is_always_text(const char *key, size_t len)
{
    return is(key, len, "digest");
}

static void put_fact(struct buf *out, const char *text, size_t len)
{
    const char *equals = memchr(text, '=', len);
    size_t key = equals != NULL ? (size_t)(equals - text) : len;
    const char *value = equals != NULL ? equals + 1 : text + len;
    size_t rest = (size_t)(text + len - value);
    resp_bulk(out, text, key);
    if (is(value, rest, "yes") || is(value, rest, "no"))
        put(out, '#', rest == 3 ? "t" : "f", 1);
    else
        put_word(out,
                 is_always_text(text, key) ? 's'
                 : is_double(text, key)    ? 'd'
                                           : 'i',
                 value, rest);
}

static void put_facts(struct buf *out, struct words w)
{
    const char *text;
    size_t len;
    resp3_map(out, count_words(w));
    while (next_word(&w, &text, &len))
        put_fact(out, text, len);
}

/* ---- replies ---- */

/* Chooses between alternatives, "dsid|ddisid": a text (s) of the row is not a number. */
static const char *types_of(const char *types, struct words w)
{
    const char *type = types, *text;
    size_t len;
    while (*type != '\0' && *type != '|' && next_word(&w, &text, &len)) {
        bool number = proto_is_number(text, len) || is_infinite(text, len);
        if (number == (*type++ == 's'))
            return strchr(types, '|') + 1;
    }
    return types;
}

static void put_row(struct buf *out, const char *types, const struct reply_part *part)
{
    const char *type = types != NULL ? types : "w", *text;
    struct words w = {part->text, part->text + part->len};
    size_t len;
    if (strchr(type, '|') != NULL)
        type = types_of(type, w);
    if (*type == 't') {
        resp_bulk(out, part->text, part->len);
        return;
    }
    if (*type == 'm') {
        next_word(&w, &text, &len);
        resp_bulk(out, text, len);
        put_facts(out, w);
        return;
    }
    resp_array(out, count_words(w));
    while (next_word(&w, &text, &len)) {
        put_word(out, *type, text, len);
        if (type[1] != '\0' && type[1] != '|')
            type++;
    }
}

/* Without rows the reply of a command that has some at other times is empty, not OK. */
static void put_status(struct buf *out, const char *types, const struct reply_reader *r,
                       const struct reply_part *part)
{
    uint64_t rows = r->rows_left;
    struct words w = {part->text + 4, part->text + part->len}; /* after "OK 0" */
    if (rows > 0 || types != NULL) {
        if (types != NULL && types[0] == 'm')
            resp3_map(out, rows);
        else
            resp_array(out, rows);
    } else if (count_words(w) > 0) {
        put_facts(out, w);
    } else {
        put(out, '+', "OK", 2);
    }
}

static void put_part(struct buf *out, const char *types, const struct reply_reader *r,
                     const struct reply_part *part)
{
    bool binary =
        part->kind == REPLY_OK && reply_key(part, "bytes", &(const char *){0}, &(size_t){0});
    if (part->kind == REPLY_ROW)
        put_row(out, types, part);
    else if (part->kind == REPLY_OK && !binary)
        put_status(out, types, r, part);
    else /* errors and bytes are the same in RESP 2 */
        resp_part(out, r, part);
}

bool resp3_reframe(struct reply_reader *r, const char *types, const char *bytes, size_t n,
                   struct buf *out)
{
    struct reply_part part;
    while (n > 0) {
        ptrdiff_t took = reply_read(r, bytes, n, &part);
        if (took <= 0)
            return false;
        put_part(out, types, r, &part);
        bytes += took;
        n -= (size_t)took;
    }
    return true;
}

/* ---- events ---- */

static void put_event_facts(struct buf *out, struct words w)
{
    const char *text;
    size_t len;
    resp3_map(out, count_words(w));
    while (next_word(&w, &text, &len)) {
        if (memchr(text, '=', len) != NULL) {
            put_fact(out, text, len);
            continue;
        }
        resp_bulk(out, text, len); /* reset, more, dropped */
        put(out, '#', "t", 1);
    }
}

/* The types of a row that begins with that letter. */
static const char *event_types(char first)
{
    switch (first) {
    case 'p': /* point id x y value ... */
        return "sid";
    case 'c': /* constraint a b kind k x y x y */
        return "siisid";
    case 'r': /* released a b kind k */
        return "siisi";
    default: /* list id kind id ...; gone id */
        return "sisi";
    }
}

void resp3_push(struct buf *out, const char *head, size_t head_len, const char *rows,
                size_t rows_len, size_t n)
{
    const char *text;
    size_t len, mark = buf_len(out);
    struct words w = {head, head + head_len - 1};
    resp_array(out, 2 + n);
    if (!out->failed)
        buf_head(out)[mark] = '>';
    next_word(&w, &text, &len); /* EVENT n */
    next_word(&w, &text, &len);
    resp_bulk(out, "event", 5);
    put_event_facts(out, w);
    while (rows_len > 0) {
        const char *lf = memchr(rows, '\n', rows_len);
        struct reply_part row = {REPLY_ROW, rows, (size_t)(lf - rows), false};
        put_row(out, event_types(*rows), &row);
        rows_len -= row.len + 1;
        rows = lf + 1;
    }
}
