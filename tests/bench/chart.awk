# chart.awk - draws the table of families of n points of bench's output as bars: awk -v n=1000000 -f chart.awk bench.md >chart.svg
BEGIN { FS = " *[|] *"; bars = 0; top = 0 }

/^Families/ { inside = $0 ~ " " n " points" }
/^$/ && bars { inside = 0 }

inside && NF > 9 && $3 ~ /^[0-9.]+$/ {
    name[bars] = $2
    ns[bars, 0] = $3
    ns[bars, 1] = $4
    ns[bars, 2] = $6
    for (k = 0; k < 3; k++)
        if (ns[bars, k] + 0 > top)
            top = ns[bars, k] + 0
    bars++
}

function bar(y, value, colour, label) {
    width = value / limit * 420
    clipped = width > 420
    if (clipped)
        width = 420
    printf "<rect x=\"150\" y=\"%d\" width=\"%.1f\" height=\"11\" fill=\"%s\"/>\n", y, width, colour
    printf "<text x=\"%.1f\" y=\"%d\" font-size=\"10\">%s%s</text>\n", 154 + width, y + 10, value, clipped ? " (cut)" : ""
}

END {
    # One family where CGAL is many times slower must not make all others unreadable.
    limit = top < 1500 ? top : 1500
    colour[0] = "#1f5fa8"; colour[1] = "#7fb2e5"; colour[2] = "#c98b3a"
    label[0] = "one thread"; label[1] = "two threads"; label[2] = "CGAL"
    height = 60 + bars * 46
    printf "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"%d\" font-family=\"sans-serif\">\n", height
    printf "<rect width=\"640\" height=\"%d\" fill=\"white\"/>\n", height
    printf "<text x=\"10\" y=\"20\" font-size=\"13\">ns per point, %d points, shorter is better</text>\n", n
    for (k = 0; k < 3; k++) {
        printf "<rect x=\"%d\" y=\"30\" width=\"11\" height=\"11\" fill=\"%s\"/>\n", 150 + 110 * k, colour[k]
        printf "<text x=\"%d\" y=\"40\" font-size=\"11\">%s</text>\n", 166 + 110 * k, label[k]
    }
    for (i = 0; i < bars; i++) {
        printf "<text x=\"10\" y=\"%d\" font-size=\"11\">%s</text>\n", 76 + 46 * i, name[i]
        for (k = 0; k < 3; k++)
            if (ns[i, k] != "-")
                bar(56 + 46 * i + 13 * k, ns[i, k], colour[k])
    }
    print "</svg>"
}
