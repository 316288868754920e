/* message.h - sentences on the standard error about what failed. With --json the last one is also the `message` of the object that a
 * failed command writes. */
#pragma once

#include <stdarg.h>

/* Prints "delaunay: ", the sentence and a line feed. */
__attribute__((format(printf, 1, 2))) void message_print(const char *format, ...);

/* Keeps a sentence that has been printed already, or will be. */
__attribute__((format(printf, 1, 0))) void message_keep(const char *format, va_list values);

/* The last sentence, "" if there was none. */
const char *message_last(void);
