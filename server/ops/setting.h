/* setting.h - the settings of a daemon by name, for the flags of the command line and for CONFIG. A setting is
 * one row of a table; settings that are `live` can be changed while the daemon runs. */
#pragma once

#include "proto/request.h"
#include "server/ops/config.h"

enum setting_kind {
    SETTING_TEXT,   /* borrowed */
    SETTING_NUMBER, /* from least to most */
    SETTING_BYTES,  /* at least `least`; with an optional suffix k, m or g */
    SETTING_FSYNC,
    SETTING_LEVEL,
    SETTING_SWITCH /* a flag without a value; yes or no */
};

struct setting {
    const char *name;  /* of the flag, without its dashes */
    const char *redis; /* Redis's name for the same setting; NULL: it has none */
    enum setting_kind kind;
    bool live;
    size_t offset; /* in struct config */
    uint32_t least, most;
    const char *wanted; /* the valid values, for the error message */
};

enum { SETTING_MOST = 64 }; /* rows, at most */

extern const struct setting settings[];
extern const size_t setting_count;

/* The setting of that name, its own or Redis's, case-insensitive; NULL: there is none. */
const struct setting *setting_find(const char *name, size_t len);

/* Parses a NUL-terminated value; false: it is not valid, and *c is unchanged. */
bool setting_read(const struct setting *of, struct config *c, const char *value);

/* The value as text, as setting_read takes it, "" for none; buf has room for SETTING_TEXT_ROOM bytes and is
 * not always used. */
enum { SETTING_TEXT_ROOM = 24 };
const char *setting_text(const struct setting *of, const struct config *c, char *buf);

/* The name of the setting that one of n patterns (glob.h, without case) matches: its own, or else Redis's; NULL: none. */
const char *setting_asked(const struct setting *of, const struct word *pattern, size_t n);
