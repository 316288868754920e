/* private_test.c - a daemon that serves one process and ends with it. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

struct owned {
    pid_t pid;
    int owner; /* our end of its standard input */
    char path[128];
};

static void become(int in, int out)
{
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    execl(getenv("DELAUNAYD"), "delaunayd", "--private", (char *)NULL);
    _exit(127);
}

static struct owned start(void)
{
    struct owned d = {0};
    int in[2], out[2];
    CHECK(pipe2(in, O_CLOEXEC) == 0 && pipe2(out, O_CLOEXEC) == 0);
    d.owner = in[1];
    d.pid = fork();
    CHECK(d.pid >= 0);
    if (d.pid == 0)
        become(in[0], out[1]);
    close(in[0]);
    close(out[1]);
    FILE *f = fdopen(out[0], "r");
    CHECK(f != NULL && fscanf(f, "ready on %127s", d.path) == 1 && d.path[0] == '/');
    fclose(f);
    return d;
}

static void expect_ended(const struct owned *d)
{
    int status;
    CHECK(waitpid(d->pid, &status, 0) == d->pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(access(d->path, F_OK) != 0);
    char directory[128];
    snprintf(directory, sizeof directory, "%s", d->path);
    *strrchr(directory, '/') = '\0';
    CHECK(access(directory, F_OK) != 0);
}

TEST(private_daemon_is_only_for_its_user)
{
    struct owned d = start();
    struct stat st;
    int fd = connect_unix(d.path);
    say(fd, "CONFIG GET private\n");
    expect(fd, "OK 1\nprivate yes\n");
    *strrchr(d.path, '/') = '\0';
    CHECK(stat(d.path, &st) == 0 && (st.st_mode & 0777) == 0700);
    d.path[strlen(d.path)] = '/';
    close(d.owner);
    expect_ended(&d);
}

TEST(private_daemon_ends_with_its_owner_in_the_middle_of_work)
{
    struct owned d = start();
    int fd = connect_unix(d.path);
    load_random(fd, "t", 300000);
    say(fd, "TRIANGULATE t\nTRIANGULATE t\nLISTS t\n");
    CHECK(write(d.owner, "ignored", 7) == 7);
    close(d.owner);
    expect_ended(&d);
}

TEST(private_daemon_ignores_sigint_and_stops_on_sigterm)
{
    struct owned d = start();
    int fd = connect_unix(d.path);
    CHECK(kill(d.pid, SIGINT) == 0);
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    close(fd);
    CHECK(kill(d.pid, SIGTERM) == 0);
    expect_ended(&d);
    close(d.owner);
}
