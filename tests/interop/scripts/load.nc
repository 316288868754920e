LOAD survey
# a comment and a blank line are no points

0 0
10 0
.5e1 1e1
5 3
5	3.0
.
triangulate survey
Triangles survey
POINTS survey
COINCIDENT survey
LOAD survey 2
-1 -1
0.1 0.30000000000000004
GET survey 5 6
EDGES survey 3
HULL survey CW
