/* child.c - see child.h. */
#include "clients/cli/child.h"

#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

int child_run(char *const argv[])
{
    int status;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        execvp(argv[0], argv);
        _exit(CHILD_MISSING);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status))
        return -1;
    return WEXITSTATUS(status);
}
