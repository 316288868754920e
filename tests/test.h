/* test.h - the project's test harness: tests register themselves, each runs in a process of its own
 * with a time-out.
 *
 *     TEST(name_is_the_sentence)
 *     {
 *         CHECK(1 + 1 == 2);
 *     }
 *
 * A test binary takes words, which select the tests whose name or file contains one of them (without words: all). With -l it lists
 * these tests; -s SEED sets the seed; -j N runs N tests at once. A word that selects no test fails; with -a it does not, because it
 * may be for another binary. A test that draws random numbers uses test_random(), whose seed is printed when the test
 * fails. Tests with the longest time limits begin first. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

struct test {
    const char *name, *file;
    void (*run)(void);
    unsigned timeout_s;
    struct test *next;
    bool failed;
};

void test_register(struct test *t);

#define TEST_TIMEOUT(NAME, SECONDS)                                                                \
    static void test_##NAME(void);                                                                 \
    static struct test case_##NAME = {#NAME, __FILE__, test_##NAME, SECONDS, NULL, false};         \
    __attribute__((constructor)) static void register_##NAME(void)                                 \
    {                                                                                              \
        test_register(&case_##NAME);                                                               \
    }                                                                                              \
    static void test_##NAME(void)

#define TEST(NAME) TEST_TIMEOUT(NAME, 20)

/* Ends the test with a message unless the condition holds. */
#define CHECK(COND)                                                                                \
    do {                                                                                           \
        if (!(COND))                                                                               \
            test_fail(__FILE__, __LINE__, "%s", #COND);                                            \
    } while (0)

/* The same with another message. */
#define CHECK_MSG(COND, ...)                                                                       \
    do {                                                                                           \
        if (!(COND))                                                                               \
            test_fail(__FILE__, __LINE__, __VA_ARGS__);                                            \
    } while (0)

/* For a function that checks for its callers: a failure in CALL names this line, too. */
#define TEST_CALL(CALL) (test_called(__FILE__, __LINE__), CALL, test_called(NULL, 0))
void test_called(const char *file, int line);

/* Ends a test that cannot be run here: it counts as skipped, and the reason is printed. .ci/run allows some reasons. */
#define SKIP(...) test_skip(__VA_ARGS__)

/* Versions of sets in GOT are compared only where WANT has one, too. */
#define CHECK_STR(GOT, WANT) test_check_str(__FILE__, __LINE__, #GOT, GOT, WANT)

/* Two replies of different runs: versions of sets are not compared, in neither of them. */
#define CHECK_UNVERSIONED(A, B) test_check_unversioned(__FILE__, __LINE__, #A, A, B)

__attribute__((format(printf, 3, 4), noreturn)) void test_fail(const char *file, int line,
                                                               const char *format, ...);
__attribute__((format(printf, 1, 2), noreturn)) void test_skip(const char *format, ...);
void test_check_str(const char *file, int line, const char *what, const char *got,
                    const char *want);
void test_check_unversioned(const char *file, int line, const char *what, const char *a,
                            const char *b);

/* Takes ` version=N` of sets, which differs from run to run, out of text; returns its new length. */
size_t test_drop_versions(char *text);

/* Whether text contains `what: ` and the C library's words for an errno, which differ between libraries. */
bool test_names_error(const char *text, const char *what, int error);

/* Uniform 64-bit numbers, a double in [0, 1), and an integer below n. */
uint64_t test_random(void);
double test_uniform(void);
uint32_t test_below(uint32_t n);

/* The factor by which this machine may be slower than the limits of the tests assume: $TEST_SLOWNESS, an
 * integer, for instance under an emulator; otherwise 1. It multiplies every test's time-out. */
unsigned test_slowness(void);

/* Whether a sanitizer was compiled in: times and memory are then not those of the program. */
bool test_is_sanitized(void);

/* Out-of-memory injection: the n-th allocation from now on fails (n = 1: the next), and only that
 * one; 0: none fails. test_alloc_failed: whether one did. test_fail_alloc_from: it and all after
 * it. */
void test_fail_alloc(long n);
void test_fail_alloc_from(long n);
bool test_alloc_failed(void);

/* Guarded blocks, on or off: a block that is allocated while they are on ends where a page ends. To touch
 * the page behind it, or the block when it has been freed, ends the test. A block costs system calls
 * and address space, so this is for tests that need few. */
void test_guard_alloc(bool on);

/* The bytes that malloc has allocated and that are not freed yet; and the most by which they have exceeded
 * `before` since test_watch_alloc. */
size_t test_alloc_in_use(void);
void test_watch_alloc(void);
size_t test_alloc_most(size_t before);
