/* headings.c - see headings.h. */
#include "clients/reading/headings.h"

#include "clients/reading/word_list.h"
#include "proto/text.h"

#include <ctype.h>
#include <string.h>

enum { WORD_ROOM = 64 };

/* All without accents, and without fillers: geographische Breite is graphischebreite. */
static const struct {
    enum axis axis;
    enum heading_pair pair;
    const char *words;
} names[] = {
    {AXIS_X, PAIR_XY, "x abscissa abscisse ascissa"},
    {AXIS_Y, PAIR_XY, "y ordinate ordonnee ordinata"},
    {AXIS_X, PAIR_LON_LAT,
     "lon lng long longitude lone longitudeeast longitud longitudine langengrad laengengrad "
     "graphischelange grlange lengtegraad dlugosc dlugoscgraficzna zemepisnadelka lengdegrad "
     "laengdegrad langdgrad"},
    {AXIS_Y, PAIR_LON_LAT,
     "lat latitude latn latitudenorth latitud latitudine breitengrad graphischebreite grbreite "
     "breedtegraad szerokosc szerokoscgraficzna zemepisnasirka breddegrad breddgrad"},
    {AXIS_X, PAIR_EAST_NORTH,
     "e east easting eastings rechtswert rechts ostwert rw ost est este leste oost wschod"},
    {AXIS_Y, PAIR_EAST_NORTH,
     "n north northing northings hochwert hoch nordwert hw nord norte noord norr polnoc"},
};

static const char heights[] =
    "z height elevation elev ele altitude alt hgt hoehe hohe altitud quota cota cote hauteur "
    "altezza altura hoogte wysokosc rzedna vyska hojde hoyde hojd korkeus magassag altitudine "
    "elevacion elevacao elevazione gelandehohe hohenwert h zvalue dem dtm dgm mnt haut "
    "reducedlevel nadmorskavyska topo topography orthoheight heightmsl";
static const char depths[] =
    "depth tiefe profondeur profundidad profondita profundidade diepte glebokosc dybde djup "
    "hloubka sounding waterdepth wassertiefe depthm";

/* Words beside a name that change nothing, and some that may also be joined to it: xcoord, PointX. Longer ones
 * come before those that they begin with. */
static const char fillers[] =
    "m km ft feet meter meters metre metres deg degree dd dec epsg nad83 nad27 decimal lv95 lv03 "
    "l93 degrees bng osgb etrs89 gda94 itm gk map proj loc the of local world centre center "
    "south west s w nn nhn nap asl amsl msl masl ground surface terrain above sea uber ueber "
    "mean degs degw";
static const char joined_fillers[] =
    "coordinates coordinate coords coord points point position pos koordinate location wgs84 "
    "centroid utm geo gps lambert93";

/* A filler, or the number of a coordinate system. */
static bool is_filler(const char *text, size_t len)
{
    size_t digits = 0;
    while (digits < len && text_is_digit(text[digits]))
        digits++;
    return (len >= 4 && digits == len) || word_list_has(fillers, text, len);
}

/* Removes fillers from both ends of a word, which may become empty. */
static void strip(const char **text, size_t *len)
{
    const char *list = joined_fillers;
    size_t w;
    if (is_filler(*text, *len))
        *len = 0;
    for (const char *word; (word = word_list_next(&list, &w)) != NULL;) {
        if (*len >= w && memcmp(*text, word, w) == 0) {
            *text += w;
            *len -= w;
        } else if (*len >= w && memcmp(*text + *len - w, word, w) == 0) {
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
    for (size_t i = 0; i < len;) {
        char word[WORD_ROOM];
        size_t w = next_word(text, len, &i, word);
        if (w == 0)
            i++;
        else if (word_list_has("s w south west degs degw sud ouest ovest oeste", word, w))
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
        if (word_list_has(names[i].words, name, n))
            return (struct heading){names[i].axis, names[i].pair, is_plain(text, len, n),
                                    is_reversed(text, len)};
    return (struct heading){.axis = AXIS_NONE};
}

char heading_part(const char *text, size_t len, enum axis *axis)
{
    static const char *const parts[] = {"d deg degree degrees grad", "m min minute minutes minuten",
                                        "s sec second seconds sekunden"};
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
        if (names[i].pair == PAIR_LON_LAT && word_list_has(names[i].words, name, n))
            *axis = names[i].axis;
    for (size_t i = 0; *axis != AXIS_NONE && i < sizeof parts / sizeof parts[0]; i++)
        if (word_list_has(parts[i], word, w))
            return "dms"[i];
    return 0;
}

static bool is_among(const char *text, size_t len, const char *list)
{
    char name[WORD_ROOM];
    size_t n = reduce(text, len, name);
    return word_list_has(list, name, n);
}

bool heading_is_depth(const char *text, size_t len)
{
    return is_among(text, len, depths);
}

bool heading_is_height(const char *text, size_t len)
{
    return is_among(text, len, heights) || heading_is_depth(text, len);
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
