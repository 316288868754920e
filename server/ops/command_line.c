/* command_line.c - see command_line.h. */
#include "server/ops/command_line.h"

#include "proto/version.h"
#include "server/ops/setting.h"
#include "server/system/sock.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const char usage[] =
    "usage: delaunayd [flags]\n"
    "A daemon that keeps sets of points of the plane and their Delaunay triangulations.\n"
    "\n"
    "  --bind ADDR         numeric address to listen on (default 127.0.0.1)\n"
    "  --port N            TCP port, 0 for any free one (default 6374)\n"
    "  --unix PATH         listen on this Unix socket too\n"
    "  --private           listen on a Unix socket in a new directory alone, until standard input "
    "ends\n"
    "  --data DIR          keep everything in this directory as well, so that it survives\n"
    "  --backup-dir DIR    where the request BACKUP may write backups of --data (default: "
    "nowhere)\n"
    "  --fsync WHEN        always: a change is acknowledged when it is on the disk (default);\n"
    "                      everysec: when it is written, synced once a second; no: never synced\n"
    "  --compact-at BYTES  log after which a snapshot replaces it (default 64m; more for large "
    "sets)\n"
    "  --follow ADDR:PORT  follow this daemon: have everything that it has, and refuse changes "
    "(needs --data)\n"
    "  --follow-token-file FILE  the token for it, one that may write\n"
    "  --min-followers N   acknowledge a change when N followers have it on disk, too (default 0)\n"
    "  --follower-timeout S  refuse changes when a follower that --min-followers needs has "
    "acknowledged\n"
    "                      nothing for S seconds (default 10)\n"
    "  --keep-log BYTES    log that stays for followers although a snapshot has it (default "
    "256m)\n"
    "  --check DIR         check a data directory and exit\n"
    "  --repair DIR        repair it: put aside what is damaged, and exit\n"
    "  --auth-file FILE    lines `ro TOKEN` and `rw TOKEN`: clients must AUTH with one of these\n"
    "  --insecure          allow an address beyond loopback without --auth-file\n"
    "  --reactors N        threads that serve connections (default: half of the processors)\n"
    "  --threads N         threads that work on heavy requests (default: one per processor)\n"
    "  --max-clients N     connections at once (default 10000, or what descriptors allow)\n"
    "  --idle-timeout S    close connections of clients that have sent nothing for S seconds "
    "(default: "
    "never)\n"
    "  --load-timeout S    abandon a LOAD whose points have stopped arriving for S seconds "
    "(default 60; "
    "0: never)\n"
    "  --max-points N      points of one set (default 268435455)\n"
    "  --max-memory BYTES  memory for everything, with k, m or g after it (default: 80 % of the "
    "machine's)\n"
    "  --slowlog-us N      requests that take N microseconds go into the slow log, 0: none do "
    "(default 10000)\n"
    "  --slowlog-len N     requests that the slow log keeps (default 128)\n"
    "  --log-level LEVEL   messages on standard error: error, warning, info (default) or "
    "debug\n"
    "  --commands          print the table of commands as JSON\n"
    "  --version           print the version\n"
    "  --help              print this help\n";

/* ---- flags ---- */

enum flag { FLAG_CHECK = 256, FLAG_REPAIR, FLAG_VERSION, FLAG_HELP, FLAG_COMMANDS, FLAG_SETTING };

static const struct option others[] = {
    {"check", required_argument, NULL, FLAG_CHECK},
    {"repair", required_argument, NULL, FLAG_REPAIR},
    {"version", no_argument, NULL, FLAG_VERSION},
    {"help", no_argument, NULL, FLAG_HELP},
    {"commands", no_argument, NULL, FLAG_COMMANDS},
    {0},
};

enum { OTHERS = sizeof others / sizeof others[0] };

static void list_flags(struct option flag[SETTING_MOST + OTHERS])
{
    for (size_t i = 0; i < setting_count; i++)
        flag[i] = (struct option){
            settings[i].name, settings[i].kind == SETTING_SWITCH ? no_argument : required_argument,
            NULL, FLAG_SETTING + (int)i};
    memcpy(flag + setting_count, others, sizeof others);
}

static bool complain(const char *flag, const char *value, const char *wanted)
{
    fprintf(stderr, "delaunayd: --%s %s: %s\n", flag, value, wanted);
    return false;
}

static bool take_setting(struct config *c, const struct setting *of, const char *value)
{
    return setting_read(of, c, value) || complain(of->name, value, of->wanted);
}

static bool safe_to_bind(const struct config *c)
{
    bool loopback;
    if (c->private && (c->unix_path != NULL || c->data != NULL))
        return complain("private", "", "it excludes --unix and --data");
    if (!sock_is_address(c->bind_address, &loopback))
        return complain("bind", c->bind_address, "not a numeric IPv4 or IPv6 address");
    if (!loopback && c->auth_file == NULL && !c->insecure)
        return complain(
            "bind", c->bind_address,
            "others could reach this address: give --auth-file, or --insecure if you mean it");
    return true;
}

enum command_line command_line_read(struct config *c, int argc, char **argv)
{
    struct option flags[SETTING_MOST + OTHERS];
    list_flags(flags);
    for (int flag; (flag = getopt_long(argc, argv, "", flags, NULL)) != -1;) {
        if (flag == FLAG_HELP || flag == FLAG_VERSION) {
            fputs(flag == FLAG_HELP ? usage : "delaunayd " DELAUNAY_VERSION "\n", stdout);
            return COMMAND_LINE_ANSWERED;
        }
        if (flag == FLAG_COMMANDS)
            return COMMAND_LINE_COMMANDS;
        if (flag == FLAG_CHECK)
            c->check = optarg;
        else if (flag == FLAG_REPAIR)
            c->repair = optarg;
        else if (flag == '?' || !take_setting(c, &settings[flag - FLAG_SETTING], optarg))
            return COMMAND_LINE_BAD;
    }
    if (optind < argc) {
        fprintf(stderr, "delaunayd: %s: not a flag; see --help\n", argv[optind]);
        return COMMAND_LINE_BAD;
    }
    return safe_to_bind(c) ? COMMAND_LINE_GOOD : COMMAND_LINE_BAD;
}
