/* alloc.c - out-of-memory injection and guarded blocks: with -Wl,--wrap=malloc and friends, every
 * allocation of a test binary comes through here.
 *
 *      | size ...               | block        | rest |  no access  |      guarded: the rest, less than 16 bytes,
 *      page                                           page                 is checked when the block is freed */
#include "tests/test.h"

#include <errno.h>
#include <malloc.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *p);
void *__real_mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *p);
void *__wrap_mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset);

/* ---- out of memory ---- */

static atomic_long countdown;
static atomic_bool failed, for_good;

void test_fail_alloc(long n)
{
    failed = false;
    for_good = false;
    countdown = n;
}

void test_fail_alloc_from(long n)
{
    test_fail_alloc(n);
    for_good = true;
}

bool test_alloc_failed(void)
{
    return failed;
}

static bool is_next(void)
{
    if (failed && for_good)
        return true;
    if (countdown <= 0 || --countdown != 0)
        return false;
    failed = true;
    return true;
}

/* The C library itself, which a static program also wraps, relies on errno. */
static bool must_fail(void)
{
    bool fails = is_next();
    if (fails)
        errno = ENOMEM;
    return fails;
}

/* ---- guarded blocks ---- */

#define RANGE ((size_t)1 << 34) /* of addresses, which are used once */
enum { PAGE = 4096, REST = 0xA5 };

static atomic_bool guarding;
static char *range;
static atomic_size_t used;

void test_guard_alloc(bool on)
{
    if (range == NULL)
        range =
            __real_mmap(NULL, RANGE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    CHECK(range != MAP_FAILED);
    guarding = on;
}

static bool is_guarded(const void *p)
{
    return range != NULL && (const char *)p >= range && (const char *)p < range + RANGE;
}

/* The bytes of a block's pages: its size, the block, the rest. */
static size_t pages_of(size_t size)
{
    size_t whole = sizeof size + (size + 15) / 16 * 16;
    return (whole + PAGE - 1) / PAGE * PAGE;
}

static void *guarded_new(size_t size)
{
    size_t bytes = pages_of(size), at = atomic_fetch_add(&used, bytes + PAGE), rest = -size & 15;
    char *page = range + at;
    if (at > RANGE - bytes - PAGE || mprotect(page, bytes, PROT_READ | PROT_WRITE) != 0)
        return NULL;
    memcpy(page, &size, sizeof size);
    memset(page + bytes - rest, REST, rest);
    return page + bytes - rest - size;
}

/* The page in which the word before a block lies begins with the block's size. */
static size_t guarded_size(const char *p, char **page)
{
    size_t size;
    uintptr_t at = (uintptr_t)p - sizeof size;
    *page = (char *)(at - at % PAGE); /* NOLINT: the block was made there */
    memcpy(&size, *page, sizeof size);
    return size;
}

static void guarded_free(char *p)
{
    char *page;
    size_t size = guarded_size(p, &page), bytes = pages_of(size);
    for (const char *at = p + size; at < page + bytes; at++)
        CHECK_MSG((unsigned char)*at == REST, "byte %zu of a block of %zu was written",
                  (size_t)(at - p), size);
    mprotect(page, bytes, PROT_NONE);
    madvise(page, bytes, MADV_DONTNEED);
}

/* ---- bytes in use ---- */

static atomic_llong in_use, most;

void test_watch_alloc(void)
{
    most = atomic_load(&in_use);
}

size_t test_alloc_most(size_t before)
{
    long long bytes = atomic_load(&most);
    return bytes > (long long)before ? (size_t)bytes - before : 0;
}

size_t test_alloc_in_use(void)
{
    return (size_t)in_use;
}

/* A block that malloc has made; NULL: none. */
static void *count(void *p)
{
    if (p == NULL)
        return p;
    long long bytes = (long long)malloc_usable_size(p);
    long long now = atomic_fetch_add(&in_use, bytes) + bytes, known = atomic_load(&most);
    while (now > known && !atomic_compare_exchange_weak(&most, &known, now))
        continue;
    return p;
}

static void discount(void *p)
{
    if (p != NULL)
        in_use -= (long long)malloc_usable_size(p);
}

/* ---- the functions that the linker substitutes for malloc and friends ---- */

void *__wrap_malloc(size_t size)
{
    if (must_fail())
        return NULL;
    return guarding ? guarded_new(size) : count(__real_malloc(size));
}

void *__wrap_calloc(size_t n, size_t size)
{
    if (must_fail())
        return NULL;
    return guarding && n <= RANGE / (size + 1) ? guarded_new(n * size)
                                               : count(__real_calloc(n, size));
}

void *__wrap_realloc(void *p, size_t size)
{
    char *page;
    if (must_fail())
        return NULL;
    if (p == NULL && guarding)
        return guarded_new(size);
    if (!is_guarded(p)) {
        long long was = p == NULL ? 0 : (long long)malloc_usable_size(p);
        void *grown = __real_realloc(p, size);
        in_use -= grown == NULL ? 0 : was;
        return count(grown);
    }
    size_t before = guarded_size(p, &page);
    void *moved = guarding ? guarded_new(size) : count(__real_malloc(size));
    if (moved == NULL)
        return NULL;
    memcpy(moved, p, before < size ? before : size);
    guarded_free(p);
    return moved;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return must_fail() ? NULL : count(__real_aligned_alloc(alignment, size));
}

void __wrap_free(void *p)
{
    if (is_guarded(p)) {
        guarded_free(p);
        return;
    }
    discount(p);
    __real_free(p);
}

void *__wrap_mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
    return must_fail() ? MAP_FAILED : __real_mmap(at, size, protection, flags, fd, offset);
}
