/* paper.h - the paper's Table 1, measured again. */
#pragma once

/* Prints the table: 500 to 5,000 random points in steps of 500, with separate times for building the grid
 * and triangulating. */
void paper_table(void);
