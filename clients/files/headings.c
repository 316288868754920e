/* headings.c - see headings.h. */
#include "clients/files/headings.h"

#include <ctype.h>
#include <string.h>

enum { WORD_ROOM = 64 };

static const struct {
    const char *text;
    enum axis axis;
    enum heading_pair pair;
} names[] = {
    {"x", AXIS_X, PAIR_XY},
    {"y", AXIS_Y, PAIR_XY},
    {"abscissa", AXIS_X, PAIR_XY},
    {"ordinate", AXIS_Y, PAIR_XY},
    {"lon", AXIS_X, PAIR_LON_LAT},
    {"lat", AXIS_Y, PAIR_LON_LAT},
    {"lng", AXIS_X, PAIR_LON_LAT},
    {"long", AXIS_X, PAIR_LON_LAT},
    {"longitude", AXIS_X, PAIR_LON_LAT},
    {"latitude", AXIS_Y, PAIR_LON_LAT},
    {"longitud", AXIS_X, PAIR_LON_LAT},
    {"latitud", AXIS_Y, PAIR_LON_LAT},
    {"longitudine", AXIS_X, PAIR_LON_LAT},
    {"latitudine", AXIS_Y, PAIR_LON_LAT},
    {"l\xC3\xA4ngengrad", AXIS_X, PAIR_LON_LAT},
    {"laengengrad", AXIS_X, PAIR_LON_LAT},
    {"breitengrad", AXIS_Y, PAIR_LON_LAT},
    {"e", AXIS_X, PAIR_EAST_NORTH},
    {"n", AXIS_Y, PAIR_EAST_NORTH},
    {"east", AXIS_X, PAIR_EAST_NORTH},
    {"north", AXIS_Y, PAIR_EAST_NORTH},
    {"easting", AXIS_X, PAIR_EAST_NORTH},
    {"northing", AXIS_Y, PAIR_EAST_NORTH},
    {"eastings", AXIS_X, PAIR_EAST_NORTH},
    {"northings", AXIS_Y, PAIR_EAST_NORTH},
    {"rechtswert", AXIS_X, PAIR_EAST_NORTH},
    {"hochwert", AXIS_Y, PAIR_EAST_NORTH},
    {"ostwert", AXIS_X, PAIR_EAST_NORTH},
    {"nordwert", AXIS_Y, PAIR_EAST_NORTH},
    {"rw", AXIS_X, PAIR_EAST_NORTH},
    {"hw", AXIS_Y, PAIR_EAST_NORTH},
    {"ost", AXIS_X, PAIR_EAST_NORTH},
    {"est", AXIS_X, PAIR_EAST_NORTH},
    {"este", AXIS_X, PAIR_EAST_NORTH},
    {"nord", AXIS_Y, PAIR_EAST_NORTH},
    {"norte", AXIS_Y, PAIR_EAST_NORTH},
};

/* Words beside a name that change nothing, and some that may also be joined to it: xcoord, PointX. Longer ones
 * come before those that they begin with. */
static const char *const fillers[] = {
    "m",      "km",      "ft",  "feet", "meter",  "meters", "metre",   "metres", "deg",
    "degree", "dd",      "dec", "epsg", "nad83",  "nad27",  "decimal", "lv95",   "lv03",
    "l93",    "degrees", "bng", "osgb", "etrs89", "gda94",  "itm",     "gk",     "map",
    "proj",   "loc",     "the", "of",   "local",  "world",  "centre",  "center"};
static const char *const joined_fillers[] = {
    "coordinates", "coordinate", "coords", "coord",    "points", "point", "position", "pos",
    "koordinate",  "location",   "wgs84",  "centroid", "utm",    "geo",   "gps",      "lambert93"};

static bool is_word(const char *text, size_t len, const char *word)
{
    return len == strlen(word) && memcmp(text, word, len) == 0;
}

/* A filler, or the number of a coordinate system. */
static bool is_filler(const char *text, size_t len)
{
    for (size_t i = 0; i < sizeof fillers / sizeof fillers[0]; i++)
        if (is_word(text, len, fillers[i]))
            return true;
    size_t digits = 0;
    while (digits < len && isdigit((unsigned char)text[digits]))
        digits++;
    return len >= 4 && digits == len;
}

/* Removes fillers from both ends of a word, which may become empty. */
static void strip(const char **text, size_t *len)
{
    if (is_filler(*text, *len))
        *len = 0;
    for (size_t i = 0; i < sizeof joined_fillers / sizeof joined_fillers[0]; i++) {
        size_t w = strlen(joined_fillers[i]);
        if (*len >= w && memcmp(*text, joined_fillers[i], w) == 0) {
            *text += w;
            *len -= w;
        } else if (*len >= w && memcmp(*text + *len - w, joined_fillers[i], w) == 0) {
            *len -= w;
        }
    }
}

static bool is_letter(char c)
{
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* A new word begins with an upper-case letter after a lower-case one, as in coordX. */
static bool is_hump(char before, char c)
{
    return islower((unsigned char)before) && isupper((unsigned char)c);
}

/* A heading without brackets, separators and fillers, in lower case. */
static size_t reduce(const char *text, size_t len, char *to)
{
    size_t n = 0;
    for (size_t i = 0; i < len;) {
        char word[WORD_ROOM];
        size_t w = 0;
        if (text[i] == '(' || text[i] == '[')
            while (i < len && text[i] != ')' && text[i] != ']')
                i++;
        for (; i < len && is_letter(text[i]) && (w == 0 || !is_hump(text[i - 1], text[i])); i++)
            if (w < WORD_ROOM)
                word[w++] = (char)tolower((unsigned char)text[i]);
        if (w == 0) {
            i++;
            continue;
        }
        const char *rest = word;
        strip(&rest, &w);
        if (n + w > WORD_ROOM)
            return 0;
        memcpy(to + n, rest, w);
        n += w;
    }
    return n;
}

struct heading heading_read(const char *text, size_t len)
{
    char name[WORD_ROOM];
    size_t n = reduce(text, len, name);
    for (size_t i = 0; n > 0 && i < sizeof names / sizeof names[0]; i++)
        if (is_word(name, n, names[i].text))
            return (struct heading){names[i].axis, names[i].pair, n == len};
    return (struct heading){.axis = AXIS_NONE};
}

bool heading_is_height(const char *text, size_t len)
{
    static const char *const heights[] = {"z",           "height",  "elevation", "elev",
                                          "altitude",    "alt",     "depth",     "hoehe",
                                          "h\xC3\xB6he", "altitud", "quota",     "cota"};
    char name[WORD_ROOM];
    size_t n = reduce(text, len, name);
    for (size_t i = 0; i < sizeof heights / sizeof heights[0]; i++)
        if (is_word(name, n, heights[i]))
            return true;
    return false;
}

void heading_search_add(struct heading_search *s, const char *text, size_t len)
{
    struct heading h = heading_read(text, len);
    size_t column = s->columns++;
    if (h.axis == AXIS_NONE)
        return;
    s->column[h.pair][h.axis] = column;
    s->found[h.pair][h.axis]++;
    if (h.plain) {
        s->plain_column[h.pair][h.axis] = column;
        s->plain[h.pair][h.axis]++;
    }
}

bool heading_search_end(const struct heading_search *s, size_t column[2], bool *obvious)
{
    int found = 0, plain = 0, pair = 0;
    for (int i = PAIR_COUNT - 1; i >= 0; i--) { /* backwards: the first pair stays */
        if (s->plain[i][0] == 1 && s->plain[i][1] == 1) {
            plain++;
            pair = i;
        }
        found += s->found[i][0] > 0 && s->found[i][1] > 0;
    }
    *obvious = plain == 1 && found == 1 && s->found[pair][0] == 1 && s->found[pair][1] == 1;
    if (plain > 0) {
        memcpy(column, s->plain_column[pair], sizeof s->plain_column[pair]);
        return true;
    }
    for (int i = 0; found == 1 && i < PAIR_COUNT; i++)
        if (s->found[i][0] == 1 && s->found[i][1] == 1) {
            memcpy(column, s->column[i], sizeof s->column[i]);
            return true;
        }
    return false;
}
