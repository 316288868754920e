/* mremap_shim.c - see mremap_shim.h. */
#include "tests/core/memory/mremap_shim.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#include "tests/test.h"

void *__real_mremap(void *old, size_t old_size, size_t new_size, int flags, ...);
void *__wrap_mremap(void *old, size_t old_size, size_t new_size, int flags, ...);
void *__real_mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset);

enum { FOREIGN = 64, PAGE = 4096, MARK = 0x5a };

static bool one_mapping, no_dontunmap;
static long countdown;
static int failures;
static char *foreign[FOREIGN]; /* a page each that the other thread has mapped */
static int foreigns;

static bool is_one_mapping(const char *start, size_t bytes)
{
    char line[512];
    bool one = false;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps != NULL && fgets(line, sizeof line, maps) != NULL) {
        unsigned long from, to;
        if (sscanf(line, "%lx-%lx ", &from, &to) == 2 && from <= (uintptr_t)start &&
            (uintptr_t)start < to)
            one = (uintptr_t)start + bytes <= to;
    }
    if (maps != NULL)
        fclose(maps);
    return one;
}

/* The target has been unmapped, and another thread needs a page. */
static void *fail_late(char *target, size_t size, int error)
{
    munmap(target, size);
    void *page = __real_mmap(target, PAGE, PROT_READ | PROT_WRITE,
                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    CHECK(page == target && foreigns < FOREIGN);
    foreign[foreigns++] = memset(page, MARK, PAGE);
    failures++;
    errno = error;
    return MAP_FAILED;
}

void *__wrap_mremap(void *old, size_t old_size, size_t new_size, int flags, ...)
{
    va_list more;
    va_start(more, flags);
    char *target = flags & MREMAP_FIXED ? va_arg(more, char *) : NULL;
    va_end(more);
    if (no_dontunmap && (flags & MREMAP_DONTUNMAP)) {
        errno = EINVAL;
        return MAP_FAILED;
    }
    if (target == NULL)
        return __real_mremap(old, old_size, new_size, flags);
    if (one_mapping && !is_one_mapping(old, old_size))
        return fail_late(target, new_size, EFAULT);
    if (countdown > 0 && --countdown == 0)
        return fail_late(target, new_size, ENOMEM);
    return __real_mremap(old, old_size, new_size, flags, target);
}

void remap_one_mapping_only(void)
{
    one_mapping = true;
}

void remap_without_dontunmap(void)
{
    no_dontunmap = true;
}

void remap_refuse(long n)
{
    countdown = n;
}

int remap_end(void)
{
    bool whole = true;
    for (int i = 0; i < foreigns; i++) {
        unsigned char here;
        whole = whole && mincore(foreign[i], PAGE, &here) == 0;
        for (int k = 0; whole && k < PAGE; k++)
            whole = foreign[i][k] == MARK;
        munmap(foreign[i], PAGE);
    }
    int failed = failures;
    one_mapping = no_dontunmap = false;
    foreigns = failures = 0;
    countdown = 0;
    return whole ? failed : -1;
}
