/* roles.h - what each column of a table is, from its heading and its values in the first rows. */
#pragma once

#include "clients/reading/sample.h"

/* Decides the columns' roles; the headings are in p->column. False after plan_fault. */
bool roles_choose(struct plan *p, const struct wish *w, struct sample *s, struct report *report);

/* Says why there is no plan; `list`: and which columns there are. Returns false. */
__attribute__((format(printf, 3, 4))) bool plan_fault(struct plan *p, bool list, const char *format,
                                                      ...);
