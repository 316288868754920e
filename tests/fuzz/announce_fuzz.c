/* announce_fuzz.c - libFuzzer target: the facts that a daemon reports about itself (announce_read). For any bytes, each fact is
 * a line that fits in its room. */
#include "server/follow/announce.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require_line(const char *text, size_t room)
{
    const char *end = memchr(text, '\0', room);
    if (end == NULL || strpbrk(text, "\r\n") != NULL)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    struct inquired who;
    if (text == NULL)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    announce_read(text, &who);
    require_line(who.daemon, sizeof who.daemon);
    require_line(who.role, sizeof who.role);
    require_line(who.leader, sizeof who.leader);
    require_line(who.refusal, sizeof who.refusal);
    free(text);
    return 0;
}
