/* machine.c - see machine.h. [Linux: Documentation/admin-guide/cgroup-v2.rst, cgroup-v1/memory.rst;
 * cgroups(7)] */
#include "server/system/machine.h"

#include <fcntl.h>
#include <limits.h>
#include <malloc.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { PATH_ROOM = 4200 };

unsigned machine_processors(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : (unsigned)n;
}

void machine_open_standard(void)
{
    int fd;
    do
        fd = open("/dev/null", O_RDWR); /* gets the lowest number that is free */
    while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd >= 0)
        close(fd);
}

void machine_raise_descriptors(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max)
        return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

unsigned machine_descriptors(void)
{
    struct rlimit limit;
    bool few = getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < UINT_MAX;
    return few ? (unsigned)limit.rlim_cur : UINT_MAX;
}

/* ---- memory ---- */

/* Otherwise glibc takes larger and larger blocks from its heaps, where up to 170 MB of freed ones stay resident that the budget
 * counts as free. Mappings of their own cost up to a third more time in large replies, so this is for small limits. */
void machine_return_blocks(size_t limit)
{
    if (limit >= (size_t)1 << 30)
        return;
#ifdef __GLIBC__
    enum { BLOCK = 32 * 1024, HEAP_END = 512 * 1024 };
    mallopt(M_MMAP_THRESHOLD, BLOCK);
    mallopt(M_TRIM_THRESHOLD, HEAP_END);
#endif
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The limit in a file of a control group; SIZE_MAX for `max`, or if there is no such file. */
static size_t read_limit(const char *directory, const char *name)
{
    char path[PATH_ROOM + 64];
    unsigned long long v;
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *f = fopen(path, "re");
    if (f == NULL)
        return SIZE_MAX;
    bool is_number = fscanf(f, "%llu", &v) == 1;
    fclose(f);
    return is_number && v < SIZE_MAX ? (size_t)v : SIZE_MAX;
}

/* The lowest limit of the group and all its parents. The limit of a parent, such as a systemd slice,
 * applies to its children although their own files do not show it. In a container the mount may
 * contain only a part of the tree: then the path does not exist, and the mount itself has the limit. */
static size_t least_of_parents(const char *mount, const char *group)
{
    char directory[PATH_ROOM];
    size_t limit = SIZE_MAX, root = strlen(mount);
    int n = snprintf(directory, sizeof directory, "%s%s", mount, group);
    if (n < 0 || (size_t)n >= sizeof directory || strstr(group, "..") != NULL)
        directory[root] = '\0';
    for (char *end; strlen(directory) >= root; *end = '\0') {
        limit = least(limit, read_limit(directory, "memory.max"));
        limit = least(limit, read_limit(directory, "memory.high"));
        limit = least(limit, read_limit(directory, "memory.limit_in_bytes"));
        end = strrchr(directory, '/');
        if (end == NULL || end < directory + root)
            break;
    }
    return limit;
}

/* Whether the comma-separated list of controllers includes memory. */
static bool has_memory(const char *controllers, size_t len)
{
    static const char memory[] = "memory";
    for (const char *at = controllers, *end = controllers + len; at < end;) {
        size_t n = strcspn(at, ",:");
        if (n == sizeof memory - 1 && memcmp(at, memory, n) == 0)
            return true;
        at += n + 1;
    }
    return false;
}

/* A line is `number:controllers:path`; version 2 has the number 0 and no controllers. */
static size_t limit_of_line(char *line, const char *mount)
{
    char v1[PATH_ROOM];
    line[strcspn(line, "\n")] = '\0';
    const char *controllers = strchr(line, ':');
    const char *path = controllers != NULL ? strchr(controllers + 1, ':') : NULL;
    if (path == NULL)
        return SIZE_MAX;
    size_t len = (size_t)(path - controllers - 1);
    if (len == 0)
        return least_of_parents(mount, path + 1);
    if (!has_memory(controllers + 1, len))
        return SIZE_MAX;
    snprintf(v1, sizeof v1, "%s/memory", mount);
    return least_of_parents(v1, path + 1);
}

size_t machine_group_memory(const char *groups, const char *mount)
{
    char line[PATH_ROOM];
    size_t limit = SIZE_MAX;
    FILE *f = fopen(groups, "re");
    while (f != NULL && fgets(line, sizeof line, f) != NULL)
        limit = least(limit, limit_of_line(line, mount));
    if (f != NULL)
        fclose(f);
    return limit;
}

size_t machine_memory(void)
{
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    size_t all = pages > 0 && page > 0 ? (size_t)pages * (size_t)page : (size_t)1 << 30;
    return least(all, machine_group_memory("/proc/self/cgroup", "/sys/fs/cgroup"));
}

size_t machine_resident(void)
{
    unsigned long long size, pages = 0;
    FILE *statm = fopen("/proc/self/statm", "re");
    if (statm == NULL)
        return 0;
    if (fscanf(statm, "%llu %llu", &size, &pages) != 2)
        pages = 0;
    fclose(statm);
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}
