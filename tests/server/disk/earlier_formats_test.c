/* earlier_formats_test.c - files that earlier releases wrote can be read. tests/data/README.md describes how
 * each directory was created. */
#include "proto/records/record.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <dirent.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const char *const names[] = {"a", "b", "t", "empty", NULL};

/* Copies the files below `from` into a directory of its own, which a daemon may change. */
static struct directory copy_of(const char *from)
{
    struct directory dir = directory_new();
    struct dirent *e;
    DIR *all = opendir(from);
    CHECK_MSG(all != NULL, "there is no %s", from);
    while ((e = readdir(all)) != NULL) {
        char path[300], to[300];
        size_t n;
        if (e->d_name[0] == '.' || strcmp(e->d_name, "state") == 0)
            continue;
        snprintf(path, sizeof path, "%s/%.60s", from, e->d_name);
        snprintf(to, sizeof to, "%s/%.60s", dir.path, e->d_name);
        char *bytes = file_read(path, &n);
        file_write(to, bytes, n);
        free(bytes);
    }
    closedir(all);
    return dir;
}

/* The version of the set t. */
static uint64_t version_of(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "STAT t\n");
    const char *at = strstr(hear_line(fd), " version=");
    close(fd);
    CHECK(at != NULL);
    return strtoull(at + strlen(" version="), NULL, 10);
}

/* A snapshot, a log that was closed properly, and one of a daemon that was killed. */
TEST(directory_of_version_1_is_read_and_goes_on)
{
    size_t n;
    char text[4000];
    struct directory dir = copy_of("tests/data/version-1");
    char *want = file_read("tests/data/version-1/state", &n);
    want[n] = '\0';
    uint64_t version = 0;
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    for (int i = 0; i < 2; i++) { /* its own files, then those that this release has written */
        struct daemon d = directory_daemon(&dir, NULL);
        char *got = directory_state(&d, names);
        CHECK_STR(got, want);
        free(got);
        /* Its files have no versions of sets; this release has written the one that the set got. */
        CHECK(version_of(&d) > 0 && (i == 0 || version_of(&d) == version));
        version = version_of(&d);
        carry_out(&d, "SNAPSHOT\n");
        await_info(&d, "snapshots", 1);
        daemon_stop(&d, SIGKILL);
    }
    struct daemon d = directory_daemon(&dir, NULL);
    converse(&d, "ADD a 8 8\nADD t 8 8\nADD gone 8 8\n",
             "OK 0 first=7 added=1 coincident=0\nOK 0 first=9 added=1 coincident=0\n"
             "OK 0 first=0 added=1 coincident=0\n");
    daemon_stop(&d, SIGKILL);
    free(want);
    directory_remove(&dir);
}

/* The same with fields: values in a snapshot, and in all kinds of records of a log. `version` is that of the set t;
 * 0: the files have none. */
static void check_fields(const char *from, uint64_t version)
{
    static const char questions[] =
        "POINTS a\nFIELDS a\nFIELDS b\nPOINTS b FIELDS z\nFIELDS t\nPOINTS t FIELDS new,z\n"
        "FIELDS u\nPOINTS u FIELDS none,y\nFIELDS empty\n";
    size_t n;
    char text[4000];
    struct directory dir = copy_of(from);
    snprintf(text, sizeof text, "%s/state", from);
    char *want = file_read(text, &n);
    want[n] = '\0';
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    for (int i = 0; i < 2; i++) { /* its own files, then those that this release has written */
        struct daemon d = directory_daemon(&dir, NULL);
        converse(&d, questions, want);
        CHECK(version == 0 || version_of(&d) == version);
        carry_out(&d, "SNAPSHOT\n");
        await_info(&d, "snapshots", 1);
        daemon_stop(&d, SIGKILL);
    }
    free(want);
    directory_remove(&dir);
}

TEST(directory_of_version_2_is_read_with_its_fields)
{
    check_fields("tests/data/version-2", 0);
}

TEST(directory_of_version_3_is_read_with_the_versions_of_its_sets)
{
    check_fields("tests/data/version-3", 3765204556972094);
}

TEST(directory_of_version_4_is_read_with_its_history)
{
    check_fields("tests/data/version-4", 3765253728895038);
}

/* The same with constraints, in a snapshot and in all kinds of records. */
TEST(directory_of_version_5_is_read_with_its_constraints)
{
    static const char questions[] = "POINTS t FIELDS z\nCONSTRAINTS t\nCONSTRAINTS a\n"
                                    "CONSTRAINTS b\nEDGES t CONSTRAINED\nLISTS t\nCHECK t\n"
                                    "CONSTRAINTS empty\nDIGEST t\n";
    size_t n;
    char text[4000];
    struct directory dir = copy_of("tests/data/version-5");
    char *want = file_read("tests/data/version-5/state", &n);
    want[n] = '\0';
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    for (int i = 0; i < 2; i++) { /* its own files, then those that this release has written */
        struct daemon d = directory_daemon(&dir, NULL);
        converse(&d, questions, want);
        carry_out(&d, "SNAPSHOT\n");
        await_info(&d, "snapshots", 1);
        daemon_stop(&d, SIGKILL);
    }
    free(want);
    directory_remove(&dir);
}

/* The version in the header of the first file of that kind; 0: there is no such file. */
static unsigned written_version(unsigned of, const char *prefix)
{
    char path[128];
    struct segment header;
    struct directory dir;
    size_t n;
    snprintf(dir.path, sizeof dir.path, "tests/data/version-%u", of);
    if (access(dir.path, F_OK) != 0 || !directory_file(&dir, prefix, 0, path))
        return 0;
    char *bytes = file_read(path, &n);
    CHECK(segment_read(bytes, n, &header) > 0);
    free(bytes);
    return header.version;
}

/* CONTRIBUTING.md: a new version comes with a directory that has its files, and with a test above. A snapshot may need no record that
 * is new. */
TEST(every_version_of_the_format_so_far_has_its_files)
{
    for (unsigned version = 1; version <= RECORD_VERSION; version++) {
        unsigned log = written_version(version, "log."),
                 snapshot = written_version(version, "snapshot.");
        CHECK_MSG(log == version && snapshot > 0 && snapshot <= version,
                  "tests/data/version-%u: its first log has version %u, its first snapshot %u (0: "
                  "there is none)",
                  version, log, snapshot);
    }
}

/* The version of the last file of that kind. */
static unsigned last_version(const struct directory *dir, const char *prefix)
{
    char path[128], next[128];
    struct segment header;
    size_t n;
    CHECK(directory_file(dir, prefix, 0, path));
    for (unsigned i = 1; directory_file(dir, prefix, i, next); i++)
        strcpy(path, next);
    char *bytes = file_read(path, &n);
    CHECK(segment_read(bytes, n, &header) > 0);
    free(bytes);
    return header.version;
}

TEST(only_files_with_constraints_have_version_5)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, "ADD t 0 0 4 0 0 4\nMOVE t 0 1 1\nSNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    CHECK(last_version(&dir, "log.") == 4 && last_version(&dir, "snapshot.") == 4);
    carry_out(&d, "ADD t 5 5\nCONSTRAIN t 0 1\nDEL t 3\n");
    CHECK(last_version(&dir, "log.") == 5 && last_version(&dir, "snapshot.") == 4);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL); /* from segments of both versions */
    converse(&d, "CONSTRAINTS t\nPOINTS t\n", "OK 1\n0 1 line 0\nOK 3\n0 1 1\n1 4 0\n2 0 4\n");
    CHECK(last_version(&dir, "log.") == 4);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    CHECK(last_version(&dir, "log.") == 4 && last_version(&dir, "snapshot.") == 5);
    carry_out(&d, "RELEASE t 0 1\nSNAPSHOT\n");
    await_info(&d, "snapshots", 2);
    CHECK(last_version(&dir, "snapshot.") == 4);
    daemon_end(&d);
    directory_remove(&dir);
}

/* An upgrade: a leader on files of every version so far, and a follower without any. */
TEST(follower_of_a_leader_with_files_of_any_version_has_equal_sets)
{
    static const char digests[] = "DIGEST a\nDIGEST b\nDIGEST t\nDIGEST empty\nSETS\nQUIT\n";
    for (unsigned version = 1; version <= RECORD_VERSION; version++) {
        char from[40], address[40];
        size_t n;
        snprintf(from, sizeof from, "tests/data/version-%u", version);
        struct directory dirs[2] = {copy_of(from), directory_new()};
        struct daemon leader = directory_daemon(&dirs[0], NULL);
        snprintf(address, sizeof address, "127.0.0.1:%s", leader.port_text);
        const char *const follow[] = {"--follow", address, NULL};
        struct daemon follower = directory_daemon(&dirs[1], follow);
        int fd = daemon_connect(&leader);
        say(fd, "ADD b 8 8\nWAIT 1 60\n");
        CHECK(strncmp(hear_line(fd), "OK 0 first=", 11) == 0);
        CHECK_STR(hear_line(fd), "OK 0 followers=1");
        say(fd, digests);
        char *want = hear_all(fd, &n);
        close(fd);
        CHECK_MSG(strstr(want, "ERR") == NULL, "%s", want);
        converse(&follower, digests, want);
        daemon_stop(&leader, SIGKILL);
        carry_out(&follower, "FOLLOW NONE\nADD b 9 9\n");
        daemon_end(&follower);
        directory_remove(&dirs[0]);
        directory_remove(&dirs[1]);
        free(want);
    }
}
