/* credit.c - see credit.h. */
#include "server/watch/credit.h"

/* The time in which the loop is idle is not spare if it is busy as long: clients that edit without pause need processors, too. */
void credit_earn(struct credit *c, int64_t processor, int64_t idle_ns)
{
    int64_t busy = processor - c->processor, idle = idle_ns - c->idle_ns;
    c->ns += busy / CREDIT_SHARE + (idle > busy ? (idle - busy) / 2 : 0);
    c->ns = c->ns < CREDIT_MOST ? c->ns : CREDIT_MOST;
    c->processor = processor;
    c->idle_ns = idle_ns;
}

void credit_spend(struct credit *c, int64_t ns)
{
    c->ns = c->ns - ns > -CREDIT_DEBT ? c->ns - ns : -CREDIT_DEBT;
}
