/* glob_test.c - patterns of names. */
#include "server/ops/glob.h"
#include "tests/test.h"

#include <string.h>

static bool matches(const char *pattern, const char *name)
{
    return glob_matches(pattern, strlen(pattern), name, strlen(name), GLOB_CASED);
}

TEST(glob_stars_match_any_characters)
{
    CHECK(matches("*", "") && matches("*", "road") && matches("**", "road"));
    CHECK(matches("r*d", "road") && matches("r*d", "rd") && matches("*a*", "road"));
    CHECK(matches("*ab*ab", "ababab") && matches("a*b*c", "axbxbxc"));
    CHECK(!matches("r*d", "roads") && !matches("*x*", "road") && !matches("", "r"));
    CHECK(matches("", "") && !matches("a*b*c", "axbxb"));
}

TEST(glob_question_marks_match_one_character)
{
    CHECK(matches("r?ad", "road") && !matches("r?ad", "rad") && !matches("?", ""));
    CHECK(!matches("road?", "road") && matches("*?", "a"));
}

TEST(glob_classes_match_one_of_their_characters)
{
    CHECK(matches("r[ao]d", "rad") && matches("r[ao]d", "rod") && !matches("r[ao]d", "red"));
    CHECK(matches("[a-c]x", "bx") && matches("[c-a]x", "bx") && !matches("[a-c]x", "dx"));
    CHECK(matches("[^a]", "b") && !matches("[^a]", "a") && !matches("[]x", "x"));
    CHECK(matches("[a\\]]", "]") && matches("[ab", "b") && !matches("[ab", "c"));
    CHECK(!matches("[", "[") && matches("[^", "x"));
}

TEST(glob_backslash_makes_a_character_literal)
{
    CHECK(matches("a\\*b", "a*b") && !matches("a\\*b", "axb") && matches("a\\", "a\\"));
    CHECK(!matches("Road", "road"));
}

TEST(glob_without_case_takes_capitals_for_letters)
{
    CHECK(glob_matches("R?A[D-F]", 7, "road", 4, GLOB_CASELESS));
    CHECK(glob_matches("\\road", 5, "ROAD", 4, GLOB_CASELESS));
    CHECK(!glob_matches("roa", 3, "ROAD", 4, GLOB_CASELESS));
}

/* Without recursion, unlike Redis's stringmatchlen, so the time is bounded. */
TEST(glob_many_stars_are_matched_quickly)
{
    char pattern[GLOB_LIMIT], name[64];
    memset(name, 'a', sizeof name);
    for (size_t i = 0; i < sizeof pattern; i++)
        pattern[i] = i % 2 == 0 ? '*' : 'a';
    CHECK(!glob_matches(pattern, sizeof pattern, name, sizeof name, GLOB_CASED));
    pattern[127] = 'b';
    CHECK(!glob_matches(pattern, 128, name, sizeof name, GLOB_CASED));
    CHECK(glob_matches(pattern, 127, name, sizeof name, GLOB_CASED));
}
