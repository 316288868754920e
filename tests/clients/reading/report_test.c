/* report_test.c - notes about a file that was read. */
#include "clients/reading/report.h"

#include <string.h>

#include "tests/test.h"

TEST(notes_are_printable_utf_8_whatever_the_file_contains)
{
    struct report r = {.n = 0};
    report_add(&r, NOTE_UNUSED, "columns not used: %s", "H\xF6he H\xC3\xB6he \x1B[2J\n\xE2\x82");
    CHECK_STR(r.note[0].text, "columns not used: H\xC3\xB6he H\xC3\xB6he ?[2J?\xC3\xA2\xC2\x82");
    CHECK_STR(report_kind(r.note[0].kind), "unused");
}

TEST(a_note_that_is_too_long_says_so_and_too_many_are_counted)
{
    struct report r = {.n = 0};
    char text[1000];
    memset(text, 'a', sizeof text);
    text[sizeof text - 1] = '\0';
    for (int i = 0; i < REPORT_NOTES + 3; i++)
        report_add(&r, NOTE_DOUBT, "%s", text);
    size_t n = strlen(r.note[0].text);
    CHECK(r.n == REPORT_NOTES && r.lost == 3 && n < REPORT_NOTE_ROOM);
    CHECK_STR(r.note[0].text + n - 4, "a...");
}
