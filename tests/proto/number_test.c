/* number_test.c - reading and writing numbers, compared with the C library, which is exact in the C
 * locale. */
#include "proto/number.h"

#include <float.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <string.h>

#include "tests/test.h"

static double from_bits(uint64_t bits)
{
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static bool same(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* A finite double of random bits. */
static double random_double(void)
{
    double v;
    do
        v = from_bits(test_random());
    while (!isfinite(v));
    return v;
}

/* Reads text from a heap block of its exact size, so that a sanitizer sees any byte read beyond the
 * end. */
static bool reads(const char *text, double *v)
{
    size_t len = strlen(text);
    char *exact = malloc(len + (len == 0));
    memcpy(exact, text, len);
    bool ok = proto_read_double(exact, len, v);
    free(exact);
    return ok;
}

static void check_reads_like_strtod(const char *text)
{
    double got = 99, want = strtod(text, NULL);
    CHECK_MSG(reads(text, &got), "refused: %.100s", text);
    CHECK_MSG(same(got, want), "%.1000s read as %a, not %a", text, got, want);
}

static void check_reads_as(const char *text, double want)
{
    double got = 99;
    CHECK_MSG(reads(text, &got), "refused: %s", text);
    CHECK_MSG(same(got, want), "%s read as %a, not %a", text, got, want);
}

static void written(char *text, double v)
{
    text[proto_write_double(text, v)] = 0;
}

/* ---- reading ---- */

TEST(number_reads_plain_and_scientific_forms)
{
    check_reads_as("0", 0);
    check_reads_as("-0", -0.0);
    check_reads_as("7", 7);
    check_reads_as("+7", 7);
    check_reads_as("-12.5", -12.5);
    check_reads_as(".5", 0.5);
    check_reads_as("5.", 5);
    check_reads_as("1e3", 1000);
    check_reads_as("1E+3", 1000);
    check_reads_as("1.5e-3", 0.0015);
    check_reads_as("00000000000000000000000000012", 12);
    check_reads_as("0.00000000000000000000000000012", 1.2e-28);
    check_reads_as("0000000000000000000000000000000", 0);
    check_reads_as("-0.000000000000000000000000000e99", -0.0);
    check_reads_as("1e00000000000000000000000000003", 1000);
}

TEST(number_refuses_text_that_is_not_a_decimal_number)
{
    static const char *const bad[] = {
        "",      "-",     "+",        ".",    "-.",    "e5",  ".e5", "1e",       "1e+",  "1e-",
        "1e1.5", "1.2.3", "1..2",     " 1",   "1 ",    "1\t", "1\n", "1\r",      "nan",  "NaN",
        "inf",   "-inf",  "Infinity", "0x10", "0x1p3", "1p3", "1,5", "1_000",    "--1",  "+-1",
        "1-",    "1+2",   "1ee5",     "1e5e", "1e--5", "1f",  "1d5", "\xd9\xa1", "1e5 ", "0x",
        "1e 5",  "- 1",   "e",        "E",    "1/2",   ":",   "/",   "1:",       "1e:",  "1e/"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        double v = 42;
        CHECK_MSG(!reads(bad[i], &v), "accepted: \"%s\"", bad[i]);
        CHECK(v == 42 && !proto_is_number(bad[i], strlen(bad[i])));
    }
    double v = 42;
    CHECK(!proto_read_double("1\0", 2, &v) && !proto_read_double("1\0002", 3, &v) && v == 42);
}

TEST(number_of_every_other_single_byte_is_refused)
{
    for (int c = 0; c < 256; c++) {
        char text[3] = {(char)c, (char)c, '1'};
        double v;
        CHECK(proto_read_double(text, 1, &v) == (c >= '0' && c <= '9'));
        CHECK(proto_read_double(text + 1, 2, &v) ==
              ((c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-'));
    }
}

/* The length of the longest prefix of text[len] that is a number, and its value. */
static size_t longest_number(const char *text, size_t len, double *v)
{
    while (len > 0 && !proto_read_double(text, len, v))
        len--;
    return len;
}

TEST(number_is_read_up_to_the_first_character_that_does_not_belong_to_it)
{
    static const char bytes[] = "0123456789012345678901234567890123456789..+-eE \n,x";
    for (int i = 0; i < 200000; i++) {
        size_t len = test_below(40);
        double v = 7, want = 7;
        char *text = malloc(len + 1); /* of its exact size */
        for (size_t k = 0; k < len; k++)
            text[k] = bytes[test_below(i % 2 == 0 ? sizeof bytes - 1 : 44)];
        size_t n = longest_number(text, len, &want);
        CHECK_MSG(proto_read_leading_double(text, len, &v) == n && same(v, want), "%.*s", (int)len,
                  text);
        free(text);
    }
}

TEST(number_reads_the_digits_before_any_other_byte)
{
    static const char digits[] = "0.73892640517382964051";
    for (int c = 0; c < 256; c++)
        for (size_t at = 2; at < sizeof digits - 1; at++) {
            char text[sizeof digits];
            double v = 7;
            memcpy(text, digits, sizeof digits);
            text[at] = (char)c;
            if ((c >= '0' && c <= '9') || c == 'e' || c == 'E')
                continue;
            CHECK(proto_read_leading_double(text, sizeof digits - 1, &v) == at);
            text[at] = 0;
            CHECK_MSG(same(v, strtod(text, NULL)), "%s read as %a", text, v);
        }
}

TEST(number_beyond_the_doubles_reads_as_infinity)
{
    check_reads_as("1e309", HUGE_VAL);
    check_reads_as("-1e309", -HUGE_VAL);
    check_reads_as("1e99999999999999999999999999999999", HUGE_VAL);
    check_reads_as("123456789012345678901234567890e9999999999", HUGE_VAL);
    check_reads_as("1.7976931348623157e308", DBL_MAX);
    /* 2^1024 - 2^970, the tie between the largest double and 2^1024: infinity is the even one. */
    char text[400];
    int n = snprintf(text, sizeof text, "%.0Lf", 0x1p1024L - 0x1p970L);
    check_reads_as(text, HUGE_VAL);
    CHECK(text[n - 1] == '2');
    text[n - 1] = '1';
    check_reads_as(text, DBL_MAX);
    snprintf(text, sizeof text, "%.0f", DBL_MAX);
    check_reads_as(text, DBL_MAX);
}

TEST(number_that_is_not_zero_never_reads_as_zero)
{
    check_reads_as("1e-400", 0x1p-1074);
    check_reads_as("-1e-400", -0x1p-1074);
    check_reads_as("1e-99999999999999999999999999999999", 0x1p-1074);
    check_reads_as("0.0000000000000000000000001e-99999999999", 0x1p-1074);
    check_reads_as("2e-324", 0x1p-1074);
    check_reads_as("0e-99999999999999999999999999999999", 0);
    check_reads_as("0e99999999999999999999999999999999", 0);
    check_reads_as("4.9e-324", 0x1p-1074);
    check_reads_as("1e-323", 0x1p-1073);
}

TEST(number_reads_random_bit_patterns_at_every_precision)
{
    char text[64];
    for (int i = 0; i < 300000; i++) {
        double v = random_double();
        snprintf(text, sizeof text, "%.*e", i % 22, v);
        if (strtod(text, NULL) != 0)
            check_reads_like_strtod(text);
    }
}

TEST(number_reads_random_digits_at_every_exponent)
{
    char text[64];
    for (int e = -345; e <= 312; e++)
        for (int i = 0; i < 300; i++) {
            uint64_t digits = test_random() >> test_below(64);
            snprintf(text, sizeof text, "%" PRIu64 "e%d", digits, e);
            if (strtod(text, NULL) != 0 || digits == 0)
                check_reads_like_strtod(text);
        }
}

TEST(number_reads_fixed_point_forms)
{
    char text[64];
    for (int i = 0; i < 300000; i++) {
        double v = (test_uniform() - 0.5) * pow(10, (int)test_below(16));
        snprintf(text, sizeof text, "%.*f", (int)test_below(20), v);
        check_reads_like_strtod(text);
    }
}

/* The decimal text of (2m + 1) * 2^(e - 1), the tie between neighbours; exact in glibc's printf as
 * a long double. */
static void midpoint_text(char *text, size_t size, double v)
{
    long double next = (long double)nextafter(v, HUGE_VAL);
    snprintf(text, size, "%.800Le", ((long double)v + next) / 2);
}

TEST(number_reads_ties_and_their_neighbours)
{
    char text[900];
    for (int i = 0; i < 6000; i++) {
        double v = fabs(random_double());
        if (v >= DBL_MAX)
            continue;
        midpoint_text(text, sizeof text, v);
        check_reads_like_strtod(text);
        char *e = strchr(text, 'e');
        char *last = e - 1;
        while (*last == '0')
            last--;
        (*last)++; /* above the tie by a unit of its last digit (9 becomes ':', so skip it) */
        if (*last <= '9')
            check_reads_like_strtod(text);
        *last = (char)(*last - 2);
        if (*last >= '0')
            check_reads_like_strtod(text);
    }
}

TEST(number_reads_ties_of_short_integers_to_even)
{
    char text[64];
    for (int i = 0; i < 100000; i++) {
        uint64_t odd = (((uint64_t)1 << 53) + (test_random() >> 11)) | 1; /* 54 bits */
        int shift = (int)test_below(10);
        snprintf(text, sizeof text, "%" PRIu64, odd << shift);
        check_reads_like_strtod(text);
        snprintf(text, sizeof text, "%" PRIu64, (odd << shift) + 1);
        check_reads_like_strtod(text);
        snprintf(text, sizeof text, "%" PRIu64 ".000000000000000000000000", odd << shift);
        check_reads_like_strtod(text);
        snprintf(text, sizeof text, "%" PRIu64 ".000000000000000000000001", odd << shift);
        check_reads_like_strtod(text);
    }
    check_reads_as("9007199254740993", 9007199254740992.0);
    check_reads_as("9007199254740993.00000000000000000000000000000001", 9007199254740994.0);
}

TEST(number_reads_thousands_of_digits)
{
    char *text = malloc(70000);
    for (int i = 0; i < 300; i++) {
        size_t n = 1 + test_below(i % 10 == 0 ? 60000 : 2000), point = test_below((uint32_t)n);
        for (size_t k = 0; k < n; k++)
            text[k] = (char)('0' + test_below(10));
        text[point] = '.';
        if (n == 1)
            text[0] = '1';
        snprintf(text + n, 32, "e%d", (int)test_below(800) - 400 - (int)point);
        if (strtod(text, NULL) != 0)
            check_reads_like_strtod(text);
    }
    free(text);
}

/* The deciding digit may come after any number of zeros. */
TEST(number_reads_a_tie_that_a_far_digit_breaks)
{
    char text[3000];
    for (int zeros = 0; zeros < 2500; zeros++) {
        int n = snprintf(text, sizeof text, "9007199254740993.%0*d%d", zeros, 0, zeros % 9 + 1);
        CHECK(n > 0);
        check_reads_as(text, 9007199254740994.0);
    }
}

TEST(number_reads_the_longest_midpoint_exactly)
{
    char text[1200];
    double v =
        nextafter(0x1p-1022, 0); /* the largest subnormal: its midpoints have the most digits */
    int n = snprintf(text, sizeof text, "%.1100Lf", ((long double)v + 0x1p-1022L) / 2);
    check_reads_as(text, 0x1p-1022);
    text[n - 1] = '1';
    check_reads_as(text, 0x1p-1022);
    n = snprintf(text, sizeof text, "%.1100Lf",
                 ((long double)v + (long double)nextafter(v, 0)) / 2);
    check_reads_like_strtod(text);
    text[n - 1] = '1';
    check_reads_as(text, v);
}

TEST(number_reads_all_powers_of_two_and_their_neighbours)
{
    char text[64];
    for (uint64_t biased = 0; biased < 2047; biased++)
        for (int64_t off = -2; off <= 2; off++) {
            int64_t bits = (int64_t)(biased << 52) + off;
            if (bits < 0 || (uint64_t)bits >= (uint64_t)2047 << 52)
                continue;
            for (int digits = 14; digits < 22; digits++) {
                snprintf(text, sizeof text, "%.*e", digits, from_bits((uint64_t)bits));
                check_reads_like_strtod(text);
            }
        }
}

TEST(number_reads_the_known_hard_cases)
{
    static const char *const hard[] = {"2.2250738585072011e-308",
                                       "2.2250738585072012e-308",
                                       "2.2250738585072014e-308",
                                       "6.631236846766476e-316",
                                       "3.237883913302901e-319",
                                       "4.9406564584124654e-324",
                                       "2.4703282292062328e-324",
                                       "1.00000000000000011102230246251565404",
                                       "1.00000000000000011102230246251565405",
                                       "1.7976931348623158e308",
                                       "8.41e21",
                                       "9.5e-23",
                                       "1448997445238699",
                                       "0.500000000000000166533453693773481063544750213623046875",
                                       "9214843084008499",
                                       "18446744073709551615",
                                       "18446744073709551616",
                                       "7.2057594037927933e16",
                                       "90054602635948575728E72",
                                       "9999999999999999999",
                                       "10000000000000000000",
                                       "1e22",
                                       "1e23",
                                       "-1e-22",
                                       "9007199254740992e22",
                                       "9007199254740991e-22"};
    for (size_t i = 0; i < sizeof hard / sizeof hard[0]; i++)
        check_reads_like_strtod(hard[i]);
}

TEST(number_does_not_depend_on_the_locale)
{
    static const char *const comma[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE",
                                        "fr_FR"};
    for (size_t i = 0; i < sizeof comma / sizeof comma[0]; i++)
        if (setlocale(LC_ALL, comma[i]) != NULL)
            break;
    check_reads_as("1.5", 1.5);
    check_reads_as("0.1234567890123456789012345678901234567890", 0.1234567890123456789);
    double v;
    CHECK(!reads("1,5", &v));
    char text[PROTO_NUMBER_MAX + 1];
    written(text, -1.5);
    CHECK_STR(text, "-1.5");
}

/* ---- writing ---- */

static void check_writes(double v, const char *want)
{
    char text[PROTO_NUMBER_MAX + 1];
    written(text, v);
    CHECK_STR(text, want);
}

TEST(number_writes_javascript_layout)
{
    check_writes(0, "0");
    check_writes(-0.0, "-0");
    check_writes(1, "1");
    check_writes(-1, "-1");
    check_writes(10, "10");
    check_writes(1e20, "100000000000000000000");
    check_writes(123456789012345680000.0, "123456789012345680000");
    check_writes(1e21, "1e+21");
    check_writes(1.5e22, "1.5e+22");
    check_writes(1e23, "1e+23");
    check_writes(1.2345e22, "1.2345e+22");
    check_writes(0.1, "0.1");
    check_writes(0.5, "0.5");
    check_writes(0.3, "0.3");
    check_writes(0.1 + 0.2, "0.30000000000000004");
    check_writes(123.456, "123.456");
    check_writes(-3.0000000000000004, "-3.0000000000000004");
    check_writes(0.000001, "0.000001");
    check_writes(0.00000123, "0.00000123");
    check_writes(-0.0000012345678901234567, "-0.0000012345678901234567");
    check_writes(1e-7, "1e-7");
    check_writes(1.5e-7, "1.5e-7");
    check_writes(5e-324, "5e-324");
    check_writes(1e-323, "1e-323");
    check_writes(DBL_MAX, "1.7976931348623157e+308");
    check_writes(-DBL_MIN, "-2.2250738585072014e-308");
    check_writes(9007199254740991, "9007199254740991");
    check_writes(9007199254740992, "9007199254740992");
    check_writes(0x1p201, "3.2138760885179806e+60");
    check_writes(0x1p-142, "1.793662034335766e-43");
}

/* Of two shortest decimals that are equally near, the one that ends in an even digit is written. */
TEST(number_writes_ties_as_the_even_decimal)
{
    check_writes(1125899906842624.25, "1125899906842624.2");
    check_writes(1125899906842624.75, "1125899906842624.8");
    check_writes(-1125899906842625.25, "-1125899906842625.2");
    check_writes(562949953421313.125, "562949953421313.1"); /* no tie: nearer */
}

/* The significant digits of text as a number, and their count. */
static uint64_t digits_of(const char *text, int *count)
{
    char digits[PROTO_NUMBER_MAX];
    int n = 0;
    for (; *text != 0 && *text != 'e'; text++)
        if (*text >= '0' && *text <= '9' && (n > 0 || *text != '0'))
            digits[n++] = *text;
    while (digits[n - 1] == '0')
        n--;
    digits[n] = 0;
    *count = n;
    return strtoull(digits, NULL, 10);
}

/* -1, 0, 1: the digits are less than half a unit, half a unit, more than it. */
static int against_half(const char *digits)
{
    if (digits[0] != '5')
        return digits[0] < '5' ? -1 : 1;
    return digits[1 + strspn(digits + 1, "0")] == 'e' ? 0 : 1;
}

/* Checks v's text against the exact expansion of v: no decimal with one digit less reads back as v, and
 * of those with as many digits that do, it is the nearest. */
static void check_shortest(double v)
{
    char text[PROTO_NUMBER_MAX + 1], exact[800], candidate[64];
    int n;
    memset(text, '#', sizeof text);
    size_t len = proto_write_double(text, v);
    CHECK(len <= 25);
    CHECK(text[PROTO_NUMBER_MAX] == '#');
    text[len] = 0;
    CHECK_MSG(same(strtod(text, NULL), v), "%a written as %s", v, text);
    double back;
    CHECK(proto_read_double(text, len, &back) && same(back, v));

    uint64_t digits = digits_of(text, &n);
    snprintf(exact, sizeof exact, "%.770e", fabs(v));
    int e = atoi(strchr(exact, 'e') + 1);
    memmove(exact + 1, exact + 2, strlen(exact + 1)); /* without the point */
    bool back_at[2];
    uint64_t below = 0;
    for (int have = n > 1 ? n - 1 : n; have <= n; have++) {
        below = strtoull((snprintf(candidate, sizeof candidate, "%.*s", have, exact), candidate),
                         NULL, 10);
        for (unsigned i = 0; i < 2; i++) {
            snprintf(candidate, sizeof candidate, "%" PRIu64 "e%d", below + i, e - have + 1);
            back_at[i] = strtod(candidate, NULL) == fabs(v);
            CHECK_MSG(have == n || !back_at[i], "%a written as %s, but %s does", v, text,
                      candidate);
        }
    }
    bool above = back_at[1] && (!back_at[0] || against_half(exact + n) > 0);
    if (back_at[0] && back_at[1] && against_half(exact + n) == 0)
        above = digits != below; /* a tie: either is right */
    uint64_t want = below + above;
    while (want % 10 == 0)
        want /= 10;
    CHECK_MSG(digits == want, "%a written as %s, %" PRIu64 " is nearer", v, text, want);
}

TEST(number_writes_the_shortest_and_nearest_of_random_bits)
{
    for (int i = 0; i < 60000; i++)
        check_shortest(random_double());
}

TEST(number_writes_the_shortest_at_powers_of_two)
{
    for (uint64_t biased = 0; biased < 2047; biased++)
        for (int64_t off = -2; off <= 2; off++) {
            int64_t bits = (int64_t)(biased << 52) + off;
            if (bits > 0 && (uint64_t)bits < (uint64_t)2047 << 52)
                check_shortest(from_bits((uint64_t)bits));
        }
}

TEST(number_writes_the_shortest_at_powers_of_ten)
{
    char text[32];
    for (int e = -323; e <= 308; e++)
        for (int lead = 1; lead < 10; lead++) {
            snprintf(text, sizeof text, "%de%d", lead, e);
            double v = strtod(text, NULL);
            if (!isfinite(v))
                continue;
            check_shortest(v);
            check_shortest(nextafter(v, 0) > 0 ? nextafter(v, 0) : v);
            check_shortest(nextafter(v, DBL_MAX));
        }
}

TEST(number_writes_the_shortest_of_subnormals)
{
    for (uint64_t bits = 1; bits < 3000; bits++)
        check_shortest(from_bits(bits));
    for (int i = 0; i < 10000; i++)
        check_shortest(from_bits(1 + (test_random() >> (12 + test_below(51)))));
}

TEST(number_writes_short_decimals_as_they_were_typed)
{
    char text[64], got[PROTO_NUMBER_MAX + 1];
    for (int i = 0; i < 200000; i++) {
        double v;
        int decimals = 1 + (int)test_below(7);
        uint32_t whole = test_below(100000000), fraction = test_below(1000000);
        int n =
            snprintf(text, sizeof text, "%s%u.%0*u", i % 2 ? "-" : "", whole, decimals, fraction);
        while (text[n - 1] == '0')
            text[--n] = 0;
        if (text[n - 1] == '.')
            text[--n] = 0;
        if (strcmp(text, "-0") == 0 || (whole == 0 && fraction < 10))
            continue;
        CHECK(reads(text, &v));
        written(got, v);
        CHECK_STR(got, text);
    }
}

TEST(number_writes_integers_whole)
{
    char text[64], got[PROTO_NUMBER_MAX + 1];
    for (int i = 0; i < 200000; i++) {
        uint64_t v = test_random() >> (11 + test_below(53));
        snprintf(text, sizeof text, "%" PRIu64, v);
        written(got, (double)v);
        CHECK_STR(got, text);
        snprintf(text, sizeof text, "%" PRIu32, (uint32_t)v);
        got[proto_write_u32(got, (uint32_t)v)] = 0;
        CHECK_STR(got, text);
    }
    got[proto_write_u32(got, UINT32_MAX)] = 0;
    CHECK_STR(got, "4294967295");
    for (uint32_t v = 1, digits = 1; digits <= 10; digits++, v *= 10)
        for (uint32_t w = v - 1; w <= v + 1; w++) {
            snprintf(text, sizeof text, "%" PRIu32, w);
            memset(got, '?', sizeof got);
            got[proto_write_u32(got, w)] = 0;
            CHECK_STR(got, text);
            CHECK(got[11] == '?');
        }
}
