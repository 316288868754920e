/* child.h - runs another program and waits for it. */
#ifndef CLIENTS_CHILD_H
#define CLIENTS_CHILD_H

enum { CHILD_MISSING = 127 };

/* Runs argv[0], searched for in $PATH, with these arguments, which end with NULL. Returns its exit status;
 * CHILD_MISSING if there is no such program; -1 if it was killed or could not be started. */
int child_run(char *const argv[]);

#endif
