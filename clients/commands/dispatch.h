/* dispatch.h - carries out the words of a command: a subcommand, or a request of the protocol. */
#pragma once

#include "clients/cli/request.h"
#include "clients/lib/url.h"

/* With c NULL it connects to *where, which a set's URL among the words changes. With c, from the prompt, where is
 * NULL. No words: the prompt. Returns the exit status. */
int dispatch(struct delaunay_client *c, int words, char **word, struct url *where);
