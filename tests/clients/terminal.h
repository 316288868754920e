/* terminal.h - `delaunay` on a terminal of 24 lines of 80 columns, at which the test types. Whatever fails ends the
 * test. */
#ifndef TESTS_CLIENTS_TERMINAL_H
#define TESTS_CLIENTS_TERMINAL_H

/* Starts `delaunay ARGUMENTS` for the daemon of cli.h; its home is the test's directory. */
void terminal_start(const char *arguments);

/* Waits until the text appears behind what was waited for before. */
void terminal_wait_for(const char *text);

void terminal_type(const char *text);

/* Waits until it ends; its exit status, -1 if it was killed. */
int terminal_finish(void);

#endif
