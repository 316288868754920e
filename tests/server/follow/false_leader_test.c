/* false_leader_test.c - a follower whose leader sends what no leader sends, or what is not true. */
#include "tests/server/follow/false_leader.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static struct node follower_of(const struct false_leader *l)
{
    return node_new((const char *const[]){"--follow", l->address, NULL});
}

/* A LOAD of `points` points into the set. */
static void add_load(struct false_leader *l, const char *name, uint32_t points)
{
    double *xy = malloc(2 * RECORD_POINTS * sizeof *xy);
    CHECK(xy != NULL);
    false_leader_record(
        l, (struct record){.type = RECORD_LOAD, .name = name, .name_len = strlen(name)});
    for (uint32_t n = 0, step; n < points; n += step) {
        step = points - n < RECORD_POINTS ? points - n : RECORD_POINTS;
        for (uint32_t i = 0; i < 2 * step; i++)
            xy[i] = test_uniform();
        false_leader_record(l, (struct record){.type = RECORD_CHUNK, .n = step, .items = xy});
    }
    false_leader_record(
        l, (struct record){
               .type = RECORD_LOADED, .n = points, .name = name, .name_len = strlen(name)});
    free(xy);
}

static const struct record create_u = {.type = RECORD_CREATE, .name = "u", .name_len = 1};

TEST_TIMEOUT(follower_takes_what_a_leader_sends, 60)
{
    struct false_leader l = false_leader_new();
    struct node f = follower_of(&l);
    false_leader_accept(&l, "no");
    false_leader_snapshot(&l, 10);
    add_load(&l, "t", 40000);
    false_leader_record(&l, create_u);
    CHECK(false_leader_send(&l));
    node_await(&f, "lsn", "15");
    node_expect(&f, "STAT t", "OK 0 points=40000");
    node_expect(&f, "STAT u", "OK 0 points=0");
    false_leader_end(&l);
    node_end(&f);
}

/* A record that is written here with other bytes: the digests differ. The difference is found while a worker has the record
 * after it; everything goes on with a snapshot. */
TEST_TIMEOUT(difference_of_digests_is_dealt_with_when_no_worker_has_a_record, 60)
{
    struct false_leader l = false_leader_new();
    struct node f = follower_of(&l);
    struct record odd = {.type = RECORD_EXPIRE, .name = "t", .name_len = 1, .a = 4e12, .flags = 4};
    struct record triangulate = {.type = RECORD_TRIANGULATE, .name = "t", .name_len = 1};
    false_leader_accept(&l, "no");
    false_leader_snapshot(&l, 10);
    add_load(&l, "t", 300000);
    false_leader_record(&l, odd);
    false_leader_header(&l);
    false_leader_record(&l, triangulate);
    false_leader_header(&l);
    CHECK(false_leader_send(&l));
    false_leader_accept(&l, "no");
    CHECK_MSG(strstr(l.asked, " 0000000000000000") != NULL, "%s", l.asked);
    false_leader_snapshot(&l, 50);
    false_leader_record(&l, create_u);
    CHECK(false_leader_send(&l));
    node_await(&f, "lsn", "51");
    node_expect(&f, "STAT t", "ERR NOSET");
    node_expect(&f, "STAT u", "OK 0 points=0");
    CHECK(node_is(&f, "link", "receiving"));
    false_leader_end(&l);
    node_end(&f);
}

/* ---- what cannot be read ---- */

/* The follower ends the connection for that reason, and connects again. */
static void expect_refusal(struct false_leader *l, const struct node *f, const char *why)
{
    char reason[FACT] = "";
    false_leader_send(l);
    for (unsigned i = 0; i < node_tries() && strstr(reason, why) == NULL; i++) {
        pause_ms(10);
        node_fact(f, "link_error", reason);
    }
    CHECK_MSG(strstr(reason, why) != NULL, "%s", reason);
    CHECK(node_is(f, "link", "connecting"));
    false_leader_accept(l, "no");
}

TEST_TIMEOUT(follower_connects_again_after_bytes_that_it_cannot_read, 60)
{
    struct false_leader l = false_leader_new();
    struct node f = follower_of(&l);
    false_leader_accept(&l, "no");
    buf_append(&l.out, "DELAUNAY", 8);
    for (int i = 0; i < 100; i++)
        buf_append(&l.out, "?", 1);
    expect_refusal(&l, &f, "what it sends cannot be read");
    false_leader_snapshot(&l, 10);
    false_leader_record(&l, create_u);
    l.out.data[l.out.end - 1] ^= 1;
    expect_refusal(&l, &f, "what it sends cannot be read");
    CHECK(node_is(&f, "lsn", "10"));
    node_end(&f);
    false_leader_end(&l);
}

TEST_TIMEOUT(header_within_a_snapshot_ends_the_connection, 60)
{
    struct false_leader l = false_leader_new();
    struct node f = follower_of(&l);
    false_leader_accept(&l, "no");
    for (int i = 0; i < 2; i++) {
        l.lsn = 20;
        l.digest = 5;
        false_leader_snapshot_header(&l);
        if (i == 0)
            false_leader_snapshot_header(&l);
        else
            false_leader_header(&l);
        expect_refusal(&l, &f, "a header within a snapshot");
    }
    CHECK(node_is(&f, "lsn", "0"));
    node_end(&f);
    false_leader_end(&l);
}

TEST_TIMEOUT(follower_says_that_it_is_disconnected, 60)
{
    struct false_leader l = false_leader_new();
    struct node f = follower_of(&l);
    false_leader_accept(&l, "no");
    false_leader_snapshot(&l, 10);
    CHECK(false_leader_send(&l));
    node_await(&f, "lsn", "10");
    node_await(&f, "link", "receiving");
    CHECK(shutdown(l.fd, SHUT_RDWR) == 0);
    node_await(&f, "link", "connecting"); /* it connects again, and gets no answer */
    CHECK(node_is(&f, "link_error", "disconnected"));
    node_end(&f);
    false_leader_end(&l);
}

/* ---- a leader that does not answer ---- */

/* Its machine is off: connecting takes seconds, and the daemon is promoted meanwhile, again and again. FOLLOW itself asks who the
 * leader is, for two seconds. */
TEST(promotion_does_not_wait_for_the_connection_to_a_leader_that_is_gone)
{
    enum { PROMOTIONS = 4, FULL = 3 };
    struct false_leader l = false_leader_new();
    struct node f = node_new(NULL);
    int fd[FULL];
    char follow[40];
    CHECK(listen(l.listener, 0) ==
          0); /* the queue of this port gets full: attempts to connect are ignored */
    for (int i = 0; i < FULL; i++)
        fd[i] = false_leader_dial(&l);
    snprintf(follow, sizeof follow, "FOLLOW 127.0.0.1 %s", strchr(l.address, ':') + 1);
    for (int i = 0; i < PROMOTIONS; i++) {
        node_expect(&f, follow, "OK");
        pause_ms(20); /* it connects */
        node_expect(&f, "FOLLOW NONE", "OK");
    }
    for (int i = 0; i < FULL; i++)
        close(fd[i]);
    node_end(&f);
    false_leader_end(&l);
}
