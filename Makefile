# delaunayd - see README.md. Needs a C compiler and make; targets that need more report what is missing.
#
#   make            the daemon build/delaunayd and the client build/delaunay
#   make test       all base tests; make test T=grid runs those whose name or file contains "grid"; REACTORS=4: with four reactors
#   make demo       triangulates 171,075 real places over TCP, draws cities.svg, terrain.svg, cells.svg, cities-ireland.svg and cities-valley.svg into build/
#   make view       the same places on a live page in the browser; make test_web tests that page in Chromium
#   make site       that page for a static folder, build/site: its sets are in the page, no server is needed
#   make install    programs, libraries, manual pages, completion: PREFIX=/usr/local DESTDIR=; make uninstall
#   make lib        the C libraries, in build/lib and build/include
#   make wasm       the core in WebAssembly for clients/js, which is committed; make test_wasm compares and tests it
#   make V=asan ... the same in build/asan with another variant's flags: asan, tsan, debug
#   make asan       the base tests under the address and undefined behaviour sanitizers; make tsan: the thread sanitizer
#   make faults     kill -9 under load, power cuts, failing disks, thousands of stalled clients
#   make fuzz       parsers, sessions and histories of edits; FUZZ_S=60 runs each for 60 seconds
#   make interop    compares every reply with CGAL's; conversations through netcat and Redis clients
#   make same OLD=PATH/delaunayd  compares every reply with an older build's; POINTS=300000 ONLY="wheel tiny"
#   make mutants    changes random lines of the source and reports what no test notices; N=200 SEED=s draws others
#   make soak       mirrors of a set that is edited a million times, with kills of the daemon, lost connections and pauses
#   make generate   after a change of the table of commands: the parts of the clients that follow from it (Python 3)
#   make lint       dependencies, formatting, static analysis; make fmt formats
#   make bench      ns per point beside CGAL; bench-tables puts it into the documents; also bench-durable, bench-clients,
#                   bench-python, bench-dask, bench-bands, bench-polygons, bench-js
#   make load       throughput and latency under load; also load-beside OTHER=PROGRAM, load-herd, load-watch,
#                   load-follow, stress
#   make clean      removes build/
#   make help       shows this

# As many jobs as processors, unless -j says otherwise.
ifeq ($(MAKELEVEL)$(filter -j%,$(MAKEFLAGS) $(shell echo "$$MAKEFLAGS")),0)
MAKEFLAGS += -j$(shell getconf _NPROCESSORS_ONLN)
endif

V        ?=
O        := build$(if $(V),/$(V))
CFLAGS   ?= -O2 -g
WERROR   ?=
# Handlers and callbacks take what their table or caller gives, so a parameter may be unused.
WARNINGS := -Wall -Wextra -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wcast-qual \
            -Wformat=2 -Wundef -Wwrite-strings -Wdouble-promotion -Wno-unused-parameter $(if $(WERROR),-Werror)
# Contraction to fused multiply-adds would silently break the predicates. When gcc packs the two coordinates of a point into
# one vector, the shuffles cost more than the vector saves (figures in core/divide/divide.c).
# The libraries are made of the same objects, so these are position-independent; inside a program that costs nothing, because calls
# are still inlined and linked directly.
BASE     := -std=c11 -D_GNU_SOURCE -ffp-contract=off -fno-tree-slp-vectorize -fno-common -fPIC -fno-semantic-interposition -pthread -I.
FLAGS_asan  := -g1 -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_tsan  := -g1 -fsanitize=thread
# Levels of optimisation that replace the level of CFLAGS: LEVEL for all code, OUTER_LEVEL for server and clients, TEST_LEVEL for the
# tests, which have -O1 otherwise. Compiling tests takes as long as compiling all the rest, and tests spend little time in their own code. With sanitizers clang
# needs four times as long for -O1 as for -O0, and most of the time of tests is spent in the core and in system calls.
# Without optimisation gcc does not know how large numbers are, and says that texts of them may be cut off.
UNOPTIMISED := -O0 -Wno-format-truncation
LEVEL_asan  := -O1
LEVEL_fuzz  := -O1
LEVEL_tsan  := -O1
LEVEL_musl  := $(UNOPTIMISED)
LEVEL_debug := -O0
OUTER_LEVEL_asan := -O0
OUTER_LEVEL_fuzz := -O0
TEST_LEVEL_asan  := -O0
TEST_LEVEL_musl  := $(UNOPTIMISED)
TEST_LEVEL_tsan  := $(UNOPTIMISED)
TEST_LEVEL_debug := -O0
COMPILE   = $(CC) $(CFLAGS) $(LEVEL_$(V)) $(BASE) $(WARNINGS) $(FLAGS_$(V)) $(EXTRA)
LDLIBS   := -lm

CORE     := $(patsubst %.c,$(O)/%.o,$(wildcard core/*/*.c))
PROTO    := $(patsubst %.c,$(O)/%.o,$(wildcard proto/*.c proto/*/*.c))
SERVER   := $(patsubst %.c,$(O)/%.o,$(wildcard server/*.c server/*/*.c))
CLIENT   := $(patsubst %.c,$(O)/%.o,$(filter-out clients/examples/%,$(wildcard clients/*.c clients/*/*.c)))
HARNESS  := $(O)/tests/test.o $(O)/tests/alloc.o
ORACLE   := $(patsubst %.c,$(O)/%.o,$(wildcard tests/oracle/*.c))
# The simulation of power cuts; the other files of that folder are loaded into a daemon.
CRASH    := $(patsubst %.c,$(O)/%.o,$(filter-out %_shim.c,$(wildcard tests/faults/*.c)))
# ONLY="word word": programs of tests without the files of tests whose paths contain no such word, which then need not be compiled.
left_out  = $(if $(ONLY),$(foreach f,$(filter %_test.c,$(1)),$(if $(strip $(foreach w,$(ONLY),$(findstring $(w),$(f)))),,$(f))))
files_of  = $(wildcard tests/$(1)/*.c tests/$(1)/*/*.c)
tests_of  = $(patsubst %.c,$(O)/%.o,$(filter-out $(call left_out,$(files_of)),$(files_of)))
SUITES   := $(foreach s,server clients core proto,$(if $(call tests_of,$(s)),$(s)))
WRAP     := -fno-builtin-malloc -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free,--wrap=mmap
# The calls by which the server changes files go through tests/server/file_calls.c.
WRAP_FILES := -Wl,--wrap=write,--wrap=fdatasync,--wrap=fsync,--wrap=ftruncate,--wrap=openat,--wrap=renameat,--wrap=linkat,--wrap=unlinkat,--wrap=read,--wrap=readdir,--wrap=posix_fallocate

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all help demo view site test test_binaries $(SUITES:%=test_%) test_plain faults clean asan tsan fmt

all: $(O)/delaunayd $(O)/delaunay

$(O)/delaunayd: $(SERVER) $(CORE) $(PROTO)
$(O)/delaunay: $(CLIENT) $(PROTO)
CORE_TESTS := $(call tests_of,core) $(O)/tests/bench/pivots.o $(HARNESS) $(ORACLE)
$(O)/tests/core_tests: $(CORE_TESTS) $(CORE)
$(O)/tests/plain_tests: $(CORE_TESTS) $(CORE:$(O)/core/memory/pages.o=$(O)/core/memory/plain/pages.o)
$(O)/tests/proto_tests: $(call tests_of,proto) $(HARNESS) $(PROTO)
$(O)/tests/server_tests: $(call tests_of,server) $(CRASH) $(O)/tests/daemon.o $(HARNESS) $(ORACLE) \
  $(filter-out $(O)/server/main.o,$(SERVER)) $(CORE) $(PROTO)
$(O)/tests/clients_tests: $(call tests_of,clients) $(O)/tests/daemon.o $(HARNESS) $(filter-out $(O)/clients/main.o,$(CLIENT)) $(PROTO)
TEST_BINARIES := $(SUITES:%=$(O)/tests/%_tests)
$(TEST_BINARIES) $(O)/tests/plain_tests: LDFLAGS += $(WRAP)
$(O)/tests/core_tests $(O)/tests/plain_tests: LDFLAGS += -Wl,--wrap=dt_stopped,--wrap=mremap
$(O)/tests/server_tests: LDFLAGS += $(WRAP_FILES)

$(O)/delaunayd $(O)/delaunay $(O)/tests/plain_tests $(TEST_BINARIES):
	$(COMPILE) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(foreach s,$(SUITES),$(call tests_of,$(s))) $(HARNESS) $(CRASH): LEVEL_$(V) := $(or $(TEST_LEVEL_$(V)),-O1)
$(SERVER) $(CLIENT): LEVEL_$(V) := $(or $(OUTER_LEVEL_$(V)),$(LEVEL_$(V)))

$(O)/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) -MMD -MP -c -o $@ $<

# The named towns of Ireland as the page shows them, in kilometres.
$(O)/ireland.csv: clients/web/kilometres.awk clients/examples/ireland.csv
	@mkdir -p $(@D) && awk -f $^ >$@

view: all $(O)/ireland.csv
	@clients/web/view.sh $(O)/delaunayd $(O)/delaunay tests/data $(O)/ireland.csv $(O)/web

SITE_MODULES  := $(patsubst clients/web/page/%,%,$(wildcard clients/web/page/*.js clients/web/page/*/*.js)) core.js
SITE_PRELOADS := $(foreach m,$(SITE_MODULES),<link rel="modulepreload" href="$(m)">)<link rel="preload" as="fetch" crossorigin href="ireland.csv">

# The page without a server: a folder of static files, whose sets are in the page.
site: $(O)/ireland.csv
	@rm -rf $(O)/site && mkdir -p $(O)/site && cp -RL clients/web/page/. $(O)/ireland.csv tests/data/cities.xy tests/data/terrain.xyz $(O)/site
	@cp clients/js/browser.js $(O)/site/core.js
	@sed -i -e 's/<html lang="en">/<html lang="en" data-source="local">/' \
	  -e 's|<script type="module"|$(SITE_PRELOADS)&|' $(O)/site/index.html

demo: all
	@clients/demo.sh $(O)/delaunayd $(O)/delaunay tests/data/cities.xy $(O)/cities.svg $(O)/terrain.svg $(O)/cells.svg

# Tests find the daemon and the client through DELAUNAYD and DELAUNAY. With REACTORS=4 it is a daemon that has four reactors on
# any machine, unless --reactors says otherwise.
TESTED := $(if $(REACTORS),$(O)/tests/delaunayd_$(REACTORS),$(O)/delaunayd)
$(O)/tests/delaunayd_%: $(O)/tests/config_%.o $(filter-out $(O)/server/ops/config.o,$(SERVER)) $(CORE) $(PROTO)
	$(COMPILE) $(LDFLAGS) -o $@ $^ $(LDLIBS)
$(O)/tests/config_%.o: server/ops/config.c
	@mkdir -p $(@D)
	$(COMPILE) -DDEFAULT_REACTORS=$* -c -o $@ $<

# Libraries that are loaded into a daemon: a disk that fails on demand, a count of system calls, a disk that records operations.
DISK_SHIM := $(O)/tests/faults/disk_shim.so
SYSCALL_SHIM := $(O)/tests/faults/syscall_shim.so
POWER_SHIM := $(O)/tests/faults/power_shim.so
SHIMS := $(DISK_SHIM) $(SYSCALL_SHIM) $(POWER_SHIM)
FIND_SHIMS := DISK_SHIM=$(DISK_SHIM) SYSCALL_SHIM=$(SYSCALL_SHIM) POWER_SHIM=$(POWER_SHIM)
$(SHIMS): $(O)/%.so: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(BASE) $(WARNINGS) -shared -o $@ $< -ldl

test_binaries: $(TEST_BINARIES) $(if $(filter server clients,$(SUITES)),all $(SHIMS))

# The suites run beside each other, and several tests of each at once; test_core runs only the suite of core/, and so on.
# RUN=PROGRAM runs them under a program, such as an emulator; AT_ONCE=N tests at once in each suite. A word of T must select a test of some suite.
test: test_binaries
	@useless=0; for w in $(T); do for s in $(SUITES); do $(RUN) $(O)/tests/$${s}_tests -l "$$w" >$(O)/tests/selected && continue 2; done; \
	  useless=1; cat $(O)/tests/selected; done; exit $$useless
	@$(MAKE) -k --no-print-directory OF_ANY_SUITE=-a $(SUITES:%=test_%)

test_server test_clients: all $(SHIMS) $(TESTED)
$(SUITES:%=test_%): test_%: $(O)/tests/%_tests
	@echo "== $*"; DELAUNAYD=$(TESTED) DELAUNAY=$(O)/delaunay $(FIND_SHIMS) $(RUN) $(O)/tests/$*_tests $(if $(AT_ONCE),-j $(AT_ONCE)) $(OF_ANY_SUITE) $(T)

# Tests of the core whose large arrays come from malloc, as on systems without mmap.
test_plain: $(O)/tests/plain_tests
	@echo "== plain"; $< $(T)

# Random tests with many more rounds, and tests with thousands of clients.
faults: all $(O)/tests/server_tests $(SHIMS) $(TESTED)
	KILL_ROUNDS=200 POWER_LIVES=8 FAULTS=1 DELAUNAYD=$(TESTED) $(FIND_SHIMS) $(O)/tests/server_tests kill_test disk_test power_ \
	  thousand_readers ten_thousand

# Without that option a process under the thread sanitizer sleeps for a second before it ends.
asan tsan:
	TSAN_OPTIONS=$${TSAN_OPTIONS:-atexit_sleep_ms=50} $(MAKE) V=$@ test

clean:
	rm -rf build

help:
	@sed -n 's/^#   //p' Makefile

fmt:
	clang-format -i $$(git ls-files '*.c' '*.h' '*.cpp')

include tests/rules.mk
include clients/rules.mk
include tests/load/rules.mk
-include $(wildcard $(O)/*/*.d $(O)/*/*/*.d $(O)/*/*/*/*.d)
