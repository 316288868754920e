/* request_fuzz.c - libFuzzer target: any bytes as request lines. The lines must not depend on how
 * the bytes are cut; words lie within their line, contain no blanks, and only blanks are between
 * them. */
#include "proto/line.h"
#include "proto/request.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool condition)
{
    if (!condition)
        abort();
}

/* A copy of its exact size, so that a read beyond it is noticed. */
static char *exact_copy(const void *bytes, size_t n)
{
    char *copy = malloc(n + (n == 0));
    require(copy != NULL);
    memcpy(copy, bytes, n);
    return copy;
}

static size_t blanks(const char *from, const char *to)
{
    size_t n = 0;
    for (; from < to && (*from == ' ' || *from == '\t'); from++)
        n++;
    return n;
}

static void look_at_word(const struct word *w)
{
    char *upper = malloc(w->len + 1), *copy = exact_copy(w->text, w->len);
    struct word exact = {copy, w->len};
    require(upper != NULL);
    for (size_t i = 0; i < w->len; i++)
        upper[i] = copy[i] >= 'a' && copy[i] <= 'z' ? (char)(copy[i] - 'a' + 'A') : copy[i];
    upper[w->len] = '\0';
    require(word_is(&exact, upper) == (memchr(upper, '\0', w->len) == NULL));
    require(!word_is(&exact, "") || w->len == 0);
    require(!word_is_set_name(&exact) || (w->len >= 1 && w->len <= SET_NAME_LIMIT));
    free(copy);
    free(upper);
}

static void look_at_line(const char *text, size_t len)
{
    static struct request q; /* reused, as the server does */
    char *copy = exact_copy(text, len);
    const char *at = copy;
    require(request_split(&q, copy, len));
    for (size_t i = 0; i < q.n; i++) {
        const struct word *w = &q.word[i];
        require(w->len > 0 && at + blanks(at, copy + len) == w->text);
        require(memchr(w->text, ' ', w->len) == NULL && memchr(w->text, '\t', w->len) == NULL);
        look_at_word(w);
        at = w->text + w->len;
    }
    require(at + blanks(at, copy + len) == copy + len);
    line_is_http(copy, len);
    free(copy);
}

/* Reads one line from the first n bytes; the result and the line. */
static ptrdiff_t read_front(const uint8_t *data, size_t n, bool last, struct line *line)
{
    char *copy = exact_copy(data, n);
    ptrdiff_t took = line_read(copy, n, last, line);
    require(took <= (ptrdiff_t)n);
    if (took > 0) {
        require(line->text == copy && line->len < (size_t)took + (last && (size_t)took == n));
        look_at_line(line->text, line->len);
    }
    free(copy);
    return took;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct line whole, part;
    while (size > 0) {
        ptrdiff_t took = read_front(data, size, false, &whole);
        for (size_t cut = 1; cut < size && cut < 100; cut++) {
            ptrdiff_t early = read_front(data, cut, false, &part);
            if (early > 0)
                require(early == took && part.len == whole.len);
            else if (early < 0) /* a NUL may be found early or late, but is always found */
                require(part.fault == LINE_NUL || took < 0);
        }
        if (took == 0)
            took = read_front(data, size, true, &whole);
        if (took <= 0)
            break;
        data += took;
        size -= (size_t)took;
    }
    return 0;
}
