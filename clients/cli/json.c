/* json.c - see json.h. The grammar of numbers is that of RFC 8259, section 6. */
#include "clients/cli/json.h"

#include "proto/number.h"
#include "proto/text.h"

#include <ctype.h>
#include <string.h>

static bool chosen, written;

void json_choose(void)
{
    chosen = true;
}

bool json_chosen(void)
{
    return chosen;
}

bool json_written(void)
{
    return written;
}

/* ---- values ---- */

struct piece {
    const char *text;
    size_t len;
};

/* Removes the text before the separator from *rest; false at the end. */
static bool next_piece(struct piece *rest, char separator, struct piece *piece)
{
    while (rest->len > 0 && *rest->text == separator) {
        rest->text++;
        rest->len--;
    }
    if (rest->len == 0)
        return false;
    const char *end = memchr(rest->text, separator, rest->len);
    *piece = (struct piece){rest->text, end != NULL ? (size_t)(end - rest->text) : rest->len};
    rest->text += piece->len;
    rest->len -= piece->len;
    return true;
}

/* Numbers of JSON have no plus sign, no zeros in front, and digits on both sides of a point. */
static bool is_json_number(const char *s, size_t len)
{
    const char *end = s + len, *first = s + (len > 0 && *s == '-'), *point = memchr(s, '.', len);
    return proto_is_number(s, len) && text_is_digit(*first) &&
           (*first != '0' || first + 1 == end || !text_is_digit(first[1])) &&
           (point == NULL || (point + 1 < end && text_is_digit(point[1])));
}

void json_string(const char *text, size_t len)
{
    putchar('"');
    for (size_t i = 0; i < len; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c == '"' || c == '\\')
            printf("\\%c", c);
        else if (c < 0x20 || c == 0x7F)
            printf("\\u%04x", c);
        else
            putchar(c);
    }
    putchar('"');
}

static void put_scalar(struct piece v)
{
    if (is_json_number(v.text, v.len))
        fwrite(v.text, 1, v.len, stdout);
    else
        json_string(v.text, v.len);
}

static bool is_text(struct piece v, const char *text)
{
    return v.len == strlen(text) && memcmp(v.text, text, v.len) == 0;
}

/* key=value: the key, and the value as a number, a truth or a string. A digest is a string even if it looks like a number. */
static void put_pair(struct piece pair, const char *equals)
{
    size_t key = (size_t)(equals - pair.text);
    struct piece value = {equals + 1, pair.len - key - 1};
    json_string(pair.text, key);
    putchar(':');
    if (is_text(value, "yes") || is_text(value, "no"))
        fputs(value.len == 3 ? "true" : "false", stdout);
    else if (is_text((struct piece){pair.text, key}, "digest"))
        json_string(value.text, value.len);
    else
        put_scalar(value);
}

/* The pairs of a status line or of a row. A word before them is its name; what follows them is a request, as in
 * SLOWLOG. */
static void put_pairs(struct piece rest, char separator, bool first)
{
    struct piece word;
    bool paired = false;
    while (next_piece(&rest, separator, &word)) {
        const char *equals = memchr(word.text, '=', word.len);
        if (!first)
            putchar(',');
        first = false;
        if (equals != NULL) {
            put_pair(word, equals);
            paired = true;
            continue;
        }
        fputs(paired ? "\"request\":" : "\"name\":", stdout);
        if (paired)
            word.len += rest.len;
        json_string(word.text, word.len);
        if (paired)
            return;
    }
}

/* ---- replies ---- */

static void put_error(struct piece status)
{
    struct piece word;
    next_piece(&status, ' ', &word); /* ERR */
    fputs("{\"ok\":false,\"error\":", stdout);
    if (!next_piece(&status, ' ', &word))
        word = (struct piece){"", 0};
    json_string(word.text, word.len);
    fputs(",\"message\":", stdout);
    size_t blank = status.len > 0 && *status.text == ' ';
    json_string(status.text + blank, status.len - blank);
}

static void put_status(struct piece status)
{
    struct piece word;
    next_piece(&status, ' ', &word); /* OK */
    next_piece(&status, ' ', &word); /* the number of rows */
    fputs("{\"ok\":true", stdout);
    put_pairs(status, ' ', false);
}

/* The first line of an event; its words without a value are facts. */
static void put_event(struct piece head)
{
    struct piece word;
    next_piece(&head, ' ', &word); /* EVENT */
    next_piece(&head, ' ', &word); /* the number of rows */
    fputs("{\"ok\":true", stdout);
    while (next_piece(&head, ' ', &word)) {
        const char *equals = memchr(word.text, '=', word.len);
        putchar(',');
        if (equals != NULL) {
            put_pair(word, equals);
            continue;
        }
        json_string(word.text, word.len);
        fputs(":true", stdout);
    }
}

/* `key:value`: the colon, NULL if the row is none. */
static const char *find_colon(struct piece row)
{
    const char *colon = memchr(row.text, ':', row.len);
    for (const char *p = row.text; colon != NULL && p < colon; p++)
        if (!isalnum((unsigned char)*p) && *p != '_')
            return NULL;
    return colon != NULL && isalpha((unsigned char)*row.text) ? colon : NULL;
}

static void put_map_row(struct piece row, const char *colon)
{
    struct piece value = {colon + 1, row.len - (size_t)(colon - row.text) - 1};
    json_string(row.text, (size_t)(colon - row.text));
    putchar(':');
    if (memchr(value.text, '=', value.len) == NULL) {
        put_scalar(value);
        return;
    }
    putchar('{');
    put_pairs(value, ',', true);
    putchar('}');
}

static void put_row(const struct json_reply *j, struct piece row)
{
    struct piece word;
    const char *colon = j->map ? find_colon(row) : NULL;
    if (j->map) {
        if (colon != NULL)
            put_map_row(row, colon);
    } else if (j->text) {
        json_string(row.text, row.len);
    } else if (memchr(row.text, '=', row.len) != NULL) {
        putchar('{');
        put_pairs(row, ' ', true);
        putchar('}');
    } else {
        putchar('[');
        for (bool first = true; next_piece(&row, ' ', &word); first = false) {
            if (!first)
                putchar(',');
            put_scalar(word);
        }
        putchar(']');
    }
}

bool json_part(void *ctx, const struct delaunay_part *part)
{
    struct json_reply *j = ctx;
    struct piece text = {part->text, part->len};
    written = true;
    if (part->kind == DELAUNAY_PART_ROW) {
        if (j->rows++ == 0) {
            j->map = find_colon(text) != NULL && !j->text;
            fputs(j->map ? ",\"info\":{" : ",\"rows\":[", stdout);
        } else {
            putchar(',');
        }
        put_row(j, text);
    } else if (part->kind != DELAUNAY_PART_COMMENT && part->kind != DELAUNAY_PART_BYTES) {
        j->started = true;
        j->refused = part->kind == DELAUNAY_PART_ERR;
        if (j->refused)
            put_error(text);
        else if (part->kind == DELAUNAY_PART_EVENT)
            put_event(text);
        else
            put_status(text);
    }
    return !ferror(stdout);
}

void json_end(struct json_reply *j)
{
    if (!j->started)
        return;
    if (j->rows > 0)
        putchar(j->map ? '}' : ']');
    else if (!j->refused)
        fputs(",\"rows\":[]", stdout);
    puts("}");
}

/* ---- objects of our own ---- */

void json_begin(bool ok)
{
    written = true;
    printf("{\"ok\":%s", ok ? "true" : "false");
}

void json_key(const char *key)
{
    printf(",\"%s\":", key);
}

void json_text(const char *key, const char *value)
{
    json_key(key);
    json_string(value, strlen(value));
}

void json_number(const char *key, size_t value)
{
    json_key(key);
    printf("%zu", value);
}

void json_finish(void)
{
    puts("}");
}
