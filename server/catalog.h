/* catalog.h - the table of commands for programs: `delaunayd --commands`. */
#ifndef SERVER_CATALOG_H
#define SERVER_CATALOG_H

#include <stdio.h>

/* Writes the table as JSON: an array with one object for each command, one on each line. */
void catalog_print(FILE *out);

#endif
