/* role_test.c - what a data directory remembers about its leader, and addresses. */
#include "server/follow/role.h"

#include "tests/server/directory.h"
#include "tests/server/file_calls.h"
#include "tests/test.h"

#include <errno.h>
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
    return r.port == 0 && !r.fenced;
}

TEST(role_that_was_written_is_read_back_until_it_is_removed)
{
    struct bench b = begin();
    CHECK(is_none(read_back(&b)));
    CHECK(role_write(&b.dir, "follow 10.1.2.3 6375\n"));
    struct remembered_role r = read_back(&b);
    CHECK(r.port == 6375 && !r.fenced);
    CHECK_STR(r.host, "10.1.2.3");
    CHECK(role_write(&b.dir, "follow fe80::1%eth0 1\n"));
    r = read_back(&b);
    CHECK(r.port == 1);
    CHECK_STR(r.host, "fe80::1%eth0");
    CHECK(role_write(&b.dir, "fenced 00000000000000aa.4.0000000c\n"));
    r = read_back(&b);
    CHECK(r.port == 0 && r.fenced && r.newer.origin == 0xaa && r.newer.generation == 4 &&
          r.newer.nonce == 0xc);
    CHECK(role_write(&b.dir, "") && is_none(read_back(&b)));
    CHECK(role_write(&b.dir, "") && is_none(read_back(&b)));
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
                                        "fenced\n",
                                        "fenced aa.4\n",
                                        "fenced aa.4.c 9\n",
                                        "fenced follow\n",
                                        "lead 10.0.0.1 6375\n"};
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
    calls_watch(b.directory.path);
    CHECK(role_write(&b.dir, "follow 10.0.0.1 6375\n"));
    CHECK_STR(calls_text(), "create role.new\nwrite role.new\nsync role.new\n"
                            "rename role.new role\nsync .\n");
    calls_watch(b.directory.path);
    CHECK(role_write(&b.dir, ""));
    CHECK_STR(calls_text(), "remove role\nsync .\n");
    end(&b);
}

TEST(role_that_cannot_be_written_leaves_the_old_one)
{
    static const char *const calls[] = {"create role.new", "write role.new", "sync role.new",
                                        "rename role.new role"};
    struct bench b = begin();
    CHECK(role_write(&b.dir, "follow 10.0.0.1 6375\n"));
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        calls_watch(b.directory.path);
        calls_fail(calls[i], 1, 1, EIO);
        CHECK(!role_write(&b.dir, "fenced aa.4.c\n") && errno == EIO && calls_failed() == 1);
        CHECK_MSG(read_back(&b).port == 6375, "%s", calls[i]);
    }
    calls_watch(b.directory.path);
    calls_fail("remove role", 1, 1, EIO);
    CHECK(!role_write(&b.dir, "") && errno == EIO && read_back(&b).port == 6375);
    calls_fail("sync .", 1, 1, EIO);
    CHECK(!role_write(&b.dir, "") && errno == EIO);
    end(&b);
}

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
