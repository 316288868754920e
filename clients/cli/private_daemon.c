/* private_daemon.c - see private_daemon.h. The socket is made and connected to here and handed over as a
 * service manager does (sd_listen_fds(3)), so there is nothing to wait for and nothing to clean up. */
#include "clients/cli/private_daemon.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

enum { HANDED_FD = 3 };

static struct delaunay_client *fail(char *why, size_t room, const char *what)
{
    snprintf(why, room, "%s: %s", what, strerror(errno));
    return NULL;
}

/* The path of the daemon; one without a '/' is looked for in $PATH. */
static void find_program(char *path, size_t room)
{
    const char *chosen = getenv("DELAUNAYD");
    ssize_t n = readlink("/proc/self/exe", path, room - 1);
    char *slash = NULL;
    if (n > 0) {
        path[n] = '\0';
        slash = strrchr(path, '/');
    }
    if (chosen != NULL && chosen[0] != '\0') {
        snprintf(path, room, "%s", chosen);
    } else if (slash != NULL && (size_t)(slash - path) + sizeof "/delaunayd" <= room) {
        strcpy(slash, "/delaunayd");
        if (access(path, X_OK) != 0)
            strcpy(path, "delaunayd");
    } else {
        snprintf(path, room, "delaunayd");
    }
}

/* In the child: becomes the daemon. What went wrong goes to `report`, which a daemon closes. */
static void become(const char *program, int listener, int report, pid_t parent)
{
    char pid[24];
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    report = fcntl(report, F_DUPFD_CLOEXEC, HANDED_FD + 1); /* out of the way */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    snprintf(pid, sizeof pid, "%ld", (long)getpid());
    if (getppid() != parent)
        _exit(0);
    if (listener != HANDED_FD)
        dup2(listener, HANDED_FD);
    else
        fcntl(listener, F_SETFD, 0);
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    setpgid(0, 0); /* an interrupt from the terminal is not for the daemon */
    setenv("LISTEN_PID", pid, 1);
    setenv("LISTEN_FDS", "1", 1);
    unsetenv("NOTIFY_SOCKET");
    execlp(program, "delaunayd", "--log-level", "error", (char *)NULL);
    (void)!write(report, &errno, sizeof errno);
    _exit(127);
}

static struct delaunay_client *spawn(int listener, const char *path, pid_t *pid, char *why,
                                     size_t room)
{
    char program[4096];
    int report[2], failed = 0;
    struct delaunay_client *c = delaunay_connect(path, "", why, room);
    unlink(path);
    if (c == NULL)
        return NULL;
    find_program(program, sizeof program);
    pid_t parent = getpid();
    *pid = pipe2(report, O_CLOEXEC) == 0 ? fork() : -1;
    if (*pid == 0)
        become(program, listener, report[1], parent);
    if (*pid > 0) {
        close(report[1]);
        if (read(report[0], &failed, sizeof failed) > 0)
            errno = failed;
        close(report[0]);
    }
    if (*pid > 0 && failed == 0)
        return c;
    fail(why, room, program);
    private_daemon_end(c, *pid);
    return NULL;
}

struct delaunay_client *private_daemon_start(pid_t *pid, char *why, size_t room)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    const char *tmp = getenv("TMPDIR");
    char directory[80]; /* of ours alone: mode 0700 */
    struct delaunay_client *c = NULL;
    if (tmp == NULL || tmp[0] != '/' || strlen(tmp) > 50) /* the path of a socket is short */
        tmp = "/tmp";
    snprintf(directory, sizeof directory, "%s/delaunay_XXXXXX", tmp);
    if (mkdtemp(directory) == NULL)
        return fail(why, room, directory);
    snprintf(at.sun_path, sizeof at.sun_path, "%s/socket", directory);
    int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (listener < 0 || bind(listener, (struct sockaddr *)&at, sizeof at) != 0 ||
        listen(listener, 4) != 0)
        fail(why, room, at.sun_path);
    else
        c = spawn(listener, at.sun_path, pid, why, room);
    unlink(at.sun_path);
    rmdir(directory);
    if (listener >= 0)
        close(listener);
    return c;
}

void private_daemon_end(struct delaunay_client *c, pid_t pid)
{
    delaunay_close(c);
    if (pid <= 0)
        return;
    kill(pid, SIGKILL);
    while (waitpid(pid, NULL, 0) < 0 && errno == EINTR)
        continue;
}
