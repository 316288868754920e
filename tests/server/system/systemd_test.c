/* systemd_test.c - the daemon under a service manager: inherited sockets and notifications of states;
 * its manual page lists its flags. */
#include "tests/faults/tree.h"
#include "tests/server/daemon.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

/* A listening socket on a free port of the address (in host byte order). */
static int listener_on(uint32_t address, unsigned *port)
{
    struct sockaddr_in at = {.sin_family = AF_INET};
    socklen_t len = sizeof at;
    at.sin_addr.s_addr = htonl(address);
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&at, len) == 0 && listen(fd, 16) == 0);
    CHECK(getsockname(fd, (struct sockaddr *)&at, &len) == 0);
    *port = ntohs(at.sin_port);
    return fd;
}

/* A socket for notifications, with an abstract name, which is put into the daemon's environment. */
static int notifications(void)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    char name[60];
    snprintf(name, sizeof name, "@delaunayd-test-%d", (int)getpid());
    memcpy(at.sun_path + 1, name + 1, strlen(name) - 1);
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&at,
                          (socklen_t)(offsetof(struct sockaddr_un, sun_path) + strlen(name))) == 0);
    setenv("NOTIFY_SOCKET", name, 1);
    return fd;
}

static void expect_state(int fd, const char *want)
{
    char state[64];
    ssize_t n = recv(fd, state, sizeof state - 1, 0);
    CHECK(n > 0);
    state[n] = '\0';
    CHECK_STR(state, want);
}

/* Starts the daemon with the socket as its descriptor 3. */
static pid_t start_with(int listener)
{
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        char self[20];
        snprintf(self, sizeof self, "%d", (int)getpid());
        setenv("LISTEN_PID", self, 1);
        setenv("LISTEN_FDS", "1", 1);
        if (listener != 3)
            dup2(listener, 3);
        else
            fcntl(3, F_SETFD, 0);
        execl(getenv("DELAUNAYD"), "delaunayd", (char *)NULL);
        _exit(127);
    }
    close(listener);
    return pid;
}

TEST(inherited_socket_is_served_and_states_are_notified)
{
    struct daemon d = {0};
    int states = notifications();
    d.pid = start_with(listener_on(INADDR_LOOPBACK, &d.port));
    expect_state(states, "READY=1");
    int fd = daemon_connect(&d);
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    CHECK(kill(d.pid, SIGTERM) == 0);
    expect_state(states, "STOPPING=1");
    expect_end(fd);
    int status;
    CHECK(waitpid(d.pid, &status, 0) == d.pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* Each file takes a while to open, so reading takes longer than the ready line waits. */
TEST(systemd_hears_that_the_daemon_is_ready_when_all_sets_can_be_used)
{
    struct directory dir = directory_quick();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, "ADD t 0 0 1 0 0 1\nTRIANGULATE t\nSNAPSHOT\n");
    daemon_stop(&d, SIGKILL);
    int states = notifications();
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", dir.path, 1);
    setenv("DISK_OP", "stall", 1);
    setenv("DISK_NTH", "1", 1);
    setenv("DISK_TIMES", "1000", 1);
    setenv("DISK_ERRNO", "400", 1); /* milliseconds */
    d = directory_daemon(&dir, NULL);
    unsetenv("LD_PRELOAD");
    char state[100] = "";
    unsigned later = 0; /* at the start, and once a second */
    while (strcmp(state, "READY=1") != 0) {
        ssize_t n = recv(states, state, sizeof state - 1, 0);
        CHECK(n > 0);
        state[n] = '\0';
        later += strncmp(state, "EXTEND_TIMEOUT_USEC=30000000\n", 29) == 0;
    }
    CHECK_MSG(later >= 2, "%u", later);
    int fd = daemon_connect(&d);
    say(fd, "LOCATE t 0.1 0.1\n");
    CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    close(fd);
    daemon_end(&d);
    tree_remove(dir.path);
}

TEST(inherited_socket_that_others_could_reach_is_refused_without_tokens)
{
    unsigned port;
    int status;
    pid_t pid = start_with(listener_on(INADDR_ANY, &port));
    CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 1);
}

/* Every flag of --help is in the manual page. */
TEST(manual_lists_every_flag)
{
    static char help[16384], page[32768];
    FILE *f = popen("\"$DELAUNAYD\" --help", "r");
    CHECK(f != NULL && fread(help, 1, sizeof help - 1, f) > 0 && pclose(f) == 0);
    f = fopen("man/delaunayd.8", "r");
    CHECK(f != NULL && fread(page, 1, sizeof page - 1, f) > 0);
    fclose(f);
    int flags = 0;
    for (char *at = help; (at = strstr(at, "\n  --")) != NULL; at += 3) {
        char flag[100] = "", *to = flag;
        for (const char *c = at + 3; *c == '-' || (*c >= 'a' && *c <= 'z'); c++) {
            if (*c == '-')
                *to++ = '\\';
            *to++ = *c;
        }
        CHECK_MSG(strstr(page, flag) != NULL, "the manual says nothing about %s", flag);
        flags++;
    }
    CHECK(flags >= 15);
}
