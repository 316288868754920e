/* edit.h - reads lines typed at a prompt, with history, editing and completion if this was built with libedit
 * or readline; otherwise as the terminal delivers them. */
#ifndef CLIENTS_EDIT_H
#define CLIENTS_EDIT_H

#include "clients/lib/delaunay_client.h"

/* Before the first line, and after the last: the history is kept in ~/.delaunay_history. c: for the names of
 * sets. */
void edit_begin(struct delaunay_client *c);
void edit_end(void);

/* The next line without its end, which the caller frees with edit_free; NULL at the end of the input. ^C discards
 * what was typed and returns an empty line. */
char *edit_line(const char *prompt);
void edit_free(char *line);

#endif
