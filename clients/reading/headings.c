/* headings.c - see headings.h. */
#include "clients/reading/headings.h"

#include "proto/text.h"

#include <ctype.h>
#include <string.h>

enum { WORD_ROOM = 64 };

/* All without accents, and without fillers: geographische Breite is graphischebreite. */
static const struct {
    const char *text;
    enum axis axis;
    enum heading_pair pair;
} names[] = {
    {"x", AXIS_X, PAIR_XY},
    {"y", AXIS_Y, PAIR_XY},
    {"abscissa", AXIS_X, PAIR_XY},
    {"ordinate", AXIS_Y, PAIR_XY},
    {"abscisse", AXIS_X, PAIR_XY},
    {"ordonnee", AXIS_Y, PAIR_XY},
    {"ascissa", AXIS_X, PAIR_XY},
    {"ordinata", AXIS_Y, PAIR_XY},
    {"lon", AXIS_X, PAIR_LON_LAT},
    {"lat", AXIS_Y, PAIR_LON_LAT},
    {"lng", AXIS_X, PAIR_LON_LAT},
    {"long", AXIS_X, PAIR_LON_LAT},
    {"longitude", AXIS_X, PAIR_LON_LAT},
    {"latitude", AXIS_Y, PAIR_LON_LAT},
    {"lone", AXIS_X, PAIR_LON_LAT},
    {"latn", AXIS_Y, PAIR_LON_LAT},
    {"longitudeeast", AXIS_X, PAIR_LON_LAT},
    {"latitudenorth", AXIS_Y, PAIR_LON_LAT},
    {"longitud", AXIS_X, PAIR_LON_LAT},
    {"latitud", AXIS_Y, PAIR_LON_LAT},
    {"longitudine", AXIS_X, PAIR_LON_LAT},
    {"latitudine", AXIS_Y, PAIR_LON_LAT},
    {"langengrad", AXIS_X, PAIR_LON_LAT},
    {"laengengrad", AXIS_X, PAIR_LON_LAT},
    {"breitengrad", AXIS_Y, PAIR_LON_LAT},
    {"graphischelange", AXIS_X, PAIR_LON_LAT},
    {"graphischebreite", AXIS_Y, PAIR_LON_LAT},
    {"grlange", AXIS_X, PAIR_LON_LAT},
    {"grbreite", AXIS_Y, PAIR_LON_LAT},
    {"lengtegraad", AXIS_X, PAIR_LON_LAT},
    {"breedtegraad", AXIS_Y, PAIR_LON_LAT},
    {"dlugosc", AXIS_X, PAIR_LON_LAT},
    {"szerokosc", AXIS_Y, PAIR_LON_LAT},
    {"dlugoscgraficzna", AXIS_X, PAIR_LON_LAT},
    {"szerokoscgraficzna", AXIS_Y, PAIR_LON_LAT},
    {"zemepisnadelka", AXIS_X, PAIR_LON_LAT},
    {"zemepisnasirka", AXIS_Y, PAIR_LON_LAT},
    {"lengdegrad", AXIS_X, PAIR_LON_LAT},
    {"breddegrad", AXIS_Y, PAIR_LON_LAT},
    {"laengdegrad", AXIS_X, PAIR_LON_LAT},
    {"langdgrad", AXIS_X, PAIR_LON_LAT},
    {"breddgrad", AXIS_Y, PAIR_LON_LAT},
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
    {"rechts", AXIS_X, PAIR_EAST_NORTH},
    {"hoch", AXIS_Y, PAIR_EAST_NORTH},
    {"ostwert", AXIS_X, PAIR_EAST_NORTH},
    {"nordwert", AXIS_Y, PAIR_EAST_NORTH},
    {"rw", AXIS_X, PAIR_EAST_NORTH},
    {"hw", AXIS_Y, PAIR_EAST_NORTH},
    {"ost", AXIS_X, PAIR_EAST_NORTH},
    {"est", AXIS_X, PAIR_EAST_NORTH},
    {"este", AXIS_X, PAIR_EAST_NORTH},
    {"leste", AXIS_X, PAIR_EAST_NORTH},
    {"oost", AXIS_X, PAIR_EAST_NORTH},
    {"wschod", AXIS_X, PAIR_EAST_NORTH},
    {"nord", AXIS_Y, PAIR_EAST_NORTH},
    {"norte", AXIS_Y, PAIR_EAST_NORTH},
    {"noord", AXIS_Y, PAIR_EAST_NORTH},
    {"norr", AXIS_Y, PAIR_EAST_NORTH},
    {"polnoc", AXIS_Y, PAIR_EAST_NORTH},
};

static const char *const heights[] = {"z",
                                      "height",
                                      "elevation",
                                      "elev",
                                      "ele",
                                      "altitude",
                                      "alt",
                                      "hgt",
                                      "hoehe",
                                      "hohe",
                                      "altitud",
                                      "quota",
                                      "cota",
                                      "cote",
                                      "hauteur",
                                      "altezza",
                                      "altura",
                                      "hoogte",
                                      "wysokosc",
                                      "rzedna",
                                      "vyska",
                                      "hojde",
                                      "hoyde",
                                      "hojd",
                                      "korkeus",
                                      "magassag",
                                      "altitudine",
                                      "elevacion",
                                      "elevacao",
                                      "elevazione",
                                      "gelandehohe",
                                      "hohenwert",
                                      "h",
                                      "zvalue",
                                      "dem",
                                      "dtm",
                                      "dgm",
                                      "mnt",
                                      "haut",
                                      "reducedlevel",
                                      "nadmorskavyska",
                                      "topo",
                                      "topography",
                                      "orthoheight",
                                      "heightmsl"};
static const char *const depths[] = {"depth",      "tiefe",        "profondeur", "profundidad",
                                     "profondita", "profundidade", "diepte",     "glebokosc",
                                     "dybde",      "djup",         "hloubka",    "sounding",
                                     "waterdepth", "wassertiefe",  "depthm"};

/* Words beside a name that change nothing, and some that may also be joined to it: xcoord, PointX. Longer ones
 * come before those that they begin with. */
static const char *const fillers[] = {
    "m",       "km",     "ft",     "feet",    "meter", "meters", "metre",  "metres",
    "deg",     "degree", "dd",     "dec",     "epsg",  "nad83",  "nad27",  "decimal",
    "lv95",    "lv03",   "l93",    "degrees", "bng",   "osgb",   "etrs89", "gda94",
    "itm",     "gk",     "map",    "proj",    "loc",   "the",    "of",     "local",
    "world",   "centre", "center", "south",   "west",  "s",      "w",      "nn",
    "nhn",     "nap",    "asl",    "amsl",    "msl",   "masl",   "ground", "surface",
    "terrain", "above",  "sea",    "uber",    "ueber", "mean",   "degs",   "degw"};
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
    while (digits < len && text_is_digit(text[digits]))
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

/* ---- letters ---- */

/* U+00C0 to U+00FF and U+0100 to U+017F without accents; '.' is no letter. */
static const char latin_1[] = "aaaaaaaceeeeiiiidnooooo.ouuuuytsaaaaaaaceeeeiiiidnooooo.ouuuuyty";
static const char extended[] = "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllllll"
                               "lnnnnnnnnnoooooooorrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";

/* A letter or digit, in lower case and without accents; 0 for anything else. */
struct letter {
    char plain;
    bool upper;
    size_t len;
};

static struct letter next_letter(const char *text, size_t len)
{
    unsigned char c = (unsigned char)text[0], d = len > 1 ? (unsigned char)text[1] : 0;
    if (c < 0x80)
        return (struct letter){(char)(isalnum(c) ? tolower(c) : 0), isupper(c) != 0, 1};
    bool utf8 = c >= 0xC2 && c < 0xE0 && (d & 0xC0) == 0x80;
    unsigned code = utf8 ? (unsigned)(c & 0x1F) << 6 | (d & 0x3F) : c;
    char plain = code >= 0xC0 && code < 0x100                          ? latin_1[code - 0xC0]
                 : code >= 0x100 && code - 0x100 + 1 < sizeof extended ? extended[code - 0x100]
                                                                       : 0;
    return (struct letter){(char)(plain == '.' ? 0 : plain), code >= 0xC0 && code < 0xDF,
                           utf8 ? 2 : 1};
}

/* The word at *i, which moves behind it. A new word begins with an upper-case letter after a lower-case one, as in coordX. */
static size_t next_word(const char *text, size_t len, size_t *i, char *word)
{
    size_t w = 0;
    bool upper = true;
    while (*i < len) {
        struct letter l = next_letter(text + *i, len - *i);
        if (l.plain == 0 || (w > 0 && l.upper && !upper))
            break;
        upper = l.upper || !isalpha((unsigned char)l.plain);
        if (w < WORD_ROOM)
            word[w++] = l.plain;
        *i += l.len;
    }
    return w;
}

/* A heading without brackets, separators, accents and fillers, in lower case. */
static size_t reduce(const char *text, size_t len, char *to)
{
    size_t n = 0;
    for (size_t i = 0; i < len;) {
        char word[WORD_ROOM];
        if (text[i] == '(' || text[i] == '[')
            while (i < len && text[i] != ')' && text[i] != ']')
                i++;
        size_t w = i < len ? next_word(text, len, &i, word) : 0;
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

/* Whether one of its words, brackets included, says south or west. */
static bool is_reversed(const char *text, size_t len)
{
    static const char *const words[] = {"s",    "w",   "south", "west",  "degs",
                                        "degw", "sud", "ouest", "ovest", "oeste"};
    for (size_t i = 0; i < len;) {
        char word[WORD_ROOM];
        size_t w = next_word(text, len, &i, word);
        if (w == 0)
            i++;
        for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
            if (is_word(word, w, words[k]))
                return true;
    }
    return false;
}

/* Whether the name of n letters is all of the heading. */
static bool is_plain(const char *text, size_t len, size_t n)
{
    char word[WORD_ROOM];
    size_t i = 0, letters = 0, w;
    while (i < len && (w = next_word(text, len, &i, word)) > 0)
        letters += w;
    return i == len && letters == n;
}

struct heading heading_read(const char *text, size_t len)
{
    char name[WORD_ROOM];
    size_t n = reduce(text, len, name);
    for (size_t i = 0; n > 0 && i < sizeof names / sizeof names[0]; i++)
        if (is_word(name, n, names[i].text))
            return (struct heading){names[i].axis, names[i].pair, is_plain(text, len, n),
                                    is_reversed(text, len)};
    return (struct heading){.axis = AXIS_NONE};
}

char heading_part(const char *text, size_t len, enum axis *axis)
{
    static const char *const parts[] = {"d",       "m",       "s",      "deg",     "min",
                                        "sec",     "degree",  "minute", "second",  "degrees",
                                        "minutes", "seconds", "grad",   "minuten", "sekunden"};
    char name[WORD_ROOM], word[WORD_ROOM];
    size_t at = 0, words = 0, n = 0, w = 0;
    for (*axis = AXIS_NONE; at < len;) {
        if ((w = next_word(text, len, &at, word)) == 0)
            at++;
        else if (++words == 1)
            memcpy(name, word, n = w);
        else
            break;
    }
    for (size_t i = 0; words == 2 && i < sizeof names / sizeof names[0]; i++)
        if (names[i].pair == PAIR_LON_LAT && is_word(name, n, names[i].text))
            *axis = names[i].axis;
    for (size_t i = 0; *axis != AXIS_NONE && i < sizeof parts / sizeof parts[0]; i++)
        if (is_word(word, w, parts[i]))
            return "dms"[i % 3];
    return 0;
}

static bool is_among(const char *text, size_t len, const char *const *list, size_t n)
{
    char name[WORD_ROOM];
    size_t name_len = reduce(text, len, name);
    for (size_t i = 0; i < n; i++)
        if (is_word(name, name_len, list[i]))
            return true;
    return false;
}

bool heading_is_depth(const char *text, size_t len)
{
    return is_among(text, len, depths, sizeof depths / sizeof depths[0]);
}

bool heading_is_height(const char *text, size_t len)
{
    return is_among(text, len, heights, sizeof heights / sizeof heights[0]) ||
           heading_is_depth(text, len);
}

void heading_search_add(struct heading_search *s, size_t column, const char *text, size_t len)
{
    struct heading h = heading_read(text, len);
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
