/* hostile_edits.h - the table of edits and searches where they are hardest, compared with the same on
 * uniform points. */
#pragma once

/* Prints the cost of each, with one thread, and the ratio. */
void hostile_edits_table(void);
