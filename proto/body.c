/* body.c - see body.h. */
#include "proto/body.h"

#include "proto/number.h"
#include "proto/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 64 };

void body_init(struct body *b, enum body_form form, uint64_t count, size_t limit,
               bool (*coordinates_ok)(const double *v, size_t n))
{
    *b = (struct body){.form = form,
                       .left = count,
                       .limit = limit,
                       .records_from = SIZE_MAX,
                       .coordinates_ok = coordinates_ok};
    b->complete = form != BODY_DOT && count == 0;
    body_columns(b, 2, 0);
}

void body_columns(struct body *b, size_t coordinates, size_t values)
{
    b->coordinates = coordinates;
    b->width = coordinates + values;
}

void body_paths(struct body *b)
{
    b->width++;
    b->paths = b->begins = true;
}

void body_columns_of(struct body *b, const struct body *other)
{
    b->coordinates = other->coordinates;
    b->width = other->width;
    b->paths = other->paths;
    b->begins = false;
}

void body_words(struct body *b)
{
    body_columns(b, 0, 1);
    b->words = true;
}

void body_records(struct body *b, size_t points)
{
    b->records_from = points;
}

/* Bytes of a point. */
static size_t point_bytes(const struct body *b)
{
    return b->width * sizeof *b->xy;
}

void body_free(struct body *b)
{
    if (b->memory.release != NULL)
        b->memory.release(b->xy);
    else
        free(b->xy);
    b->xy = NULL;
    b->n = b->cap = 0;
}

static void fail_at(struct body *b, enum body_fault fault, uint64_t line)
{
    if (b->fault != BODY_GOOD)
        return;
    b->fault = fault;
    b->fault_line = line;
    body_free(b);
}

void body_fail(struct body *b, enum body_fault fault)
{
    fail_at(b, fault, b->line);
}

/* The number of points to allocate room for. The announced count is not trusted: memory follows what has
 * arrived. Once an eighth has arrived, the announced count is probably true. */
static size_t capacity(const struct body *b)
{
    size_t cap = b->cap == 0 ? FIRST_CAPACITY : 2 * b->cap;
    if (b->form == BODY_DOT)
        return cap;
    uint64_t all = b->n + b->left + 1; /* `left` may or may not include the current point */
    all = all < b->limit ? all : b->limit;
    return all > b->n && all <= 4 * (uint64_t)cap ? (size_t)all : cap;
}

static bool grow(struct body *b)
{
    size_t cap = capacity(b), bytes = point_bytes(b);
    if (cap > SIZE_MAX / bytes)
        return false;
    double *xy = b->memory.grow == NULL
                     ? realloc(b->xy, cap * bytes)
                     : b->memory.grow(b->memory.ctx, b->xy, b->n * bytes + b->part, cap * bytes);
    if (xy == NULL)
        return false;
    b->xy = xy;
    b->cap = cap;
    return true;
}

/* Makes room for one more point. */
static bool reserve(struct body *b)
{
    if (b->n >= b->limit)
        body_fail(b, BODY_TOOBIG);
    else if (b->n == b->cap && !grow(b))
        body_fail(b, BODY_NOMEM);
    return b->fault == BODY_GOOD;
}

/* Whether a point has two coordinates and nothing else. */
static bool is_plain(const struct body *b)
{
    return body_numbers(b) == 2 && b->coordinates == 2;
}

/* The error for number i of a point. */
static enum body_fault judge(const struct body *b, size_t i, double v)
{
    if (b->words)
        return BODY_GOOD;
    if (i >= b->coordinates)
        return isinf(v) ? BODY_VALUE : BODY_GOOD;
    return isnan(v) ? BODY_NUMBER : b->coordinates_ok(&v, 1) ? BODY_GOOD : BODY_RANGE;
}

/* The error for a point. */
static enum body_fault judge_point(const struct body *b, const double *v)
{
    enum body_fault fault = BODY_GOOD;
    if (is_plain(b)) /* only a binary body can have a NaN */
        return b->coordinates_ok(v, 2)      ? BODY_GOOD
               : isnan(v[0]) || isnan(v[1]) ? BODY_NUMBER
                                            : BODY_RANGE;
    for (size_t i = 0; i < body_numbers(b) && fault == BODY_GOOD; i++)
        fault = judge(b, i, v[i]);
    return fault;
}

/* ---- text ---- */

/* The point of the line, whose numbers have been read, has come. */
static void end_point(struct body *b, double *to)
{
    if (b->paths)
        to[b->width - 1] = b->begins ? -(double)b->line : (double)b->line;
    b->begins = false;
    b->n++;
}

static void add_point(struct body *b, double x, double y)
{
    const double v[2] = {x, y};
    if (b->fault != BODY_GOOD)
        return;
    enum body_fault fault = judge_point(b, v);
    if (fault != BODY_GOOD) {
        body_fail(b, fault);
    } else if (reserve(b)) {
        double *to = b->xy + b->n * b->width;
        to[0] = x;
        to[1] = y;
        end_point(b, to);
    }
}

/* The next word between *p and end, moving *p behind it; its length is 0 at the end. */
static const char *next_word(const char **p, const char *end, size_t *len)
{
    while (*p < end && text_is_blank(**p))
        (*p)++;
    const char *word = *p;
    while (*p < end && !text_is_blank(**p))
        (*p)++;
    *len = (size_t)(*p - word);
    return word;
}

static bool read_number(const struct body *b, size_t i, const char *word, size_t len, double *v)
{
    if (i < b->coordinates || len != 3 || (word[0] | 0x20) != 'n' || (word[1] | 0x20) != 'a' ||
        (word[2] | 0x20) != 'n')
        return proto_read_double(word, len, v);
    *v = (double)NAN;
    return true;
}

/* A line with the values of fields. */
static void take_wide_line(struct body *b, const struct line *line)
{
    const char *p = line->text, *end = p + line->len;
    size_t len, i = 0;
    const char *word = next_word(&p, end, &len);
    const size_t numbers = body_numbers(b);
    bool begins = b->paths && len > 0 && *word == '>';
    b->begins |= begins;
    if (b->fault != BODY_GOOD || len == 0 || begins || *word == '#' || !reserve(b))
        return;
    double *to = b->xy + b->n * b->width;
    enum body_fault fault = BODY_GOOD;
    for (; i < numbers && len > 0 && fault == BODY_GOOD; i++) {
        fault = read_number(b, i, word, len, &to[i]) ? judge(b, i, to[i]) : BODY_NUMBER;
        word = next_word(&p, end, &len);
    }
    if (fault == BODY_GOOD && (i < numbers || len > 0))
        fault = BODY_SYNTAX;
    if (fault != BODY_GOOD)
        body_fail(b, fault);
    else
        end_point(b, to);
}

static void take_line(struct body *b, const struct line *line)
{
    if (!is_plain(b) || b->paths) {
        take_wide_line(b, line);
        return;
    }
    const char *p = line->text, *end = p + line->len;
    size_t x_len, y_len, more_len;
    const char *x_word = next_word(&p, end, &x_len);
    if (b->fault != BODY_GOOD || x_len == 0 || *x_word == '#')
        return;
    const char *y_word = next_word(&p, end, &y_len);
    next_word(&p, end, &more_len);
    double x, y;
    if (y_len == 0 || more_len != 0)
        body_fail(b, BODY_SYNTAX);
    else if (!proto_read_double(x_word, x_len, &x) || !proto_read_double(y_word, y_len, &y))
        body_fail(b, BODY_NUMBER);
    else
        add_point(b, x, y);
}

/* Reads a complete line that is exactly `x y`, including its LF or CRLF; returns its number of
 * bytes. 0: the line is different or incomplete; then line_read and take_line
 * decide. One pass over the bytes instead of five. */
static size_t take_plain_line(struct body *b, const char *bytes, size_t n)
{
    const char *p = bytes, *end = bytes + n;
    double x, y;
    bool plain = b->fault == BODY_GOOD && is_plain(b);
    size_t len = plain ? proto_read_leading_double(p, n, &x) : 0;
    p += len;
    if (len == 0 || p == end || !text_is_blank(*p))
        return 0;
    while (p < end && text_is_blank(*p))
        p++;
    len = proto_read_leading_double(p, (size_t)(end - p), &y);
    p += len;
    if (len == 0 || p == end)
        return 0;
    p += *p == '\r';
    if (p == end || *p != '\n' || p - bytes > LINE_LIMIT)
        return 0;
    b->line++;
    add_point(b, x, y);
    return (size_t)(p + 1 - bytes);
}

static bool is_dot(const struct line *line)
{
    return line->len == 1 && line->text[0] == '.';
}

static ptrdiff_t feed_lines(struct body *b, const char *bytes, size_t n, bool last)
{
    size_t at = 0;
    while (!b->complete) {
        struct line line;
        size_t plain = take_plain_line(b, bytes + at, n - at);
        if (plain > 0) {
            at += plain;
            b->complete = b->form == BODY_LINES && --b->left == 0;
            continue;
        }
        ptrdiff_t took = line_read(bytes + at, n - at, last, &line);
        if (took < 0) {
            b->line_fault = line.fault;
            return -1;
        }
        if (took == 0)
            break;
        at += (size_t)took;
        b->line++;
        if (b->form == BODY_DOT && is_dot(&line)) {
            b->complete = true;
        } else {
            take_line(b, &line);
            b->complete = b->form == BODY_LINES && --b->left == 0;
        }
    }
    return (ptrdiff_t)at;
}

/* Whether a line, without its LF, is `.`. */
static bool ends_body(const char *line, size_t len)
{
    return len > 0 && line[0] == '.' && (len == 1 || (len == 2 && line[1] == '\r'));
}

typedef signed char lanes __attribute__((vector_size(16)));

static lanes load_lanes(const char *bytes)
{
    lanes v;
    memcpy(&v, bytes, sizeof v);
    return v;
}

/* Counts the ends of lines in the first part of bytes[n], 16 bytes at a time, and returns its length; *dot: a line behind one of them
 * begins with a dot. */
static size_t count_lines(const char *bytes, size_t n, uint64_t *lines, bool *dot)
{
    enum { MOST = 127 }; /* that a lane counts */
    size_t at = 0;
    lanes dots = {0};
    while (at + sizeof(lanes) < n) {
        size_t left = (n - 1 - at) / sizeof(lanes), steps = left < MOST ? left : MOST;
        lanes count = {0};
        for (size_t end = at + steps * sizeof(lanes); at < end; at += sizeof(lanes)) {
            lanes ends = load_lanes(bytes + at) == '\n';
            count -= ends;
            dots |= ends & (load_lanes(bytes + at + 1) == '.');
        }
        for (size_t i = 0; i < sizeof count; i++)
            *lines += (uint64_t)count[i];
    }
    *dot = false;
    for (size_t i = 0; i < sizeof dots; i++)
        *dot = *dot || dots[i] != 0;
    return at;
}

/* The same as body_scan for most of bytes[n], if the body has not ended in it. Returns its length; otherwise 0. */
static size_t skip_lines(const char *bytes, size_t n, uint64_t most, uint64_t *lines)
{
    bool dot;
    uint64_t count = 0;
    size_t at = count_lines(bytes, n, &count, &dot);
    const char *last = at > 0 ? memrchr(bytes, '\n', at) : NULL;
    if (last == NULL || dot || bytes[0] == '.' || count >= most)
        return 0;
    *lines = count;
    return (size_t)(last - bytes) + 1;
}

size_t body_scan(const struct body *b, const char *bytes, size_t n, uint64_t most, uint64_t *lines,
                 bool *ended)
{
    const char *lf;
    *lines = 0;
    size_t at = skip_lines(bytes, n, most, lines);
    *ended = false;
    for (; *lines < most && at < n; ++*lines) {
        if ((lf = memchr(bytes + at, '\n', n - at)) == NULL)
            return at;
        *ended = b->form == BODY_DOT && ends_body(bytes + at, (size_t)(lf - bytes) - at);
        if (*ended)
            return at;
        at = (size_t)(lf - bytes) + 1;
    }
    *ended = *lines == most;
    return at;
}

/* The marks of n points of lines that follow those of b. */
static void shift_marks(const struct body *b, double *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        double *mark = v + (i + 1) * b->width - 1;
        *mark += *mark < 0 ? -(double)b->line : (double)b->line;
        if (i == 0 && b->begins)
            *mark = -fabs(*mark);
    }
}

bool body_join(struct body *b, const struct body *lines)
{
    if (b->fault != BODY_GOOD || lines->fault != BODY_GOOD || !lines->complete ||
        lines->n > b->limit - b->n)
        return false;
    while (b->cap - b->n < lines->n)
        if (!grow(b))
            return false;
    if (lines->n > 0)
        memcpy(b->xy + b->n * b->width, lines->xy, lines->n * point_bytes(b));
    if (b->paths && lines->n > 0)
        shift_marks(b, b->xy + b->n * b->width, lines->n);
    b->begins = (b->begins && lines->n == 0) || lines->begins;
    b->n += lines->n;
    b->line += lines->line;
    if (b->form == BODY_LINES)
        b->left -= lines->line;
    return true;
}

/* ---- binary ---- */

/* Bytes of the points that are still to come. */
static uint64_t bytes_left(const struct body *b)
{
    return b->left * point_bytes(b) - b->part;
}

/* Counts n bytes. */
static void pass(struct body *b, size_t n)
{
    size_t size = point_bytes(b), at = b->part + n;
    b->left -= at / size;
    b->line += at / size;
    b->part = at % size;
    b->complete = b->left == 0;
}

/* The number of valid points before the first one that has a fault; n: none has. */
static size_t count_valid(const struct body *b, const double *v, size_t n, enum body_fault *fault)
{
    size_t before = b->records_from > b->n ? b->records_from - b->n : 0,
           points = before < n ? before : n;
    *fault = BODY_GOOD;
    if (is_plain(b) && b->coordinates_ok(v, 2 * points))
        return n;
    for (size_t i = 0; i < points; i++, v += b->width)
        if ((*fault = judge_point(b, v)) != BODY_GOOD)
            return i;
    return n;
}

void body_wrote(struct body *b, size_t n)
{
    size_t points = (b->part + n) / point_bytes(b);
    uint64_t line = b->line;
    double *v = b->xy + b->n * b->width;
    enum body_fault fault;
    size_t valid = count_valid(b, v, points, &fault);
    pass(b, n);
    b->n += valid;
    if (fault != BODY_GOOD)
        fail_at(b, fault, line + valid + 1);
}

/* Bytes of the array that are in use, while there are fewer points than the limit. */
static size_t bytes_used(const struct body *b)
{
    return b->n * point_bytes(b) + b->part;
}

char *body_room(struct body *b, size_t *n)
{
    enum { MANY = 64 * 1024, FEW = 16 * 1024 }; /* bytes that have come; room that is too little */
    if (b->form != BODY_BINARY || b->fault != BODY_GOOD || b->complete || b->n == b->limit ||
        bytes_used(b) < MANY)
        return NULL;
    uint64_t left = bytes_left(b);
    size_t room = b->cap * point_bytes(b) - bytes_used(b);
    if (room < FEW && room < left && b->cap < b->limit && grow(b))
        room = b->cap * point_bytes(b) - bytes_used(b);
    *n = room < left ? room : (size_t)left;
    return room > 0 ? (char *)b->xy + bytes_used(b) : NULL;
}

/* Takes bytes of the body's points, at least one, and returns their number; 0: out of memory. */
static size_t take_bytes(struct body *b, const char *bytes, size_t n)
{
    size_t rest = point_bytes(b) - b->part;
    if (b->n == b->limit) {
        n = n < rest ? n : rest;
        pass(b, n);
        if (n == rest)
            body_fail(b, BODY_TOOBIG);
        return n;
    }
    if (b->n == b->cap && !grow(b)) {
        fail_at(b, BODY_NOMEM, b->line + 1);
        return 0;
    }
    size_t room = b->cap * point_bytes(b) - bytes_used(b);
    n = n < room ? n : room;
    memcpy((char *)b->xy + bytes_used(b), bytes, n);
    body_wrote(b, n);
    return n;
}

/* The rest of a body with a fault is dropped. */
static ptrdiff_t feed_binary(struct body *b, const char *bytes, size_t n)
{
    size_t at = 0;
    uint64_t left = bytes_left(b);
    n = n < left ? n : (size_t)left;
    while (at < n && b->fault == BODY_GOOD)
        at += take_bytes(b, bytes + at, n - at);
    if (at < n)
        pass(b, n - at);
    return (ptrdiff_t)n;
}

ptrdiff_t body_feed(struct body *b, const char *bytes, size_t n, bool last)
{
    if (bytes == NULL) /* an empty buffer has no address to count from */
        bytes = "";
    ptrdiff_t took =
        b->form == BODY_BINARY ? feed_binary(b, bytes, n) : feed_lines(b, bytes, n, last);
    if (last && took >= 0 && !b->complete) {
        b->line++;
        body_fail(b, BODY_ENDED);
        b->complete = true;
        return (ptrdiff_t)n;
    }
    return took;
}
