/* commands_json.h - the table of commands for programs: `delaunayd --commands`. */
#pragma once

#include <stdio.h>

/* Writes the table as JSON: an array with one object for each command, one on each line. */
void commands_json_print(FILE *out);
