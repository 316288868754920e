/* auth.h - the tokens of --auth-file and the roles that they give. */
#pragma once

#include "proto/request.h"

#include <stdbool.h>

enum role { ROLE_NONE, ROLE_READ, ROLE_WRITE };

struct auth {
    struct token *token; /* owns */
    size_t n;
};

/* Reads lines `ro TOKEN` and `rw TOKEN`; blank lines and those that start with # are skipped.
 * False, with the reason on standard error, if the file cannot be read, holds another line, or
 * holds no token; *a is then empty. */
bool auth_load(struct auth *a, const char *path);
void auth_clear(struct auth *a);

/* The role of a new connection. */
enum role auth_initial_role(const struct auth *a);

/* The role and the number (from 1) of the token; ROLE_NONE and 0 if it is unknown. The time that this takes
 * does not depend on which byte differs. */
enum role auth_check(const struct auth *a, const struct word *token, unsigned *number);

/* The role of the token with that number; ROLE_NONE for 0. */
enum role auth_role(const struct auth *a, unsigned number);

/* After a reload: number[i] is the number that token i + 1 of `before` has now, 0 if it has been removed. False when out
 * of memory. Cost: O(n log n) for n tokens. */
bool auth_renumber(const struct auth *now, const struct auth *before, unsigned *number);
