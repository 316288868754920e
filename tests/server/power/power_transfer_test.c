/* power_transfer_test.c - power cuts while a follower receives a snapshot that replaces its whole state. After each cut
 * the directory has the old state or the new one, and the new one if the follower had acknowledged it. */
#include "server/disk/aside.h"
#include "server/disk/recover.h"
#include "tests/faults/power_cut_random.h"
#include "tests/server/follow/false_leader.h"
#include "tests/server/power/power_disk.h"
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH_BYTES = 100, OLD = 11, TRANSFERRED = 50, NEW = 51 };

struct bench {
    struct directory dir;
    char root[PATH_BYTES], data[PATH_BYTES], ops[PATH_BYTES];
    struct false_leader leader;
};

/* A follower on that disk; NULL: a good one. */
static pid_t start(const struct bench *b, const struct power_disk *disk)
{
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid > 0)
        return pid;
    dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
    if (disk != NULL)
        power_disk_load(disk);
    execl(getenv("DELAUNAYD"), "delaunayd", "--data", b->data, "--port", "0", "--log-level",
          "error", "--follow", b->leader.address, (char *)NULL);
    _exit(127);
}

/* It gets a snapshot of changes up to lsn, and one more, which creates a set; then it is killed. */
static void live(struct bench *b, const struct power_disk *disk, uint64_t lsn, const char *set)
{
    char want[40];
    int status;
    pid_t pid = start(b, disk);
    false_leader_accept(&b->leader, "no");
    false_leader_snapshot(&b->leader, lsn);
    false_leader_record(
        &b->leader, (struct record){.type = RECORD_CREATE, .name = set, .name_len = strlen(set)});
    CHECK(false_leader_send(&b->leader));
    snprintf(want, sizeof want, "ACK %" PRIu64 " ", lsn + 1);
    while (strncmp(hear_line(b->leader.fd), want, strlen(want)) != 0)
        ;
    kill(pid, SIGKILL);
    CHECK(waitpid(pid, &status, 0) == pid);
}

static bool has_set(struct recovery *r, const char *name)
{
    struct word word = {name, strlen(name)};
    return registry_find(&r->replay.sets, &word) != NULL;
}

/* Returns the lsn of the last change that a start finds; the sets must be those of this lsn. */
static uint64_t state_of(const struct bench *b, const struct random_fate *fate, size_t cut)
{
    struct datadir dir;
    struct recovery *r = calloc(1, sizeof *r);
    CHECK(r != NULL && datadir_open(&dir, b->data, false));
    CHECK_MSG(aside_finish(&dir), "cut after operation %zu; lost: %s", cut, fate->recipe);
    recovery_init(r, &dir);
    recovery_run(r);
    uint64_t last = r->last;
    bool good = r->result == RECOVERY_OK && (last == OLD || last == TRANSFERRED || last == NEW) &&
                r->replay.sets.sets == (last != TRANSFERRED) &&
                has_set(r, "old") == (last == OLD) && has_set(r, "new") == (last == NEW);
    CHECK_MSG(good, "cut after operation %zu: up to %" PRIu64 ", %zu sets, %s; lost: %s", cut, last,
              r->replay.sets.sets, r->why, fate->recipe);
    recovery_clear(r);
    free(r);
    datadir_close(&dir);
    return last;
}

TEST_TIMEOUT(power_cut_during_a_transfer_leaves_the_old_state_or_the_new_one, 300)
{
    enum { FATES = 12 };
    struct bench b = {.dir = directory_quick(), .leader = false_leader_new()};
    bool seen[NEW + 1] = {false};
    snprintf(b.root, PATH_BYTES, "%s/root", b.dir.path);
    snprintf(b.data, PATH_BYTES, "%s/root/data", b.dir.path);
    snprintf(b.ops, PATH_BYTES, "%s/ops", b.dir.path);
    CHECK(mkdir(b.root, 0700) == 0);
    live(&b, NULL, OLD - 1, "old");
    struct tree before = tree_read(b.root);
    live(&b, &(struct power_disk){.root = b.root, .ops = b.ops}, TRANSFERRED, "new");
    struct power_log log = power_log_read(b.ops);
    struct power_cut *crash = power_cut_new(&before, &log);
    for (size_t cut = 0; cut <= log.n; cut++) {
        for (int i = 0; i < FATES; i++) {
            struct random_fate fate;
            random_fate_init(&fate, test_random(), crash, &log);
            struct tree left = power_cut_state(crash, cut, &fate.fate);
            tree_write(&left, b.root);
            uint64_t state = state_of(&b, &fate, cut);
            CHECK_MSG(cut < log.n || state == NEW, "up to %" PRIu64 "; lost: %s", state,
                      fate.recipe);
            CHECK(state_of(&b, &fate, cut) == state); /* the next start */
            seen[state] = true;
            tree_free(&left);
        }
    }
    CHECK(seen[OLD] && seen[TRANSFERRED] && seen[NEW]);
    power_cut_free(crash);
    power_log_free(&log);
    tree_free(&before);
    false_leader_end(&b.leader);
    tree_remove(b.dir.path);
}
