/* consent.c - see consent.h. */
#include "server/follow/consent.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORD = HISTORY_TEXT };

/* The value of a key in the line. */
static bool find_value(const char *line, const char *key, char value[WORD])
{
    const char *at = strstr(line, key);
    if (at == NULL)
        return false;
    at += strlen(key);
    size_t n = strcspn(at, " \n");
    if (n >= WORD)
        return false;
    memcpy(value, at, n);
    value[n] = '\0';
    return true;
}

static const char *name_of(enum history_relation relation)
{
    switch (relation) {
    case HISTORY_OLDER:
        return "older than the one here";
    case HISTORY_BESIDE:
        return "that of another follower that was promoted, too";
    default:
        return "a different one";
    }
}

/* Why the line is no answer of a leader. */
static void explain(const char *line, char *why, size_t size)
{
    static const char follower[] = "ERR READONLY leader=";
    size_t n = strlen(follower);
    if (strncmp(line, follower, n) == 0)
        snprintf(why, size, "it is a follower itself: FOLLOW its leader %.150s", line + n);
    else
        snprintf(why, size, "%.150s", strncmp(line, "ERR ", 4) == 0 ? line + 4 : line);
}

bool consent_read_history(const char *line, struct history *theirs)
{
    char text[WORD];
    return strncmp(line, "OK ", 3) == 0 && find_value(line, "history=", text) &&
           history_read(text, strlen(text), theirs);
}

enum consent consent_to(const struct asker *a, const char *line, char *why, size_t size)
{
    char text[HISTORY_TEXT], lsn[WORD], how[WORD];
    struct history theirs;
    if (!consent_read_history(line, &theirs) || !find_value(line, "lsn=", lsn) ||
        !find_value(line, "continues=", how)) {
        explain(line, why, size);
        return CONSENT_LATER;
    }
    enum history_relation relation = history_relation(&theirs, &a->at.history);
    int n;
    if (a->confirmed || a->at.lsn == 0)
        return CONSENT_GIVEN;
    history_write(text, &theirs);
    if (relation != HISTORY_SAME && relation != HISTORY_NEWER)
        n = snprintf(why, size, "its history %s is %s", text, name_of(relation));
    else if (strtoull(lsn, NULL, 10) < a->at.lsn)
        n = snprintf(why, size, "it has changes up to %s only, this daemon has %" PRIu64, lsn,
                     a->at.lsn);
    else if (strcmp(how, "differs") == 0)
        n = snprintf(why, size, "it has other changes up to %" PRIu64 " than this daemon",
                     a->at.lsn);
    else if (strcmp(how, "no") == 0 && (relation == HISTORY_NEWER || a->own))
        n = snprintf(why, size,
                     "its log does not reach back to %" PRIu64
                     ", so it may lack changes up to there",
                     a->at.lsn);
    else
        return CONSENT_GIVEN;
    if ((size_t)n < size)
        snprintf(why + n, size - (size_t)n, "; FOLLOW address port CONFIRM replaces what is here");
    return CONSENT_REFUSED;
}
