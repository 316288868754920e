/* setting.h - the settings of a daemon by name: what the flags of the command line and CONFIG have
 * in common. A setting is one row of a table; `live` ones may change while the daemon runs. */
#ifndef SERVER_SETTING_H
#define SERVER_SETTING_H

#include "proto/request.h"
#include "server/ops/config.h"

enum setting_kind {
    SETTING_TEXT,   /* taken as it is, borrowed */
    SETTING_NUMBER, /* from least to most */
    SETTING_BYTES,  /* more than 0; with k, m or g behind it */
    SETTING_FSYNC,
    SETTING_LEVEL,
    SETTING_SWITCH /* a flag without a value; yes or no */
};

struct setting {
    const char *name;  /* of the flag, without its dashes */
    const char *redis; /* what Redis calls the same; NULL: it has no such setting */
    enum setting_kind kind;
    bool live;
    size_t offset; /* in struct config */
    uint32_t least, most;
    const char *wanted; /* for who misses that */
};

enum { SETTING_MOST = 64 }; /* rows, at most */

extern const struct setting settings[];
extern const size_t setting_count;

/* The setting of that name, in small or capital letters, or of Redis's name; NULL: there is none. */
const struct setting *setting_find(const char *name, size_t len);

/* Reads a value, NUL-terminated; false: it is not what is wanted, and *c is as it was. */
bool setting_read(const struct setting *of, struct config *c, const char *value);

/* The value as text that setting_read takes, "" for none; buf has room for SETTING_TEXT_ROOM bytes
 * and is not always used. */
enum { SETTING_TEXT_ROOM = 24 };
const char *setting_text(const struct setting *of, const struct config *c, char *buf);

/* The name by which the setting is asked for by one of n patterns: its own, or else Redis's; NULL:
 * it is not. */
const char *setting_asked(const struct setting *of, const struct word *pattern, size_t n);

/* Whether the name matches the pattern, in which `*` stands for any characters and `?` for one; small
 * and capital letters are the same. Cost: O(the product of the lengths). */
bool setting_matches(const char *name, const char *pattern, size_t len);

#endif
