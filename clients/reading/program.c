/* program.c - see program.h. */
#include "clients/reading/program.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Starts it; in and out replace its standard input and output, unless they are -1. Returns 0 or an errno. */
static int start(pid_t *pid, const char *const *word, int in, int out, bool apart)
{
    char *words[PROGRAM_WORDS + 1] = {NULL};
    unsetenv("GZIP"); /* more options of gzip, which may not suit */
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    for (size_t i = 0; i < PROGRAM_WORDS && word[i] != NULL; i++)
        memcpy(&words[i], &word[i], sizeof words[i]);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    int failed = apart ? posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP) : 0;
    if (failed == 0 && in >= 0)
        failed = posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    if (failed == 0 && out >= 0)
        failed = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    if (failed == 0)
        failed = posix_spawnp(pid, words[0], &actions, &attributes, words, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

int program_start(pid_t *pid, const char *const *word, int in, int *out, bool apart)
{
    int pipes[2];
    if (pipe2(pipes, O_CLOEXEC) != 0)
        return errno;
    int failed = start(pid, word, in, pipes[1], apart);
    close(pipes[1]);
    if (failed != 0)
        close(pipes[0]);
    else
        *out = pipes[0];
    return failed;
}

int program_end(pid_t pid)
{
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        continue;
    return status;
}

int program_run(const char *const *word)
{
    pid_t pid;
    fflush(stdout);
    int failed = start(&pid, word, -1, -1, false);
    if (failed != 0)
        return failed == ENOENT ? PROGRAM_MISSING : -1;
    int status = program_end(pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
