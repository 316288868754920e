/* role_test.c - what a data directory remembers about its leader, and addresses. */
#include "server/follow/role.h"

#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct bench {
    struct directory directory;
    struct datadir dir;
};

static struct bench begin(void)
{
    struct bench b = {.directory = directory_quick()};
    CHECK(datadir_open(&b.dir, b.directory.path, false));
    return b;
}

static void end(struct bench *b)
{
    datadir_close(&b->dir);
    directory_remove(&b->directory);
}

static struct remembered_role read_back(const struct bench *b)
{
    return role_read(b->directory.path);
}

static bool is_none(struct remembered_role r)
{
    return r.kind == ROLE_UNKNOWN && r.port == 0 && !r.own && r.flag[0] == '\0' &&
           r.newer.origin == 0;
}

static struct remembered_role follower(const char *host, unsigned port)
{
    struct remembered_role r = {.kind = ROLE_FOLLOWS, .port = port};
    strcpy(r.host, host);
    return r;
}

static bool follows(struct remembered_role r, const char *host, unsigned port)
{
    return r.kind == ROLE_FOLLOWS && r.port == port && strcmp(r.host, host) == 0;
}

/* A written role is read back, and the file has that text. */
static void expect_text(const struct bench *b, const struct remembered_role *r, const char *want)
{
    char path[100], text[400];
    CHECK(role_write(&b->dir, r));
    snprintf(path, sizeof path, "%s/role", b->directory.path);
    FILE *in = fopen(path, "r");
    size_t n = in == NULL ? 0 : fread(text, 1, sizeof text - 1, in);
    if (in != NULL)
        fclose(in);
    text[n] = '\0';
    CHECK_STR(text, want);
    struct remembered_role got = read_back(b);
    CHECK(got.kind == (n == 0 ? ROLE_UNKNOWN : r->kind) && got.port == r->port &&
          got.own == r->own);
    CHECK_STR(got.host, r->host);
    CHECK_STR(got.flag, r->flag);
    CHECK(got.newer.origin == r->newer.origin && got.newer.generation == r->newer.generation &&
          got.newer.nonce == r->newer.nonce);
}

TEST(role_that_was_written_is_read_back_until_it_is_removed)
{
    struct bench b = begin();
    CHECK(is_none(read_back(&b)));
    struct remembered_role r = follower("10.1.2.3", 6375), none = {.kind = ROLE_LEADS};
    expect_text(&b, &r, "follow 10.1.2.3 6375\n");
    r.own = true;
    strcpy(r.flag, "10.1.2.4:6374");
    expect_text(&b, &r, "follow 10.1.2.3 6375 own\nflag 10.1.2.4:6374\n");
    r = follower("fe80::1%eth0", 1);
    expect_text(&b, &r, "follow fe80::1%eth0 1\n");
    r.kind = ROLE_LEADS;
    expect_text(&b, &r, "lead fe80::1%eth0 1\n");
    struct remembered_role led = {.kind = ROLE_LEADS, .flag = "[::1]:6374"};
    expect_text(&b, &led, "lead\nflag [::1]:6374\n");
    struct remembered_role promoted = {.kind = ROLE_LEADS, .newer = {0xab, 5, 0xd, 0}};
    expect_text(&b, &promoted, "lead\nhistory 00000000000000ab.5.0000000d\n");
    struct remembered_role fenced = {.kind = ROLE_FENCED, .newer = {0xaa, 4, 0xc, 0}};
    expect_text(&b, &fenced, "fenced 00000000000000aa.4.0000000c\n");
    expect_text(&b, &none, "");
    expect_text(&b, &none, "");
    end(&b);
}

/* A text as long as possible. */
TEST(role_with_the_longest_address_is_read_back)
{
    struct bench b = begin();
    struct remembered_role r = {.kind = ROLE_FOLLOWS, .port = 65535, .own = true};
    char want[400];
    memset(r.host, '1', ROLE_ADDRESS - 1);
    snprintf(r.flag, sizeof r.flag, "[%s]:65535", r.host);
    snprintf(want, sizeof want, "follow %s 65535 own\nflag %s\n", r.host, r.flag);
    expect_text(&b, &r, want);
    r = (struct remembered_role){
        .kind = ROLE_LEADS, .port = 65535, .newer = {UINT64_MAX, UINT32_MAX, UINT32_MAX, 0}};
    memset(r.host, '1', ROLE_ADDRESS - 1);
    snprintf(r.flag, sizeof r.flag, "[%s]:65535", r.host);
    snprintf(want, sizeof want,
             "lead %s 65535\nhistory ffffffffffffffff.4294967295.ffffffff\nflag %s\n", r.host,
             r.flag);
    expect_text(&b, &r, want);
    end(&b);
}

TEST(role_file_that_makes_no_sense_counts_as_none)
{
    static const char *const texts[] = {"",
                                        "\n",
                                        "follow\n",
                                        "follow 10.0.0.1\n",
                                        "follow 10.0.0.1 x\n",
                                        "follow 10.0.0.1 0\n",
                                        "Follow 10.0.0.1 1\n",
                                        "follow 10.0.0.1 1 mine\n",
                                        "lead 10.0.0.1\n",
                                        "lead 10.0.0.1 0\n",
                                        "lead 10.0.0.1 1 own\n",
                                        "leads\n",
                                        "flag 10.0.0.1:1\n",
                                        "follow 10.0.0.1 0\nflag 10.0.0.1:1\n",
                                        "history aa.4.c\n",
                                        "follow 10.0.0.1\nhistory aa.4.c\n",
                                        "fenced\n",
                                        "fenced aa.4\n",
                                        "fenced aa.4.c 9\n",
                                        "fenced follow\n",
                                        "lead me\n"};
    struct bench b = begin();
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        char path[100];
        snprintf(path, sizeof path, "%s/role", b.directory.path);
        file_write(path, texts[i], strlen(texts[i]));
        CHECK_MSG(is_none(read_back(&b)), "%s", texts[i]);
    }
    char path[100], text[400];
    snprintf(path, sizeof path, "%s/role", b.directory.path);
    memset(text, 'a', sizeof text);
    memcpy(text, "follow ", 7);
    file_write(path, text, sizeof text);
    CHECK(is_none(read_back(&b)));
    end(&b);
}

TEST(role_is_durable_when_it_has_been_written_and_when_it_has_been_removed)
{
    struct bench b = begin();
    struct remembered_role r = follower("10.0.0.1", 6375), none = {.kind = ROLE_LEADS};
    calls_watch(b.directory.path);
    CHECK(role_write(&b.dir, &r));
    CHECK_STR(calls_text(), "create role.new\nwrite role.new\nsync role.new\n"
                            "rename role.new role\nsync .\n");
    calls_watch(b.directory.path);
    CHECK(role_write(&b.dir, &none));
    CHECK_STR(calls_text(), "remove role\nsync .\n");
    end(&b);
}

TEST(role_that_cannot_be_written_leaves_the_old_one)
{
    static const char *const calls[] = {"create role.new", "write role.new", "sync role.new",
                                        "rename role.new role"};
    struct bench b = begin();
    struct remembered_role r = follower("10.0.0.1", 6375), none = {.kind = ROLE_LEADS},
                           fenced = {.kind = ROLE_FENCED, .newer = {0xaa, 4, 0xc, 0}};
    CHECK(role_write(&b.dir, &r));
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        calls_watch(b.directory.path);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(!role_write(&b.dir, &fenced) && errno == EIO && calls_failed() == 1);
        CHECK_MSG(read_back(&b).port == 6375, "%s", calls[i]);
    }
    calls_watch(b.directory.path);
    calls_fail("remove role", 1, 1, EIO);
    CHECK(!role_write(&b.dir, &none) && errno == EIO && read_back(&b).port == 6375);
    calls_fail("sync .", 1, 1, EIO);
    CHECK(!role_write(&b.dir, &none) && errno == EIO);
    end(&b);
}

/* ---- decisions ---- */

static struct remembered_role decide(struct remembered_role r, const char *flag)
{
    CHECK(role_decide(&r, flag));
    CHECK_STR(r.flag, flag == NULL ? "" : flag);
    return r;
}

TEST(directory_without_a_role_does_what_the_flag_says)
{
    struct remembered_role none = {.kind = ROLE_UNKNOWN}, r = decide(none, NULL);
    CHECK(r.kind == ROLE_UNKNOWN);
    r = decide(none, "10.0.0.1:6374");
    CHECK(follows(r, "10.0.0.1", 6374) && r.own);
    CHECK(!role_decide(&none, "10.0.0.1"));
}

TEST(flag_that_is_new_decides_and_one_that_is_not_leaves_what_a_command_has_decided)
{
    struct remembered_role r = follower("10.0.0.2", 2);
    strcpy(r.flag, "10.0.0.1:1");
    CHECK(follows(decide(r, "10.0.0.1:1"), "10.0.0.2", 2));
    CHECK(follows(decide(r, NULL), "10.0.0.2", 2));
    struct remembered_role to = decide(r, "10.0.0.3:3");
    CHECK(follows(to, "10.0.0.3", 3) && !to.own);
    r.kind = ROLE_LEADS;
    CHECK(decide(r, "10.0.0.1:1").kind == ROLE_LEADS && decide(r, NULL).kind == ROLE_LEADS);
    to = decide(r, "10.0.0.3:3");
    CHECK(follows(to, "10.0.0.3", 3) && to.own);
    r.kind = ROLE_FENCED;
    CHECK(decide(r, "10.0.0.1:1").kind == ROLE_FENCED);
    to = decide(decide(r, NULL), "10.0.0.1:1"); /* the flag was left out, and is there again */
    CHECK(follows(to, "10.0.0.1", 1) && to.own);
}

/* ---- addresses ---- */

TEST(addresses_are_read_with_and_without_brackets)
{
    static const struct {
        const char *text, *host;
        unsigned port;
    } good[] = {{"127.0.0.1:6375", "127.0.0.1", 6375},
                {"[::1]:1", "::1", 1},
                {"[fe80::1%eth0]:65535", "fe80::1%eth0", 65535},
                {"::1:6375", "::1", 6375}};
    static const char *const bad[] = {"",
                                      ":",
                                      ":1",
                                      "127.0.0.1",
                                      "127.0.0.1:",
                                      "127.0.0.1:0",
                                      "127.0.0.1:65536",
                                      "1.2.3.4:12x",
                                      "[::1]",
                                      "[::1:6375",
                                      "[:1",
                                      "[]:1",
                                      "[::1]x:1",
                                      "1.2.3.4:-1",
                                      "1.2.3.4: 1",
                                      "1.2.3.4:+1",
                                      "1.2.3.4:99999999999999999999999"};
    char host[ROLE_ADDRESS];
    unsigned port;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        CHECK_MSG(role_read_address(good[i].text, host, &port), "%s", good[i].text);
        CHECK(port == good[i].port);
        CHECK_STR(host, good[i].host);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!role_read_address(bad[i], host, &port), "%s", bad[i]);
    char text[ROLE_ADDRESS + 8];
    memset(text, '1', sizeof text);
    strcpy(text + ROLE_ADDRESS, ":1");
    CHECK(!role_read_address(text, host, &port));
    strcpy(text + ROLE_ADDRESS - 1, ":1");
    CHECK(role_read_address(text, host, &port) && strlen(host) == ROLE_ADDRESS - 1);
}
