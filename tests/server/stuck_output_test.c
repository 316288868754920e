/* stuck_output_test.c - standard output or standard error take nothing: a full pipe, a stopped terminal, a full disk, a
 * closed descriptor. The daemon still starts, serves its clients and ends. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

struct place {
    char folder[64], socket[80], data[80];
};

static struct place new_place(void)
{
    struct place p = {"/tmp/delaunayd-stuck-XXXXXX", "", ""};
    CHECK(mkdtemp(p.folder) != NULL);
    snprintf(p.socket, sizeof p.socket, "%s/socket", p.folder);
    snprintf(p.data, sizeof p.data, "%s/data", p.folder);
    CHECK(mkdir(p.data, 0700) == 0);
    return p;
}

/* Starts a daemon with these descriptors; -1: closed. */
static pid_t start(const struct place *p, int out, int err)
{
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid > 0)
        return pid;
    if (out < 0)
        close(STDOUT_FILENO);
    else
        dup2(out, STDOUT_FILENO);
    if (err < 0)
        close(STDERR_FILENO);
    else
        dup2(err, STDERR_FILENO);
    execl(getenv("DELAUNAYD"), "delaunayd", "--port", "0", "--unix", p->socket, "--data", p->data,
          "--log-level", "debug", (char *)NULL);
    _exit(127);
}

static int await_socket(const struct place *p)
{
    int fd = -1;
    for (unsigned i = 0; i < 500 * test_slowness() && (fd = connect_unix(p->socket)) < 0; i++)
        pause_ms(10);
    CHECK_MSG(fd >= 0, "the daemon does not listen");
    return fd;
}

/* Each connection is two lines at level debug. */
static void check_serves(const struct place *p, pid_t pid)
{
    int fd = await_socket(p), status;
    for (int i = 0; i < 200; i++) {
        int other = await_socket(p);
        say(other, "PING\n");
        expect(other, "OK 0\n");
        close(other);
    }
    const char *line = "";
    do { /* until the directory has been read */
        say(fd, "ADD t 1 2\n");
        line = hear_line(fd);
    } while (strncmp(line, "ERR LOADING ", 12) == 0);
    CHECK_MSG(strncmp(line, "OK 0 first=0 ", 13) == 0, "%s", line);
    say(fd, "SNAPSHOT\n");
    hear_line(fd);
    close(fd);
    CHECK(kill(pid, SIGTERM) == 0 && waitpid(pid, &status, 0) == pid);
    CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0, "status %x", (unsigned)status);
}

/* The daemon can read the directory that it has written. */
static void check_data(const struct place *p)
{
    char command[256];
    snprintf(command, sizeof command, "%s --check %s >/dev/null && rm -r %s", getenv("DELAUNAYD"),
             p->data, p->folder);
    CHECK(system(command) == 0);
}

static void check_all_with(int out, int err)
{
    struct place p = new_place();
    check_serves(&p, start(&p, out, err));
    check_data(&p);
}

/* The writing end of a pipe that nobody reads. */
static int full_pipe(int end[2])
{
    static const char bytes[4096];
    CHECK(pipe2(end, O_CLOEXEC) == 0 && fcntl(end[1], F_SETFL, O_NONBLOCK) == 0);
    while (write(end[1], bytes, sizeof bytes) > 0)
        ;
    while (write(end[1], bytes, 1) > 0)
        ;
    CHECK(fcntl(end[1], F_SETFL, 0) == 0);
    return end[1];
}

TEST(daemon_serves_while_its_messages_fill_a_pipe)
{
    int end[2];
    int fd = full_pipe(end);
    check_all_with(STDERR_FILENO, fd);
    CHECK_MSG((fcntl(fd, F_GETFL) & O_NONBLOCK) == 0, "the pipe of others was changed");
}

TEST(daemon_serves_although_nobody_reads_its_ready_line)
{
    int end[2];
    int fd = full_pipe(end);
    check_all_with(fd, fd);
}

TEST(daemon_serves_while_its_terminal_is_stopped)
{
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    CHECK(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    int tty = open(ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    CHECK(tty >= 0 && tcflow(tty, TCOOFF) == 0);
    check_all_with(tty, tty);
    CHECK(tcflow(tty, TCOON) == 0);
}

TEST(daemon_serves_while_the_disk_of_its_messages_is_full)
{
    int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
    CHECK(full >= 0);
    check_all_with(full, full);
}

TEST(daemon_serves_when_nobody_is_left_to_read_its_messages)
{
    int end[2];
    CHECK(pipe2(end, O_CLOEXEC) == 0);
    close(end[0]);
    check_all_with(end[1], end[1]);
}

/* Otherwise a file of the daemon would get the number of standard error, and messages. */
TEST(messages_do_not_reach_a_file_when_standard_error_is_closed)
{
    struct place p = new_place();
    pid_t pid = start(&p, -1, -1);
    char name[64], target[64] = "";
    close(await_socket(&p));
    snprintf(name, sizeof name, "/proc/%d/fd/2", (int)pid);
    CHECK(readlink(name, target, sizeof target - 1) > 0);
    CHECK_STR(target, "/dev/null");
    check_serves(&p, pid);
    check_data(&p);
}
