/* hostile_edits.h - the table of edits and searches where they are hardest, compared with the same on
 * uniform points. */
#ifndef BENCH_HOSTILE_EDITS_H
#define BENCH_HOSTILE_EDITS_H

/* Prints the cost of each, with one thread, and the ratio. */
void hostile_edits_table(void);

#endif
