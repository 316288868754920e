/* reply_test.c - the bytes of replies. */
#include "proto/reply.h"
#include "tests/test.h"

#include <float.h>
#include <string.h>

static struct buf out;

static const char *written(void)
{
    static char text[4096];
    CHECK(buf_len(&out) < sizeof text);
    memcpy(text, buf_head(&out), buf_len(&out));
    text[buf_len(&out)] = '\0';
    buf_free(&out);
    return text;
}

TEST(reply_starts_with_a_status_line)
{
    reply_ok(&out, 2);
    reply_key_u64(&out, "big", UINT64_MAX);
    reply_key_double(&out, "ms", 0.012);
    reply_key_text(&out, "where", "inside");
    reply_end(&out);
    CHECK_STR(written(), "OK 2 big=18446744073709551615 ms=0.012 where=inside\n");
}

TEST(reply_rows_are_ids_and_points)
{
    const uint32_t ids[] = {0, UINT32_MAX, 7};
    reply_row_ids(&out, ids, 3);
    reply_row_ids(&out, ids, 1);
    reply_row_values(&out, 5, (const double[]){-0.1, 1e21}, 2);
    reply_row_values(&out, 5, (const double[]){1, 2, 0.5}, 3);
    reply_row_text(&out, "a b");
    CHECK_STR(written(), "0 4294967295 7\n0\n5 -0.1 1e+21\n5 1 2 0.5\na b\n");
}

TEST(reply_rows_stay_within_the_buffer_at_every_fill_level)
{
    const double longest = -DBL_TRUE_MIN * 1.2345678901234567e15; /* of 24 characters */
    const uint32_t id = UINT32_MAX;
    for (size_t fill = 0; fill <= 256; fill++) {
        for (int kind = 0; kind < 4; kind++) {
            while (buf_len(&out) < fill)
                buf_append_char(&out, 'x');
            if (kind == 0)
                reply_row_values(&out, id, (const double[]){longest, longest, longest}, 3);
            else if (kind == 1)
                reply_row_values(&out, id, (const double[]){longest, longest}, 2);
            else if (kind == 2)
                reply_row_ids(&out, &id, 1);
            else
                reply_key_double(&out, "key", longest);
            CHECK_MSG(out.end <= out.cap, "kind %d at %zu", kind, fill);
            buf_free(&out);
        }
    }
}

TEST(reply_words_are_little_endian)
{
    reply_word_u32(&out, 0x01020304);
    reply_word_double(&out, 1.0);
    CHECK(buf_len(&out) == 12 && memcmp(buf_head(&out), "\4\3\2\1\0\0\0\0\0\0\xf0\x3f", 12) == 0);
    reply_words_u32(&out, (const uint32_t[]){1, 0x80000002}, 2);
    CHECK(buf_len(&out) == 20 && memcmp(buf_head(&out) + 12, "\1\0\0\0\2\0\0\x80", 8) == 0);
    reply_words_double(&out, (const double[]){1, -1}, 2);
    CHECK(buf_len(&out) == 36 &&
          memcmp(buf_head(&out) + 20, "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\xf0\xbf", 16) == 0);
    buf_free(&out);
}

__attribute__((format(printf, 2, 3))) static void refuse(enum reply_code code, const char *format,
                                                         ...)
{
    va_list ap;
    va_start(ap, format);
    reply_err(&out, code, format, ap);
    va_end(ap);
}

TEST(reply_errors_quote_nothing_that_could_harm_a_terminal_or_a_parser)
{
    refuse(ERR_UNKNOWN, "no %s here", "\x1b[2J\nOK 0\r\t\xff");
    CHECK_STR(written(), "ERR UNKNOWN no ?[2J?OK 0??? here\n");
}

TEST(reply_errors_are_short_even_if_they_quote_long_text)
{
    char word[1000];
    memset(word, 'w', sizeof word);
    word[999] = '\0';
    refuse(ERR_UNTRIANGULATED, "%s", word);
    CHECK(buf_len(&out) <= REPLY_ERR_ROOM && buf_head(&out)[buf_len(&out) - 1] == '\n');
    buf_free(&out);
}

TEST(reply_comments_are_comments)
{
    reply_comment(&out, "progress %u %s", 37u, "triangulating");
    CHECK_STR(written(), "# progress 37 triangulating\n");
}

TEST(reply_codes_have_the_names_of_the_protocol)
{
    static const char *const names[] = {
        "SYNTAX",       "UNKNOWN",        "NUMBER",      "RANGE",       "NOSET",
        "EXISTS",       "NOPOINT",        "NOEDGE",      "NOTRIANGLE",  "NOFIELD",
        "NOCONSTRAINT", "CROSSES",        "CONSTRAINED", "NOTDELAUNAY", "NOREGION",
        "OPEN",         "UNTRIANGULATED", "TOOLONG",     "TOOBIG",      "BUSY",
        "NOMEM",        "READONLY",       "NOFOLLOWERS", "NOAUTH",      "DENIED",
        "TIMEOUT",      "CANCELLED",      "LOADING",     "IO",          "CORRUPT"};
    for (unsigned i = 0; i <= ERR_CORRUPT; i++)
        CHECK_STR(reply_code_name((enum reply_code)i), names[i]);
}

static void write_everything(void)
{
    const uint32_t ids[] = {1, 2, 3};
    reply_ok(&out, 3);
    reply_key_double(&out, "x", DBL_MAX);
    reply_end(&out);
    reply_row_ids(&out, ids, 3);
    reply_row_values(&out, 1, (const double[]){2, 3}, 2);
    reply_row_values(&out, 1, (const double[]){2, 3, 4}, 3);
    reply_word_double(&out, 5);
}

TEST(reply_remembers_that_memory_ran_out)
{
    write_everything();
    size_t whole = buf_len(&out);
    CHECK(!out.failed);
    buf_free(&out);
    long n = 1;
    for (;; n++) {
        test_fail_alloc(n);
        write_everything();
        if (!test_alloc_failed())
            break;
        CHECK(out.failed && buf_len(&out) < whole);
        buf_free(&out);
    }
    CHECK(n > 1 && !out.failed && buf_len(&out) == whole);
    buf_free(&out);
}
