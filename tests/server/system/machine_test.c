/* machine_test.c - what the machine allows: descriptors, and memory limits of control groups. */
#include "server/system/machine.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <ftw.h>
#include <stdarg.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

TEST(soft_limit_of_descriptors_is_raised_to_the_hard_one)
{
    struct rlimit few, now;
    CHECK(getrlimit(RLIMIT_NOFILE, &few) == 0);
    few.rlim_cur = 60;
    few.rlim_max = few.rlim_max < 500 ? few.rlim_max : 500;
    CHECK(setrlimit(RLIMIT_NOFILE, &few) == 0);
    struct daemon d = daemon_start(NULL);
    CHECK(prlimit(d.pid, RLIMIT_NOFILE, NULL, &now) == 0);
    CHECK(now.rlim_cur == few.rlim_max && now.rlim_max == few.rlim_max);
    CHECK(daemon_info(&d, "max_clients") == few.rlim_max - 32);
    daemon_end(&d);
}

/* Writes the text to dir/name and creates its folders. */
__attribute__((format(printf, 3, 4))) static void put(const struct directory *dir, const char *name,
                                                      const char *format, ...)
{
    char path[400], text[400];
    va_list ap;
    snprintf(path, sizeof path, "%s/%s", dir->path, name);
    for (char *at = path + strlen(dir->path) + 1; (at = strchr(at, '/')) != NULL; at++) {
        *at = '\0';
        mkdir(path, 0700);
        *at = '/';
    }
    va_start(ap, format);
    vsnprintf(text, sizeof text, format, ap);
    va_end(ap);
    file_write(path, text, strlen(text));
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    (void)st, (void)kind, (void)at;
    return remove(path);
}

/* directory_remove with all folders. */
static void remove_all(const struct directory *dir)
{
    CHECK(nftw(dir->path, remove_one, 8, FTW_DEPTH | FTW_PHYS) == 0);
}

static size_t limit_in(const struct directory *dir)
{
    char groups[100], mount[100];
    snprintf(groups, sizeof groups, "%s/groups", dir->path);
    snprintf(mount, sizeof mount, "%s/mount", dir->path);
    return machine_group_memory(groups, mount);
}

TEST(memory_limit_of_a_parent_group_applies)
{
    struct directory dir = directory_new();
    CHECK(limit_in(&dir) == SIZE_MAX); /* no control groups at all */
    put(&dir, "groups", "0::/our.slice/daemons.slice/delaunayd.service\n");
    CHECK(limit_in(&dir) == SIZE_MAX);
    put(&dir, "mount/our.slice/daemons.slice/delaunayd.service/memory.max", "max\n");
    put(&dir, "mount/our.slice/memory.max", "5000000000\n");
    CHECK(limit_in(&dir) == 5000000000);
    put(&dir, "mount/our.slice/daemons.slice/memory.high", "4000000000\n");
    CHECK(limit_in(&dir) == 4000000000);
    put(&dir, "mount/our.slice/daemons.slice/delaunayd.service/memory.max", "3000000000\n");
    CHECK(limit_in(&dir) == 3000000000);
    put(&dir, "mount/other.slice/memory.max", "1\n");
    put(&dir, "memory.max", "1\n"); /* beyond the mount */
    CHECK(limit_in(&dir) == 3000000000);
    remove_all(&dir);
}

TEST(memory_limit_of_a_group_of_version_1_applies)
{
    struct directory dir = directory_new();
    put(&dir, "groups",
        "12:cpu,cpuacct:/elsewhere\n11:memory_of_another:/elsewhere\n4:hugetlb,memory:/a/b\n0::/"
        "\n");
    put(&dir, "mount/memory/elsewhere/memory.limit_in_bytes", "1\n");
    put(&dir, "mount/memory/a/b/memory.limit_in_bytes", "9223372036854771712\n");
    CHECK(limit_in(&dir) == 9223372036854771712u);
    put(&dir, "mount/memory/a/memory.limit_in_bytes", "6000000000\n");
    CHECK(limit_in(&dir) == 6000000000);
    remove_all(&dir);
}

TEST(memory_limit_applies_in_a_container_that_sees_a_part_of_the_tree)
{
    struct directory dir = directory_new();
    put(&dir, "groups", "4:memory:/docker/0123\n0::/docker/0123\n");
    put(&dir, "mount/memory/memory.limit_in_bytes", "2000000000\n");
    CHECK(limit_in(&dir) == 2000000000);
    put(&dir, "groups", "0::/../../x\n");
    put(&dir, "mount/memory.max", "1000000000\n");
    CHECK(limit_in(&dir) == 1000000000);
    put(&dir, "groups", "0::/../x\n");
    put(&dir, "x/memory.max", "1\n"); /* beyond the mount */
    CHECK(limit_in(&dir) == 1000000000);
    remove_all(&dir);
}
