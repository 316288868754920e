/* setting.c - see setting.h. */
#include "server/ops/setting.h"

#include "core/delaunay.h"
#include "proto/number.h"
#include "server/ops/glob.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define AT(FIELD) offsetof(struct config, FIELD)

enum { FIXED = false, LIVE = true };

static const char bytes_wanted[] = "bytes, as in 4096m or 2g";

/* A sixteenth of the memory is for replies and clients (server/sets/budget.h): with less, no client could connect to raise it. */
enum { LEAST_MEMORY = 256 * 1024 };

const struct setting settings[] = {
    {"bind", NULL, SETTING_TEXT, FIXED, AT(bind_address), 0, 0, NULL},
    {"port", NULL, SETTING_NUMBER, FIXED, AT(port), 0, 65535, "a port is 0 to 65535"},
    {"unix", "unixsocket", SETTING_TEXT, FIXED, AT(unix_path), 0, 0, NULL},
    {"private", NULL, SETTING_SWITCH, FIXED, AT(private), 0, 0, NULL},
    {"data", "dir", SETTING_TEXT, FIXED, AT(data), 0, 0, NULL},
    {"backup-dir", NULL, SETTING_TEXT, FIXED, AT(backup_dir), 0, 0, NULL},
    {"fsync", "appendfsync", SETTING_FSYNC, FIXED, AT(fsync), 0, 0, "always, everysec or no"},
    {"compact-at", NULL, SETTING_BYTES, LIVE, AT(compact_at), 1, 0, bytes_wanted},
    {"follow", NULL, SETTING_TEXT, FIXED, AT(follow), 0, 0, NULL},
    {"follow-token-file", NULL, SETTING_TEXT, FIXED, AT(follow_token_file), 0, 0, NULL},
    {"min-followers", "min-replicas-to-write", SETTING_NUMBER, LIVE, AT(min_followers), 0, 64,
     "from 0 to 64"},
    {"follower-timeout", "min-replicas-max-lag", SETTING_NUMBER, LIVE, AT(follower_timeout_s), 1,
     1000000, "seconds, 1 to 1000000"},
    {"keep-log", "repl-backlog-size", SETTING_BYTES, LIVE, AT(keep_log), 1, 0, bytes_wanted},
    {"auth-file", NULL, SETTING_TEXT, FIXED, AT(auth_file), 0, 0, NULL},
    {"insecure", NULL, SETTING_SWITCH, FIXED, AT(insecure), 0, 0, NULL},
    {"reactors", NULL, SETTING_NUMBER, FIXED, AT(reactors), 1, CONFIG_MOST_REACTORS,
     "from 1 to 64"},
    {"threads", NULL, SETTING_NUMBER, FIXED, AT(threads), 1, CONFIG_MOST_THREADS, "from 1 to 256"},
    {"max-clients", "maxclients", SETTING_NUMBER, LIVE, AT(max_clients), 1, 1000000,
     "from 1 to 1000000"},
    {"idle-timeout", "timeout", SETTING_NUMBER, LIVE, AT(idle_timeout_s), 0, 1000000,
     "seconds, 0 to 1000000"},
    {"load-timeout", NULL, SETTING_NUMBER, LIVE, AT(load_timeout_s), 0, 1000000,
     "seconds, 0 to 1000000"},
    {"max-points", NULL, SETTING_NUMBER, LIVE, AT(max_points), 1, DT_MAX_POINTS,
     "from 1 to 268435455"},
    {"max-memory", "maxmemory", SETTING_BYTES, LIVE, AT(max_memory), LEAST_MEMORY, 0,
     "bytes, at least 256k, as in 4096m or 2g"},
    {"slowlog-us", NULL, SETTING_NUMBER, LIVE, AT(slowlog_us), 0, UINT32_MAX,
     "microseconds, up to 4294967295"},
    {"slowlog-len", "slowlog-max-len", SETTING_NUMBER, LIVE, AT(slowlog_len), 0, 1000000,
     "from 0 to 1000000"},
    {"log-level", NULL, SETTING_LEVEL, LIVE, AT(log_level), 0, 0, "error, warning, info or debug"},
};

const size_t setting_count = sizeof settings / sizeof settings[0];

_Static_assert(sizeof settings / sizeof settings[0] <= SETTING_MOST, "room for all settings");

static bool is_name(const char *name, const char *text, size_t len)
{
    return name != NULL && strlen(name) == len && strncasecmp(name, text, len) == 0;
}

const struct setting *setting_find(const char *name, size_t len)
{
    for (size_t i = 0; i < setting_count; i++)
        if (is_name(settings[i].name, name, len) || is_name(settings[i].redis, name, len))
            return &settings[i];
    return NULL;
}

/* ---- values ---- */

static bool read_number(const struct setting *of, const char *text, uint32_t *v)
{
    uint32_t read;
    if (!proto_read_u32(text, strlen(text), &read) || read < of->least || read > of->most)
        return false;
    *v = read;
    return true;
}

static bool read_bytes(const char *text, uint32_t least, size_t *bytes)
{
    char *end;
    if (*text < '0' || *text > '9')
        return false;
    unsigned long long v = strtoull(text, &end, 10);
    unsigned shift = *end == 'k' ? 10 : *end == 'm' ? 20 : *end == 'g' ? 30 : 0;
    if (end[shift != 0] != '\0' || v > (SIZE_MAX >> shift) || (size_t)v << shift < least)
        return false;
    *bytes = (size_t)v << shift;
    return true;
}

static const char *const policy_name[] = {"always", "everysec", "no"};

static bool read_policy(const char *text, enum log_policy *policy)
{
    for (int i = LOG_ALWAYS; i <= LOG_NO; i++) {
        if (strcmp(text, policy_name[i]) == 0) {
            *policy = (enum log_policy)i;
            return true;
        }
    }
    return false;
}

bool setting_read(const struct setting *of, struct config *c, const char *value)
{
    void *field = (char *)c + of->offset;
    switch (of->kind) {
    case SETTING_TEXT:
        *(const char **)field = value;
        return true;
    case SETTING_NUMBER:
        return read_number(of, value, field);
    case SETTING_BYTES:
        return read_bytes(value, of->least, field);
    case SETTING_FSYNC:
        return read_policy(value, field);
    case SETTING_LEVEL:
        return notice_parse_level(value, field);
    case SETTING_SWITCH:
        *(bool *)field = true;
        return true;
    }
    return false;
}

const char *setting_text(const struct setting *of, const struct config *c, char *buf)
{
    const void *field = (const char *)c + of->offset;
    const char *text;
    switch (of->kind) {
    case SETTING_TEXT:
        text = *(const char *const *)field;
        return text != NULL ? text : "";
    case SETTING_NUMBER:
        snprintf(buf, SETTING_TEXT_ROOM, "%" PRIu32, *(const uint32_t *)field);
        return buf;
    case SETTING_BYTES:
        snprintf(buf, SETTING_TEXT_ROOM, "%zu", *(const size_t *)field);
        return buf;
    case SETTING_FSYNC:
        return policy_name[*(const enum log_policy *)field];
    case SETTING_LEVEL:
        return notice_level_name(*(const enum notice_level *)field);
    case SETTING_SWITCH:
        return *(const bool *)field ? "yes" : "no";
    }
    return "";
}

/* ---- patterns ---- */

static bool matches_any(const char *name, const struct word *pattern, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (glob_matches(pattern[i].text, pattern[i].len, name, strlen(name), GLOB_CASELESS))
            return true;
    return false;
}

const char *setting_asked(const struct setting *of, const struct word *pattern, size_t n)
{
    if (matches_any(of->name, pattern, n))
        return of->name;
    return of->redis != NULL && matches_any(of->redis, pattern, n) ? of->redis : NULL;
}
