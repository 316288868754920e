/* terminal.h - `delaunay` on a terminal of 24 lines of 80 columns, on which the test types. Any failure ends the
 * test. */
#pragma once

/* Starts `delaunay ARGUMENTS` for the daemon of cli.h; its home is the test's directory. */
void terminal_start(const char *arguments);

/* Waits until the text appears after the text of the previous call. */
void terminal_wait_for(const char *text);

void terminal_type(const char *text);

/* Waits until the program ends; returns its exit status, -1 if it was killed. */
int terminal_finish(void);
