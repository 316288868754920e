/* plot.c - see plot.h. The abscissa is -log10(1 - quantile): a unit to the right for every further
 * nine. The ordinate is log10 of the latency, from 1 microsecond to 10 seconds. */
#include "tests/load/plot.h"

#include <math.h>
#include <stdio.h>

enum { LEFT = 70, TOP = 40, WIDTH = 600, HEIGHT = 350, NINES = 6, DECADES = 7, STEPS = 240 };

static double x_of(double nines)
{
    return LEFT + nines / NINES * WIDTH;
}

static double y_of(double ns)
{
    double decade = log10(ns < 1000 ? 1000 : ns) - 3;
    return TOP + HEIGHT - (decade > DECADES ? DECADES : decade) / DECADES * HEIGHT;
}

static void draw_axes(FILE *f)
{
    static const char *const quantile[NINES + 1] = {"0",       "90 %",     "99 %",     "99.9 %",
                                                    "99.99 %", "99.999 %", "99.9999 %"};
    static const char *const latency[DECADES + 1] = {"1 us",  "10 us",  "100 us", "1 ms",
                                                     "10 ms", "100 ms", "1 s",    "10 s"};
    for (int i = 0; i <= NINES; i++)
        fprintf(f,
                "<path d='M%.1f %d v%d' stroke='#ddd'/><text x='%.1f' y='%d' "
                "text-anchor='middle'>%s</text>\n",
                x_of(i), TOP, HEIGHT, x_of(i), TOP + HEIGHT + 18, quantile[i]);
    for (int i = 0; i <= DECADES; i++) {
        double y = y_of(pow(10, 3 + i));
        fprintf(f,
                "<path d='M%d %.1f h%d' stroke='#ddd'/><text x='%d' y='%.1f' "
                "text-anchor='end'>%s</text>\n",
                LEFT, y, WIDTH, LEFT - 6, y + 4, latency[i]);
    }
}

static void draw_text(FILE *f, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '<' || *text == '&')
            fprintf(f, "&#%d;", *text);
        else
            fputc(*text, f);
    }
}

bool plot_latency(const char *path, const char *title, const struct histogram *h)
{
    FILE *f = fopen(path, "w");
    if (f == NULL) {
        perror(path);
        return false;
    }
    fprintf(f,
            "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' "
            "font-family='sans-serif' font-size='12'>\n<rect width='100%%' height='100%%' "
            "fill='white'/>\n<text x='%d' y='24' font-size='15'>",
            LEFT + WIDTH + 50, TOP + HEIGHT + 40, LEFT);
    draw_text(f, title);
    fputs("</text>\n", f);
    draw_axes(f);
    fputs("<polyline fill='none' stroke='#06c' stroke-width='2' points='", f);
    for (int i = 0; i <= STEPS; i++) {
        double nines = (double)i * NINES / STEPS, left = pow(10, -nines);
        if (i > 0 && left * (double)h->total < 1)
            break; /* nothing to draw beyond the last reply */
        fprintf(f, "%.1f,%.1f ", x_of(nines), y_of((double)histogram_quantile(h, 1 - left)));
    }
    fputs("'/>\n</svg>\n", f);
    bool good = ferror(f) == 0;
    if (fclose(f) != 0 || !good) {
        perror(path);
        return false;
    }
    return true;
}
