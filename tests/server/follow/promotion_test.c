/* promotion_test.c - which of two daemons accepts changes: after promotions, restarts, and restored backups. */
#include "server/follow/announce.h"

#include "tests/faults/tree.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char newer[] = "ERR READONLY there is a newer history";

/* A leader and its follower, which have the same sets. */
struct pair {
    struct node l, f;
    char flag[32]; /* --follow of the follower */
};

static struct pair begin(void)
{
    struct pair p = {.l = node_new(NULL)};
    snprintf(p.flag, sizeof p.flag, "127.0.0.1:%u", p.l.d.port);
    p.f = node_follower_of(&p.l);
    carry_out(&p.l.d, "ADD a 0 0 1 0\n");
    node_expect_same(&p.l, &p.f);
    return p;
}

static void end(struct pair *p)
{
    node_end(&p->l);
    node_end(&p->f);
}

static void kill_node(struct node *n)
{
    daemon_stop(&n->d, SIGKILL);
}

/* ---- former leaders ---- */

/* A promoted follower tries to inform it once a second. */
TEST_TIMEOUT(leader_that_starts_is_not_settled_until_a_promoted_follower_would_have_informed_it, 60)
{
    struct pair p = begin();
    node_await(&p.l, "settled", "1");
    CHECK(node_is(&p.l, "generation", "1") && node_is(&p.f, "generation", "1"));
    CHECK(node_is(&p.f, "settled", "0"));
    kill_node(&p.l);
    carry_out(&p.f.d, "FOLLOW NONE\n");
    CHECK(node_is(&p.f, "settled", "1") && node_is(&p.f, "generation", "2"));
    node_start(&p.l, NULL);
    for (unsigned i = 0; i < node_tries() && !node_is(&p.l, "role", "fenced"); i++) {
        CHECK(node_is(&p.l, "settled", "0"));
        pause_ms(10);
    }
    CHECK(node_is(&p.l, "role", "fenced") && node_is(&p.l, "settled", "0"));
    kill_node(&p.f);
    node_start(&p.f, NULL);
    CHECK(node_is(&p.f, "role", "leader") && node_is(&p.f, "settled", "0"));
    node_await(&p.f, "settled", "1");
    end(&p);
}

TEST_TIMEOUT(former_leader_is_informed_although_the_new_one_has_restarted_before_it_is_back, 60)
{
    struct pair p = begin();
    kill_node(&p.l);
    carry_out(&p.f.d, "FOLLOW NONE\nADD a 2 2\n");
    for (int i = 0; i < 2; i++) {
        CHECK(node_is(&p.f, "uninformed_leader", p.flag));
        kill_node(&p.f);
        node_start(&p.f, i == 0 ? (const char *const[]){"--follow", p.flag, NULL} : NULL);
        CHECK(node_is(&p.f, "role", "leader"));
    }
    node_start(&p.l, NULL);
    node_await(&p.l, "role", "fenced");
    node_expect(&p.l, "ADD a 3 3", newer);
    node_await(&p.f, "uninformed_leader", "");
    kill_node(&p.f);
    node_start(&p.f, NULL);
    CHECK(node_is(&p.f, "uninformed_leader", ""));
    carry_out(&p.f.d, "ADD a 3 3\n");
    end(&p);
}

/* A leader that has been replaced twice hears of it from the latest leader, and informs the one between. */
TEST_TIMEOUT(promoted_daemon_that_meets_a_newer_history_while_it_informs_refuses_changes, 60)
{
    struct pair p = begin();
    struct node g = node_follower_of(&p.l);
    node_expect_same(&p.l, &g);
    kill_node(&p.l);
    carry_out(&p.f.d, "FOLLOW NONE\nADD b 1 1\n"); /* it cannot inform p.l */
    kill_node(&p.f);
    carry_out(&g.d, "FOLLOW NONE\nADD c 1 1\n");
    node_start(&p.l, NULL);
    node_await(&p.l, "role", "fenced");
    node_await(&g, "uninformed_leader", "");
    carry_out(&p.l.d, "FOLLOW NONE\nADD c 1 1\n"); /* a third generation */
    node_start(&p.f, NULL);
    node_await(&p.f, "role", "fenced");
    node_expect(&p.f, "ADD b 3 3", newer);
    node_end(&g);
    end(&p);
}

TEST(answer_of_a_former_leader_is_final_when_it_refuses_changes_or_has_another_history)
{
    static const struct {
        const char *line;
        enum announced want;
    } rows[] = {{"ERR READONLY there is a newer history aa.3.b: FOLLOW its leader", ANNOUNCE_HEARD},
                {"ERR READONLY leader=10.0.0.1:6374", ANNOUNCE_HEARD},
                {"ERR LOADING the data directory is being read; try again", ANNOUNCE_TRYING},
                {"ERR DENIED your token is for reading only", ANNOUNCE_TRYING},
                {"ERR IO there is no data directory (--data)", ANNOUNCE_TRYING},
                {"OK 0", ANNOUNCE_TRYING},
                {"HTTP/1.1 400 Bad Request", ANNOUNCE_TRYING},
                {"", ANNOUNCE_TRYING},
                {"OK 0 history=aa.2.b lsn=9 continues=differs", ANNOUNCE_TRYING},
                {"OK 0 history=aa.3.b lsn=9 continues=differs", ANNOUNCE_HEARD},
                {"OK 0 history=aa.3.c lsn=9 continues=differs", ANNOUNCE_HEARD},
                {"OK 0 history=ab.9.c lsn=9 continues=differs", ANNOUNCE_HEARD},
                {"OK 0 history=aa.4.c lsn=9 continues=differs", ANNOUNCE_NEWER}};
    struct history own = {.origin = 0xaa, .generation = 3, .nonce = 0xb}, theirs;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        CHECK_MSG(announce_judge(rows[i].line, &own, &theirs) == rows[i].want, "%s", rows[i].line);
    CHECK(theirs.generation == 4 && theirs.nonce == 0xc);
}

/* ---- two leaders ---- */

/* Two followers are promoted, and each has clients. */
TEST_TIMEOUT(two_leaders_accept_changes_and_refuse_to_follow_each_other_without_confirm, 60)
{
    struct pair p = begin();
    struct node g = node_follower_of(&p.l);
    node_expect_same(&p.l, &g);
    carry_out(&p.f.d, "FOLLOW NONE\nADD a 2 2\n");
    carry_out(&g.d, "FOLLOW NONE\nADD a 3 3\nADD b 1 1\n");
    node_await(&p.l, "role", "fenced");
    node_expect(&p.l, "ADD a 3 3", newer);
    node_await(&p.f, "uninformed_leader", "");
    node_await(&g, "uninformed_leader", "");
    CHECK(node_is(&p.f, "role", "leader") && node_is(&g, "role", "leader"));
    node_follow(&p.f, &g, "");
    node_await(&p.f, "link", "refused");
    node_expect(&p.f, "STAT b", "ERR NOSET");
    carry_out(&g.d, "ADD b 2 2\n");
    node_follow(&p.f, &g, " CONFIRM");
    node_expect_same(&g, &p.f);
    node_follow(&p.l, &g, ""); /* it has no changes that the new leader lacks */
    node_expect_same(&g, &p.l);
    node_end(&g);
    end(&p);
}

/* ---- --follow ---- */

TEST_TIMEOUT(daemon_stays_what_a_command_has_made_it_although_its_unit_has_the_flag, 60)
{
    struct pair p = begin();
    const char *const flags[] = {"--follow", p.flag, NULL};
    kill_node(&p.f);
    node_start(&p.f, flags);
    node_expect_same(&p.l, &p.f);
    carry_out(&p.f.d, "FOLLOW NONE\nADD a 2 2\n");
    node_await(&p.l, "role", "fenced");
    node_await(&p.f, "uninformed_leader", "");
    for (int i = 0; i < 2; i++) {
        kill_node(&p.f);
        node_start(&p.f, flags);
        CHECK(node_is(&p.f, "role", "leader"));
        carry_out(&p.f.d, "ADD a 3 3\n");
    }
    node_follow(&p.l, &p.f, "");
    node_expect_same(&p.f, &p.l);
    kill_node(&p.f); /* the flag of another daemon is a decision */
    char other[32];
    snprintf(other, sizeof other, "127.0.0.2:%u", p.l.d.port);
    node_start(&p.f, (const char *const[]){"--follow", other, NULL});
    CHECK(node_is(&p.f, "role", "follower") && node_is(&p.f, "leader", other));
    end(&p);
}

TEST_TIMEOUT(follower_that_a_command_has_given_another_leader_stays_with_it, 60)
{
    struct pair p = begin();
    struct node g = node_new(NULL);
    node_follow(&p.f, &g, " CONFIRM");
    node_expect_same(&g, &p.f);
    kill_node(&p.f);
    node_start(&p.f, (const char *const[]){"--follow", p.flag, NULL});
    carry_out(&g.d, "ADD b 1 1\n");
    node_expect_same(&g, &p.f);
    node_end(&g);
    end(&p);
}

TEST_TIMEOUT(follower_of_a_follower_is_told_whom_to_follow, 60)
{
    struct pair p = begin();
    struct node g = node_follower_of(&p.f);
    char why[FACT], want[FACT];
    snprintf(want, sizeof want, "it is a follower itself: FOLLOW its leader %s", p.flag);
    node_await(&g, "link_error", want);
    node_follow(&g, &p.l, "");
    node_expect_same(&p.l, &g);
    node_fact(&g, "link_error", why);
    CHECK_STR(why, "");
    node_end(&g);
    end(&p);
}

/* ---- restored backups ---- */

/* The backup has the history of its original, and changes that the original does not have. */
TEST_TIMEOUT(restored_backup_with_changes_of_its_own_does_not_give_them_up_unasked, 60)
{
    struct directory backups = directory_quick();
    struct node l =
        node_new((const char *const[]){"--keep-log", "1", "--backup-dir", backups.path, NULL});
    struct node r = {.dir = directory_quick()};
    char backup[200], history[FACT], why[FACT];
    carry_out(&l.d, "ADD a 0 0 1 0\nBACKUP one\n");
    snprintf(backup, sizeof backup, "%s/one", backups.path);
    tree_remove(r.dir.path);
    CHECK(rename(backup, r.dir.path) == 0);
    strcpy(r.d.port_text, "0");
    node_start(&r, NULL);
    node_fact(&l, "history", history);
    CHECK(node_is(&r, "history", history));
    carry_out(&r.d, "ADD b 7 7\n");
    carry_out(&l.d, "ADD a 1 1\nADD a 2 2\nADD a 3 3\n");
    node_follow(&r, &l, "");
    node_await(&r, "link", "refused");
    node_fact(&r, "link_error", why);
    CHECK_MSG(strstr(why, "other changes up to") != NULL, "%s", why);
    daemon_stop(&r.d, SIGTERM);
    for (int i = 0; i < 3; i++) {
        carry_out(&l.d, "ADD a 8 8\nSNAPSHOT\n");
        await_info(&l.d, "snapshot_running", 0);
    }
    node_start(&r, NULL);
    node_await(&r, "link", "refused");
    node_fact(&r, "link_error", why);
    CHECK_MSG(strstr(why, "its log does not reach back") != NULL, "%s", why);
    node_expect(&r, "STAT b", "OK 0 points=1");
    node_follow(&r, &l, " CONFIRM");
    node_expect_same(&l, &r);
    node_end(&l);
    node_end(&r);
    tree_remove(backups.path);
}

/* The daemon was killed after it had saved its promotion, but before the log had the new history. */
TEST_TIMEOUT(promotion_is_continued_by_the_next_daemon, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char path[128], text[FACT + 40], history[FACT], want[FACT];
    struct history h;
    carry_out(&l.d, "ADD a 0 0\n");
    node_expect_same(&l, &f);
    node_fact(&l, "history", history);
    CHECK(history_read(history, strlen(history), &h));
    h = history_next(&h, 77);
    history_write(want, &h);
    daemon_stop(&f.d, SIGKILL);
    snprintf(path, sizeof path, "%s/role", f.dir.path);
    snprintf(text, sizeof text, "lead 127.0.0.1 %s\nhistory %s\n", l.d.port_text, want);
    file_write(path, text, strlen(text));
    node_start(&f, NULL);
    node_await(&f, "history", want);
    node_expect(&f, "ADD a 1 1", "OK 0 first=1");
    node_await(&l, "role", "fenced");
    daemon_stop(&f.d, SIGKILL);
    CHECK(unlink(path) == 0); /* the log has it now */
    node_start(&f, NULL);
    CHECK(node_is(&f, "history", want));
    node_expect(&f, "STAT a", "OK 0 points=2");
    node_end(&l);
    node_end(&f);
}
