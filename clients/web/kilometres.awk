# kilometres.awk - turns a table `name,lon,lat` of places near Ireland into `name,x,y`: kilometres east and north of 53.5 N, 8 W, on a
# sphere of 6371 km.
BEGIN {
    FS = OFS = ","
    degree = atan2(0, -1) / 180
    print "name,x,y"
}
NR > 1 {
    print $1, sprintf("%.2f", ($2 + 8) * degree * 6371 * cos(53.5 * degree)), sprintf("%.2f", ($3 - 53.5) * degree * 6371)
}
