/* consent_test.c - which answers of a leader a daemon takes, and which it leaves to an operator. */
#include "server/follow/consent.h"

#include "tests/test.h"

#include <stdio.h>
#include <string.h>

#define LINE(HISTORY, LSN, HOW) "OK 0 history=" HISTORY " lsn=" LSN " continues=" HOW "\n"

static const char same[] = "00000000000000aa.3.0000000b";

/* The answer for a daemon in generation 3 with changes up to lsn; *why is static. */
static enum consent answer(uint64_t lsn, bool confirmed, const char *line, const char **why)
{
    static char text[240];
    struct asker a = {.at = {.lsn = lsn, .digest = 7}, .confirmed = confirmed};
    CHECK(history_read(same, strlen(same), &a.at.history));
    text[0] = '\0';
    *why = text;
    return consent_to(&a, line, text, sizeof text);
}

TEST(leader_that_has_everything_is_followed_and_no_other_one)
{
    static const struct {
        const char *line;
        enum consent want;
        const char *why; /* a part of it */
    } rows[] = {
        {LINE("aa.3.b", "10", "yes"), CONSENT_GIVEN, ""},
        {LINE("aa.3.b", "11", "no"), CONSENT_GIVEN, ""},
        {LINE("aa.3.b", "9", "yes"), CONSENT_REFUSED, "up to 9 only, this daemon has 10"},
        {LINE("aa.3.b", "9", "no"), CONSENT_REFUSED, "up to 9 only, this daemon has 10"},
        {LINE("aa.3.b", "0", "no"), CONSENT_REFUSED, "up to 0 only, this daemon has 10"},
        {LINE("aa.3.b", "10", "differs"), CONSENT_REFUSED, "other changes up to 10"},
        {LINE("aa.4.c", "10", "yes"), CONSENT_GIVEN, ""},
        {LINE("aa.4294967295.c", "11", "yes"), CONSENT_GIVEN, ""},
        {LINE("aa.4.c", "11", "no"), CONSENT_REFUSED, "does not reach back to 10"},
        {LINE("aa.4.c", "9", "yes"), CONSENT_REFUSED, "up to 9 only, this daemon has 10"},
        {LINE("aa.4.c", "11", "differs"), CONSENT_REFUSED, "other changes up to 10"},
        {LINE("aa.2.b", "11", "yes"), CONSENT_REFUSED,
         "history 00000000000000aa.2.0000000b is older than"},
        {LINE("aa.3.c", "11", "yes"), CONSENT_REFUSED, "another follower that was promoted"},
        {LINE("ab.3.b", "11", "yes"), CONSENT_REFUSED, "a different one"},
        {LINE("ab.4.b", "11", "no"), CONSENT_REFUSED, "a different one"},
        {LINE("0.3.b", "11", "yes"), CONSENT_REFUSED, "a different one"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *why;
        enum consent got = answer(10, false, rows[i].line, &why);
        CHECK_MSG(got == rows[i].want, "%s: %d, %s", rows[i].line, got, why);
        CHECK_MSG(strstr(why, rows[i].why) != NULL, "%s: %s", rows[i].line, why);
        CHECK_MSG((strstr(why, "FOLLOW address port CONFIRM") != NULL) == (got == CONSENT_REFUSED),
                  "%s: %s", rows[i].line, why);
    }
}

/* A restored backup, or a copy of a directory, has the history of its original. */
TEST(daemon_that_may_have_changes_of_its_own_continues_a_log_and_refuses_a_snapshot)
{
    static const struct {
        const char *line;
        enum consent want;
    } rows[] = {{LINE("aa.3.b", "10", "yes"), CONSENT_GIVEN},
                {LINE("aa.3.b", "99", "yes"), CONSENT_GIVEN},
                {LINE("aa.3.b", "99", "no"), CONSENT_REFUSED},
                {LINE("aa.3.b", "99", "differs"), CONSENT_REFUSED}};
    char why[240];
    struct asker a = {.at = {.lsn = 10, .digest = 7}, .own = true};
    CHECK(history_read(same, strlen(same), &a.at.history));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        CHECK_MSG(consent_to(&a, rows[i].line, why, sizeof why) == rows[i].want, "%s",
                  rows[i].line);
    a.at.lsn = 0;
    CHECK(consent_to(&a, LINE("aa.3.b", "99", "no"), why, sizeof why) == CONSENT_GIVEN);
}

static const char *const histories[] = {"aa.3.b", "aa.4.c", "aa.2.b", "aa.3.c", "ab.9.1"};

TEST(daemon_that_is_empty_or_confirmed_follows_any_leader)
{
    static const char *const hows[] = {"yes", "no", "differs"};
    for (size_t i = 0; i < sizeof histories / sizeof histories[0]; i++) {
        for (size_t k = 0; k < sizeof hows / sizeof hows[0]; k++) {
            char line[120];
            const char *why;
            snprintf(line, sizeof line, "OK 0 history=%s lsn=%u continues=%s\n", histories[i],
                     (unsigned)i, hows[k]);
            CHECK_MSG(answer(10, true, line, &why) == CONSENT_GIVEN, "%s", line);
            CHECK_MSG(answer(0, false, line, &why) == CONSENT_GIVEN, "%s", line);
        }
    }
}

/* Even an empty or a confirmed one: nothing is given up for a line that no leader sends. */
TEST(answer_that_is_none_of_a_leader_is_asked_for_again_later)
{
    static const struct {
        const char *line, *why;
    } rows[] = {{"ERR READONLY leader=10.0.0.1:6375\n",
                 "it is a follower itself: FOLLOW its leader 10.0.0.1:6375"},
                {"ERR READONLY there is a newer history", "READONLY there is a newer history"},
                {"ERR LOADING the data directory is being read; try again\n", "LOADING the data"},
                {"ERR DENIED this token may only read\n", "DENIED"},
                {"OK 0\n", "OK 0"},
                {"HTTP/1.1 400 Bad Request\n", "HTTP/1.1"},
                {"\n", ""},
                {"", ""},
                {"OK 0 lsn=1 continues=yes\n", "OK 0"},
                {"OK 0 history=aa.3.b continues=yes\n", "OK 0"},
                {"OK 0 history=aa.3.b lsn=11\n", "OK 0"},
                {"OK 0 history=aa.3 lsn=11 continues=yes\n", "OK 0"},
                {"OK 0 history=aa.3.b.c lsn=11 continues=yes\n", "OK 0"},
                {"OK 0 history= lsn=11 continues=yes\n", "OK 0"},
                {"OK 0 history=aa.4294967296.b lsn=11 continues=yes\n", "OK 0"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (unsigned confirmed = 0; confirmed < 2; confirmed++) {
            const char *why;
            CHECK_MSG(answer(10, confirmed, rows[i].line, &why) == CONSENT_LATER, "%s",
                      rows[i].line);
            CHECK_MSG(strncmp(why, rows[i].why, strlen(rows[i].why)) == 0, "%s", why);
            CHECK(answer(0, confirmed, rows[i].line, &why) == CONSENT_LATER);
        }
    }
}

TEST(reason_of_a_refusal_fits_in_its_room)
{
    char line[500], why[64];
    struct asker a = {.at = {.lsn = UINT64_MAX, .digest = 1}};
    CHECK(history_read(same, strlen(same), &a.at.history));
    for (size_t size = 1; size <= sizeof why; size++) {
        memset(why, 'x', sizeof why);
        CHECK(consent_to(&a, LINE("aa.3.b", "10", "yes"), why, size) == CONSENT_REFUSED);
        CHECK(memchr(why, '\0', size) != NULL);
    }
    memset(line, 'a', sizeof line - 1);
    line[sizeof line - 1] = '\0';
    CHECK(consent_to(&a, line, why, sizeof why) == CONSENT_LATER);
    CHECK(strlen(why) < sizeof why);
}
