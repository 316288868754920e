# rules.mk - what needs more than a C compiler: comparison with CGAL, measurements, lint, fuzzing.

.PHONY: interop bench lint fuzz fuzz_run

CXXCOMPILE = $(CXX) -O2 -g -ffp-contract=off -pthread -I. -Wall -Wextra $(if $(WERROR),-Werror) $(FLAGS_$(V))
FAMILIES  := $(O)/tests/oracle/families.o

$(O)/%.o: %.cpp
	@mkdir -p $(@D)
	$(CXXCOMPILE) -std=c++23 -MMD -MP -c -o $@ $<

# need PACKAGES, TEST: stops with a message unless the shell command TEST succeeds.
need = @{ $(2); } >/dev/null 2>&1 || { echo "make $@ needs the Debian packages: $(1)"; exit 1; }

# ---- interop: every reply equals CGAL's; netcat conversations ----

$(O)/interop/compare: $(addprefix $(O)/tests/,interop/compare.o interop/daemon.o oracle/cgal_delaunay.o) $(FAMILIES)
	@mkdir -p $(@D)
	$(CXXCOMPILE) -o $@ $^ -lgmp -lmpfr

$(O)/tests/bench/points: $(O)/tests/bench/points.o $(FAMILIES)
	$(COMPILE) -o $@ $^ $(LDLIBS)

interop: all
	$(call need,g++ libcgal-dev netcat-openbsd,command -v $(CXX) && command -v nc && \
	  echo '\#include <CGAL/version.h>' | $(CXX) -E -x c++ -)
	@$(MAKE) --no-print-directory $(O)/interop/compare $(O)/tests/bench/points
	tests/interop/run.sh $(O)

# ---- lint ----

lint: $(CORE)
	tests/lint/lint.sh $(O)

# ---- fuzz: every tests/fuzz/NAME_fuzz.c for FUZZ_S seconds, from the corpus tests/fuzz/corpus/NAME if there is one ----

FUZZ_S     ?= 10
FLAGS_fuzz := -O1 -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
FUZZERS    := $(patsubst %.c,$(O)/%,$(wildcard tests/fuzz/*_fuzz.c))

$(FUZZERS): %: %.o $(CORE) $(PROTO) $(filter-out $(O)/server/main.o,$(SERVER))
	$(COMPILE) -fsanitize=fuzzer -o $@ $^ $(LDLIBS)

fuzz:
	$(call need,clang libclang-rt-14-dev,command -v clang)
	@$(MAKE) --no-print-directory V=fuzz CC=clang fuzz_run

fuzz_run: $(FUZZERS)
	@for f in $(FUZZERS); do name=$$(basename $$f _fuzz); work=$(O)/corpus/$$name; mkdir -p $$work; \
	seeds=tests/fuzz/corpus/$$name; [ -d $$seeds ] || seeds=; echo "== $$name"; \
	$$f -max_total_time=$(FUZZ_S) -verbosity=0 -print_final_stats=1 -artifact_prefix=$(O)/$$name- $$work $$seeds || exit 1; done
