/* program.c - see program.h. */
#include "clients/files/program.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

int program_start(pid_t *pid, const char *const *word, int in, int *out)
{
    int pipes[2];
    char *words[PROGRAM_WORDS + 1] = {NULL};
    posix_spawn_file_actions_t actions;
    for (size_t i = 0; i < PROGRAM_WORDS && word[i] != NULL; i++)
        memcpy(&words[i], &word[i], sizeof words[i]);
    if (pipe2(pipes, O_CLOEXEC) != 0)
        return errno;
    posix_spawn_file_actions_init(&actions);
    if (in >= 0)
        posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, pipes[1], STDOUT_FILENO);
    int failed = posix_spawnp(pid, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
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
