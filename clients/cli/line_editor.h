/* line_editor.h - reads lines typed at a prompt, with history, editing and completion if this was built with libedit
 * or readline; otherwise as the terminal delivers them. */
#pragma once

#include "clients/lib/delaunay_client.h"

/* Before the first line, and after the last: the history is kept in ~/.delaunay_history. c: for the names of
 * sets. */
void line_editor_begin(struct delaunay_client *c);
void line_editor_end(void);

/* The next line without its end, which the caller frees; NULL at the end of the input. ^C discards
 * what was typed and returns an empty line. */
char *line_editor_read(const char *prompt);

/* The same for the next line of a file or pipe. */
char *line_editor_next(void);
