/* slowlog_test.c - the ring of slow requests, and what is kept of a request. */
#include "server/ops/slowlog.h"
#include "tests/test.h"

#include <string.h>

/* The i-th latest entry. */
static const struct slow *latest(const struct slowlog *l, unsigned i)
{
    return slowlog_find(l, l->next - 1 - i);
}

TEST(slowlog_keeps_the_last_ones)
{
    struct slowlog l;
    CHECK(slowlog_init(&l, 3) && slowlog_len(&l) == 0);
    for (int i = 0; i < 5; i++)
        slowlog_add(&l, &(struct slow){.work_us = 10 * i});
    CHECK(slowlog_len(&l) == 3);
    for (unsigned i = 0; i < 3; i++) {
        const struct slow *e = latest(&l, i);
        CHECK(e->id == 4 - i && e->work_us == 10 * (4 - (int)i));
    }
    slowlog_reset(&l);
    CHECK(slowlog_len(&l) == 0);
    slowlog_add(&l, &(struct slow){.work_us = 7});
    CHECK(slowlog_len(&l) == 1 && latest(&l, 0)->id == 5 && latest(&l, 0)->work_us == 7);
    slowlog_clear(&l);
}

TEST(slowlog_that_is_resized_keeps_the_last_ones)
{
    struct slowlog l;
    CHECK(slowlog_init(&l, 3));
    for (int i = 0; i < 5; i++)
        slowlog_add(&l, &(struct slow){.work_us = i});
    CHECK(slowlog_resize(&l, 2) && slowlog_len(&l) == 2);
    CHECK(latest(&l, 0)->work_us == 4 && latest(&l, 1)->work_us == 3);
    CHECK(slowlog_resize(&l, 4) && slowlog_len(&l) == 2);
    CHECK(latest(&l, 0)->work_us == 4 && latest(&l, 1)->work_us == 3);
    CHECK(slowlog_resize(&l, 0) && slowlog_len(&l) == 0);
    slowlog_clear(&l);
}

TEST(slowlog_of_length_0_keeps_nothing)
{
    struct slowlog l;
    CHECK(slowlog_init(&l, 0));
    slowlog_add(&l, &(struct slow){.work_us = 1});
    CHECK(slowlog_len(&l) == 0);
    slowlog_clear(&l);
}

TEST(slowlog_replaces_unprintable_bytes)
{
    char text[SLOW_TEXT];
    struct word word[] = {{"GET", 3}, {"a\0b c\r\n", 7}, {"", 0}, {"\xc3\xa9", 2}};
    slowlog_quote(text, word, 4);
    CHECK_STR(text, "GET a?b?c??  ??");
    slowlog_quote(text, word, 0);
    CHECK_STR(text, "");
}

TEST(slowlog_truncates_long_requests)
{
    enum { N = 80 };
    static char big[2 * SLOW_TEXT];
    char room[SLOW_TEXT + 16], *text = room;
    struct word word[N];
    memset(big, 'x', sizeof big);
    memset(room, 'y', sizeof room);
    for (size_t len = SLOW_TEXT - 8; len < SLOW_TEXT + 8; len++) {
        struct word one = {big, len};
        slowlog_quote(text, &one, 1);
        CHECK(strlen(text) == (len < SLOW_TEXT ? len : SLOW_TEXT - 1));
        CHECK((strstr(text, "...") != NULL) == (len >= SLOW_TEXT));
        CHECK(text[SLOW_TEXT] == 'y');
    }
    for (int i = 0; i < N; i++)
        word[i] = (struct word){big, 3};
    slowlog_quote(text, word, N);
    CHECK(strlen(text) == SLOW_TEXT - 1 && strcmp(text + SLOW_TEXT - 4, "...") == 0);
}
