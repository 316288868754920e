/* message.c - see message.h. */
#include "clients/cli/message.h"

#include <stdio.h>

static char last[1400];

void message_keep(const char *format, va_list values)
{
    vsnprintf(last, sizeof last, format, values);
}

void message_print(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    message_keep(format, values);
    va_end(values);
    fputs("delaunay: ", stderr);
    va_start(values, format);
    vfprintf(stderr, format, values);
    va_end(values);
    putc('\n', stderr);
}

const char *message_last(void)
{
    return last;
}
