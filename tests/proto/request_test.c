/* request_test.c - splitting a line into words. */
#include "proto/request.h"

#include <stdio.h>
#include <string.h>

#include "proto/version.h"
#include "tests/test.h"

static struct request q;

static void split(const char *line)
{
    CHECK(request_split(&q, line, strlen(line)));
}

static bool nth_is(size_t i, const char *text)
{
    return i < q.n && q.word[i].len == strlen(text) &&
           memcmp(q.word[i].text, text, q.word[i].len) == 0;
}

TEST(request_is_split_at_spaces_and_tabs)
{
    split(" \tADD  t\t1 2 ");
    CHECK(q.n == 4 && nth_is(0, "ADD") && nth_is(1, "t") && nth_is(2, "1") && nth_is(3, "2"));
    split("");
    CHECK(q.n == 0);
    split(" \t ");
    CHECK(q.n == 0);
    request_free(&q);
}

TEST(request_may_have_as_many_words_as_a_line_holds)
{
    static char line[65536];
    for (size_t i = 0; i < sizeof line; i++)
        line[i] = i % 2 == 0 ? 'x' : ' ';
    CHECK(request_split(&q, line, sizeof line) && q.n == sizeof line / 2);
    request_free(&q);
}

TEST(request_without_memory_has_no_words)
{
    test_fail_alloc(1);
    CHECK(!request_split(&q, "PING", 4) && test_alloc_failed() && q.n == 0);
    split("PING");
    CHECK(q.n == 1);
    request_free(&q);
}

TEST(words_are_compared_without_regard_to_case)
{
    split("ping PiNg PIN PINGS pin\xc7 [ing");
    CHECK(word_is(&q.word[0], "PING") && word_is(&q.word[1], "PING"));
    for (size_t i = 2; i < q.n; i++)
        CHECK(!word_is(&q.word[i], "PING"));
    request_free(&q);
}

/* Such words arrive in RESP. The expected word is in a block of its exact size, so that a sanitizer sees
 * an overrun. */
TEST(word_with_a_nul_matches_no_keyword)
{
    char *ping = strdup("PING");
    CHECK(ping != NULL);
    for (size_t len = 5; len < 12; len++)
        CHECK(!word_is(&(struct word){.text = "PING\0\0PING\0", .len = len}, ping));
    free(ping);
}

TEST(set_names_are_short_and_plain)
{
    char longest[66];
    memset(longest, 'n', 65);
    longest[65] = '\0';
    split("a Z9_.:- a/b \xc3\xa4 a*");
    CHECK(word_is_set_name(&q.word[0]) && word_is_set_name(&q.word[1]));
    for (size_t i = 2; i < q.n; i++)
        CHECK(!word_is_set_name(&q.word[i]));
    split(longest);
    CHECK(!word_is_set_name(&q.word[0]));
    q.word[0].len = 64;
    CHECK(word_is_set_name(&q.word[0]));
    request_free(&q);
}

TEST(field_names_are_those_of_sets_that_begin_with_a_letter_or_an_underscore)
{
    split("z Z9_.:- _1 9z .z :z -z a/b");
    for (size_t i = 0; i < q.n; i++)
        CHECK(word_is_field_name(&q.word[i]) == (i < 3));
    CHECK(!word_is_field_name(&(struct word){"t", 0}));
    request_free(&q);
}

TEST(set_names_are_not_empty)
{
    CHECK(!word_is_set_name(&(struct word){"t", 0}));
}

TEST(http_is_recognised_by_the_end_of_its_first_line)
{
    CHECK(line_is_http("GET / HTTP/1.1", 14));
    CHECK(line_is_http("POST /x HTTP/1.0", 16));
    CHECK(!line_is_http("GET t 1", 7));
    CHECK(!line_is_http(" HTTP/1.", 8));
    CHECK(!line_is_http("GET /HTTP/1.1", 13));
}

TEST(request_can_be_made_of_words_that_were_read_before)
{
    struct word word[40];
    request_free(&q);
    for (size_t i = 0; i < 40; i++)
        word[i] = (struct word){"abcdefgh", i % 9};
    for (size_t n = 0; n <= 40; n += 8) {
        CHECK(request_set(&q, word, n) && q.n == n);
        for (size_t i = 0; i < n; i++)
            CHECK(q.word[i].text == word[i].text && q.word[i].len == word[i].len);
    }
    request_free(&q);
    test_fail_alloc(1);
    CHECK(!request_set(&q, word, 1) && q.n == 0 && test_alloc_failed());
    request_free(&q);
}

TEST(request_is_whole_if_it_has_a_reply_of_its_own)
{
    static const char *const whole[] = {"PING",      " ping",     "LOCATE t 1 2",
                                        "\tDROP\tb", "x",         "TIMEOUT 1 PING",
                                        "TIMEOUT",   "TIMEOUT 5", "TIMEOUT LOADB"};
    static const char *const other[] = {"",
                                        " \t",
                                        "# a comment",
                                        " #",
                                        "LOAD t",
                                        "load t 2",
                                        "LOADB t 1",
                                        "nearestb t 1",
                                        "TIMEOUT 1 LOADB t 1",
                                        "TIMEOUT 1 TIMEOUT 2 fsetb t z 0 1",
                                        "PING\nPING",
                                        "PING\r",
                                        "PING\r\nPING"};
    for (size_t i = 0; i < sizeof whole / sizeof whole[0]; i++)
        CHECK_MSG(line_is_whole_request(whole[i], strlen(whole[i])), "%s", whole[i]);
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++)
        CHECK_MSG(!line_is_whole_request(other[i], strlen(other[i])), "%s", other[i]);
    CHECK(!line_is_whole_request("PING\0PING", 9));
}

TEST(version_is_the_same_as_text_and_as_number)
{
    unsigned major, minor, patch;
    char rest;
    CHECK(sscanf(DELAUNAY_VERSION, "%u.%u.%u%c", &major, &minor, &patch, &rest) == 3);
    CHECK(DELAUNAY_VERSION_NUMBER == 10000 * major + 100 * minor + patch);
}
