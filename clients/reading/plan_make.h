/* plan_make.h - makes the plan by which a table is read. */
#pragma once

#include "clients/reading/plan.h"
#include "clients/reading/report.h"

/* Reads "X,Y" or "X,Y,Z", names or numbers counted from 1. False if it is neither. */
bool wish_columns(struct wish *w, const char *text);

/* Makes a plan from the first n bytes of a file, all of it if `whole`. Adds to the report what the plan does not use, and what is
 * doubtful. False: p->fault says why. The caller calls plan_clear in any case; *p must be zeroed. */
bool plan_make(struct plan *p, const struct wish *w, const char *text, size_t n, bool whole,
               struct report *report);
void plan_clear(struct plan *p);
