/* metrics_test.c - `delaunay metrics` prints INFO in the text format of Prometheus. */
#include <stdlib.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static void send_info(int fd)
{
    char line[100];
    peer_hear(fd, line, sizeof line);
    CHECK_STR(line, "INFO");
    peer_say(fd, "OK 12\nversion:1.0.0\nuptime_s:7\nmemory:100\nlog_bytes:64\ncommands:3\n"
                 "durability:good\ntides_us:2500\nmoon:full \"\\\"\ncommand_ADD:calls=2,p50_us=66\n"
                 "command_OTHER:calls=1,p50_us=1.5\n"
                 "buoy3:addr=[::1]:7,lag_ms=20,colour=red\nno value\n");
}

TEST(metrics_have_types_units_and_labels_also_those_that_are_unknown)
{
    char port[8];
    int status;
    peer_start(port, send_info);
    CHECK_STR(peer_shell(&status, "%s -p %s metrics 2>&1", getenv("DELAUNAY"), port),
              "# HELP delaunayd_version_info Version of the daemon.\n"
              "# TYPE delaunayd_version_info gauge\n"
              "delaunayd_version_info{version=\"1.0.0\"} 1\n"
              "# HELP delaunayd_uptime_seconds Time since the start.\n"
              "# TYPE delaunayd_uptime_seconds gauge\n"
              "delaunayd_uptime_seconds 7\n"
              "# HELP delaunayd_memory_bytes Memory of all sets.\n"
              "# TYPE delaunayd_memory_bytes gauge\n"
              "delaunayd_memory_bytes 100\n"
              "# HELP delaunayd_log_bytes Length of the log since the last snapshot.\n"
              "# TYPE delaunayd_log_bytes gauge\n"
              "delaunayd_log_bytes 64\n"
              "# HELP delaunayd_commands_total Requests.\n"
              "# TYPE delaunayd_commands_total counter\n"
              "delaunayd_commands_total 3\n"
              "# HELP delaunayd_durability_info Whether changes can be saved: off, loading, good, "
              "full or readonly.\n"
              "# TYPE delaunayd_durability_info gauge\n"
              "delaunayd_durability_info{durability=\"good\"} 1\n"
              "# HELP delaunayd_tides_seconds The value tides_us of INFO.\n"
              "# TYPE delaunayd_tides_seconds untyped\n"
              "delaunayd_tides_seconds 0.0025\n"
              "# HELP delaunayd_moon_info The value moon of INFO.\n"
              "# TYPE delaunayd_moon_info gauge\n"
              "delaunayd_moon_info{moon=\"full \\\"\\\\\\\"\"} 1\n"
              "# HELP delaunayd_command_calls_total Requests, by command.\n"
              "# TYPE delaunayd_command_calls_total counter\n"
              "delaunayd_command_calls_total{command=\"ADD\"} 2\n"
              "delaunayd_command_calls_total{command=\"OTHER\"} 1\n"
              "# HELP delaunayd_command_p50_seconds Median of the time of a request since the "
              "start.\n"
              "# TYPE delaunayd_command_p50_seconds gauge\n"
              "delaunayd_command_p50_seconds{command=\"ADD\"} 6.6e-05\n"
              "delaunayd_command_p50_seconds{command=\"OTHER\"} 1.5e-06\n"
              "# HELP delaunayd_buoy_info The value buoy of INFO.\n"
              "# TYPE delaunayd_buoy_info gauge\n"
              "delaunayd_buoy_info{buoy=\"3\",addr=\"[::1]:7\",colour=\"red\"} 1\n"
              "# HELP delaunayd_buoy_lag_seconds The value buoy_lag_ms of INFO.\n"
              "# TYPE delaunayd_buoy_lag_seconds untyped\n"
              "delaunayd_buoy_lag_seconds{buoy=\"3\"} 0.02\n");
    CHECK(status == 0);
}

static void send_replication(int fd)
{
    char line[100];
    peer_hear(fd, line, sizeof line);
    CHECK_STR(line, "INFO");
    peer_say(fd, "OK 5\nlog_digest:0123456789012345\n"
                 "link_error:READONLY leader=10.0.0.2:6374\nfollowers:1\n"
                 "follower_1:address=10.0.0.3:7,state=log,lag_records=2,lag_bytes=60,lag_s=0.250\n"
                 "history:12.1.34\n");
}

/* A reason may have a `=`; the digest would be a new time series after every change. */
TEST(metrics_of_followers_have_their_addresses_and_no_digest)
{
    char port[8];
    int status;
    peer_start(port, send_replication);
    CHECK_STR(peer_shell(&status, "%s -p %s metrics 2>&1 | grep -v '^#'", getenv("DELAUNAY"), port),
              "delaunayd_link_error_info{link_error=\"READONLY leader=10.0.0.2:6374\"} 1\n"
              "delaunayd_followers 1\n"
              "delaunayd_follower_info{follower=\"1\",address=\"10.0.0.3:7\",state=\"log\"} 1\n"
              "delaunayd_follower_lag_records{follower=\"1\"} 2\n"
              "delaunayd_follower_lag_bytes{follower=\"1\"} 60\n"
              "delaunayd_follower_lag_seconds{follower=\"1\"} 0.250\n"
              "delaunayd_history_info{history=\"12.1.34\"} 1\n");
    CHECK(status == 0);
}

static bool is_name(const char *text, size_t n)
{
    return n > 0 && strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") >= n;
}

/* `name{labels} number`, of the metric that the last # TYPE names. */
static void check_sample(const char *line, const char *metric)
{
    size_t name = strcspn(line, "{ ");
    const char *value = strrchr(line, ' ');
    char *end;
    CHECK_MSG(is_name(line, name) && strlen(metric) == name && strncmp(line, metric, name) == 0,
              "%s", line);
    CHECK_MSG(value != NULL && (value == line + name || value[-1] == '}'), "%s", line);
    strtod(value + 1, &end);
    CHECK_MSG(end > value + 1 && *end == '\0', "%s", line);
}

TEST(metrics_of_a_daemon_are_in_the_format_of_prometheus)
{
    int status;
    char metric[100] = "", seen[20000] = "\n";
    size_t metrics = 0;
    cli_begin();
    cli_run(&status, "add t 0 0 1 0 0 1");
    cli_run(&status, "nearest t 1 1");
    char *text = strdup(cli_run(&status, "metrics"));
    CHECK(status == 0 && text != NULL);
    CHECK(strstr(text, "\ndelaunayd_sets 1\n") != NULL &&
          strstr(text, "\ndelaunayd_command_calls_total{command=\"NEAREST\"} 1\n") != NULL);
    for (char *line = strtok(text, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        char entry[102];
        if (strncmp(line, "# TYPE ", 7) != 0) {
            if (strncmp(line, "# HELP ", 7) != 0)
                check_sample(line, metric);
            continue;
        }
        snprintf(metric, sizeof metric, "%.*s", (int)strcspn(line + 7, " "), line + 7);
        snprintf(entry, sizeof entry, "\n%s\n", metric);
        CHECK_MSG(strstr(seen, entry) == NULL, "%s comes twice", metric);
        strcat(seen, entry + 1);
        metrics++;
    }
    CHECK(metrics > 40);
    free(text);
    cli_run(&status, "metrics now");
    CHECK(status == 2);
    cli_finish();
}
