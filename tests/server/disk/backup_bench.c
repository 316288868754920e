/* backup_bench.c - see backup_bench.h. */
#include "tests/server/disk/backup_bench.h"

#include "tests/faults/tree.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

const char *const backup_names[] = {"a", "b", "t", NULL};

const char backup_history[] = "CREATE a TOL 0.5\nADD a 0 0  0.25 0  4 0  4 0.25  0 4  4 4  9 9\n"
                              "DEL a 0 6\nADD t 0 0  4 0  4 4  0 4  2 2  2 2  7 7\nDEL t 6\n"
                              "TRIANGULATE t\nMOVE t 4 1 2\nADD b 1e-3 -7.25e20\n"
                              "LOAD b 3\n1 2\n3 4\n5 6\nTRIANGULATE a\nFSET t z 0 1.5 1 nan\n";

void start(struct bench *b, const char *const *more)
{
    const char *arguments[10] = {"--backup-dir", b->backups};
    for (size_t n = 2; more != NULL && *more != NULL; more++)
        arguments[n++] = *more;
    b->d = directory_daemon(&b->data, arguments);
}

void begin_on(struct bench *b, struct directory root, const char *backups)
{
    b->root = root;
    snprintf(b->data.path, sizeof b->data.path, "%.50s/data", root.path);
    snprintf(b->backups, sizeof b->backups, "%.50s/backups", backups);
}

void begin(struct bench *b, const char *const *more)
{
    struct directory root = directory_quick();
    begin_on(b, root, root.path);
    start(b, more);
}

void end(struct bench *b)
{
    daemon_stop(&b->d, SIGKILL);
    tree_remove(b->root.path);
}

struct directory backup_path(const struct bench *b, const char *name)
{
    struct directory dir;
    snprintf(dir.path, sizeof dir.path, "%.50s/%.12s", b->backups, name);
    return dir;
}

bool exists(const struct bench *b, const char *name)
{
    return access(backup_path(b, name).path, F_OK) == 0;
}

/* The reply to one request. */
const char *ask(const struct daemon *d, const char *request)
{
    int fd = daemon_connect(d);
    say(fd, request);
    const char *line = hear_line(fd);
    close(fd);
    return line;
}

void expect_reply(const struct daemon *d, const char *request, const char *want)
{
    const char *got = ask(d, request);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s: %s", request, got);
}

uint64_t number_in(const char *line, const char *key)
{
    const char *at = strstr(line, key);
    CHECK_MSG(at != NULL, "%s", line);
    return strtoull(at + strlen(key), NULL, 10);
}

void check_good(const struct directory *dir)
{
    char text[4000];
    CHECK_MSG(directory_run(dir, "--check", text, sizeof text) == 0, "%s", text);
}

/* A daemon on the backup has this state, and can go on. */
void check_restored(const struct bench *b, const char *name, const char *want)
{
    struct directory dir = backup_path(b, name);
    check_good(&dir);
    struct daemon d = directory_daemon(&dir, NULL);
    char *got = directory_state(&d, backup_names);
    CHECK_STR(got, want);
    free(got);
    carry_out(&d, "ADD new 8 8\nSNAPSHOT\n");
    daemon_stop(&d, SIGKILL);
}

void snapshot(const struct daemon *d, uint64_t number)
{
    carry_out(d, "SNAPSHOT\n");
    await_info(d, "snapshots", number);
}
