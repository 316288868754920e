/* resp_fuzz.c - libFuzzer target: any bytes as a request in RESP framing. The result must not depend
 * on the bytes that follow, `need` must be correct, and every word lies within the consumed
 * bytes. */
#include <stdlib.h>
#include <string.h>

#include "proto/resp.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool condition)
{
    if (!condition)
        abort();
}

/* Reads a copy of the first n bytes, of its exact size. */
static ptrdiff_t read_front(const uint8_t *data, size_t n, struct resp *r, size_t *words)
{
    struct request q = {0};
    char *exact = malloc(n + (n == 0));
    require(exact != NULL);
    memcpy(exact, data, n);
    ptrdiff_t took = resp_read(exact, n, &q, r);
    require(took <= (ptrdiff_t)n);
    for (size_t i = 0; took > 0 && i < q.n; i++)
        require(q.word[i].text >= exact && q.word[i].text + q.word[i].len + 2 <= exact + took);
    *words = q.n;
    request_free(&q);
    free(exact);
    return took;
}

enum { PATHS = 5 }; /* bytes of a body that may be the word PATHS */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct resp whole, part;
    size_t words, fewer;
    ptrdiff_t took = read_front(data, size, &whole, &words);
    size_t end = (size_t)took + (whole.has_body && whole.body == PATHS ? PATHS : 0);
    for (size_t cut = 1; cut < size && cut < 200; cut++) {
        ptrdiff_t early = read_front(data, cut, &part, &fewer);
        if (early == 0)
            require(part.need > cut && (took <= 0 || part.need <= end));
        else
            require(early == took && (early < 0 || fewer == words));
    }
    return 0;
}
