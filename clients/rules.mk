# rules.mk - two libraries, static and shared, each with one header: the client library, and the core for programs that
# triangulate in process; `make install`.
#
#   make lib             build/lib and build/include
#   make install         PREFIX=/usr/local DESTDIR=
#   make generate        the parts of the clients that follow from the daemon's table of commands
#   make uninstall       removes the installed files; PREFIX and DESTDIR as for install

.PHONY: lib generate install uninstall

PREFIX      ?= /usr/local
VERSION     := $(shell sed -n 's/.*DELAUNAY_VERSION "\(.*\)".*/\1/p' proto/version.h)

# Line editing at the prompt, with libedit or readline if one of them is installed; LINE_EDITING= builds without.
can_link = $(shell echo 'int main(void) { return readline("") == 0; }' | \
             $(CC) -include stdio.h -include $(1) -x c - -o /dev/null $(2) >/dev/null 2>&1 && echo yes)
LINE_EDITING ?= $(if $(call can_link,editline/readline.h,-ledit),edit,$(if $(call can_link,readline/readline.h,-lreadline),readline))
EDIT_DEFINE   = $(if $(filter edit,$(CHOSEN_EDITING)),-DHAVE_EDITLINE,$(if $(filter readline,$(CHOSEN_EDITING)),-DHAVE_READLINE))
# Determined once, and only when something that needs it is compiled or linked.
CHOSEN_EDITING = $(eval CHOSEN_EDITING := $(LINE_EDITING))$(CHOSEN_EDITING)
$(O)/clients/cli/line_editor.o: COMPILE += $(EDIT_DEFINE)
$(O)/delaunay $(O)/tests/clients_tests: LDLIBS += $(if $(CHOSEN_EDITING),-l$(CHOSEN_EDITING))

LIBRARIES := delaunay delaunay-core
HEADERS   := delaunay_client.h delaunay_core.h
LIB_FILES := $(LIBRARIES:%=lib%.a) $(LIBRARIES:%=lib%.so.0)

lib: $(LIB_FILES:%=$(O)/lib/%) $(HEADERS:%=$(O)/include/%) $(LIBRARIES:%=$(O)/lib/pkgconfig/%.pc)

# The public headers of each library are installed as one; both begin with the version.
CORE_HEADERS := proto/version.h core/delaunay.h core/delaunay_fields.h core/delaunay_constraints.h core/delaunay_surface.h \
                core/delaunay_thinning.h core/delaunay_arrays.h core/delaunay_tiles.h
CLIENT_HEADERS := proto/version.h clients/lib/delaunay_client.h clients/lib/delaunay_mirror.h
$(O)/include/delaunay_client.h: $(CLIENT_HEADERS)
$(O)/include/delaunay_core.h: $(CORE_HEADERS)
$(HEADERS:%=$(O)/include/%):
	@mkdir -p $(@D)
	{ echo '#pragma once'; sed '/^#include "/d; /^#pragma once/d' $^; } >$@

# A library exports the functions of its header, and no other name.
$(O)/lib/libdelaunay.names: $(CLIENT_HEADERS)
$(O)/lib/libdelaunay-core.names: $(CORE_HEADERS)
$(LIBRARIES:%=$(O)/lib/lib%.names):
	@mkdir -p $(@D)
	grep -ohE '\b(delaunay|dt)_[a-z0-9_]+\(' $^ | tr -d '(' | sort -u >$@

$(O)/lib/lib%.map: $(O)/lib/lib%.names
	{ echo 'DELAUNAY_0 { global:'; sed 's/$$/;/' $<; echo 'local: *; };'; } >$@

CLIENT_LIBRARY := clients/lib/delaunay_client.o clients/lib/delaunay_mirror.o clients/lib/mirror_copy.o clients/lib/mirror_constraints.o \
                  clients/lib/connect.o clients/lib/url.o \
                  $(addprefix proto/,buf.o reply_read.o request.o number_read.o number_write.o powers.o)
$(O)/lib/libdelaunay.a $(O)/lib/libdelaunay.so.0: $(addprefix $(O)/,$(CLIENT_LIBRARY))
$(O)/lib/libdelaunay-core.a $(O)/lib/libdelaunay-core.so.0: $(CORE)

$(O)/lib/lib%.a: $(O)/lib/lib%.names
	$(LD) -r -o $(O)/lib/$*.o $(filter %.o,$^)
	objcopy --keep-global-symbols=$< $(O)/lib/$*.o
	rm -f $@ && ar rcs $@ $(O)/lib/$*.o

$(O)/lib/lib%.so.0: $(O)/lib/lib%.map
	$(COMPILE) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,--version-script,$< -o $@ $(filter %.o,$^) $(LDLIBS)
	ln -sf $(@F) $(@:.0=)

pc_of = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' clients/lib/$(1).pc.in

$(O)/lib/pkgconfig/%.pc: clients/lib/%.pc.in Makefile
	@mkdir -p $(@D)
	$(call pc_of,$*) >$@

# ---- what follows from the table of commands; the files are committed, and `make lint` compares them ----

generate: $(O)/delaunayd
	clients/generate/generate.py $<

# ---- install ----

INTO       = $(DESTDIR)$(PREFIX)
COMPLETION = bash:bash-completion/completions/delaunay zsh:zsh/site-functions/_delaunay fish:fish/vendor_completions.d/delaunay.fish
INSTALLED := bin/delaunayd bin/delaunay $(HEADERS:%=include/%) $(LIB_FILES:%=lib/%) $(LIBRARIES:%=lib/lib%.so) \
             $(LIBRARIES:%=lib/pkgconfig/%.pc) share/man/man1/delaunay.1 share/man/man8/delaunayd.8 share/doc/delaunayd/PROTOCOL.md \
             $(foreach c,$(COMPLETION),share/$(lastword $(subst :, ,$(c))))

install: all lib
	install -d $(sort $(dir $(INSTALLED:%=$(INTO)/%)))
	install $(O)/delaunayd $(O)/delaunay $(INTO)/bin
	install -m 644 $(HEADERS:%=$(O)/include/%) $(INTO)/include
	install -m 644 $(LIB_FILES:%=$(O)/lib/%) $(INTO)/lib
	$(foreach l,$(LIBRARIES),ln -sf lib$(l).so.0 $(INTO)/lib/lib$(l).so && $(call pc_of,$(l)) >$(INTO)/lib/pkgconfig/$(l).pc &&) true
	install -m 644 man/delaunay.1 $(INTO)/share/man/man1
	install -m 644 man/delaunayd.8 $(INTO)/share/man/man8
	install -m 644 proto/PROTOCOL.md $(INTO)/share/doc/delaunayd
	$(foreach c,$(COMPLETION),$(O)/delaunay completion $(subst :, >$(INTO)/share/,$(c)) &&) true

uninstall:
	rm -f $(INSTALLED:%=$(INTO)/%)

# ---- the npm package, with the daemon's binary: build/npm/delaunayd-VERSION.tgz ----

.PHONY: npm
npm: all
	$(call need,nodejs npm,command -v npm)
	@rm -rf $(O)/npm && mkdir -p $(O)/npm/package/bin
	@cp -r clients/js/*.js clients/js/*.mjs clients/js/*.ts clients/js/*.mts clients/js/*.json clients/js/*.html clients/js/README.md clients/js/lib LICENSE $(O)/npm/package
	@install $(O)/delaunayd $(O)/npm/package/bin
	@cd $(O)/npm/package && npm pack --silent --pack-destination ..

# ---- wasm: the core for JavaScript, in the npm package's lib/module.js and browser.js, which are committed; so only who changes the
# ---- core needs clang for it. bundle: browser.js alone, after a change of the JavaScript in it ----

WASM_CC      ?= clang-14
WASM_SOURCES := clients/js/wasm/doors.c core/memory/plain/pages.c \
                $(filter-out core/memory/pages.c core/arrays/% core/tiles/%,$(wildcard core/*/*.c))
WASM_SMALL   := $(filter $(addprefix core/constraints/,constraints.c crossings.c declared.c history.c regions.c regions_find.c regions_find_one.c) core/shelling/% core/set/view% core/set/before_images.c core/set/check.c core/exact/bignum.c \
                  core/edit/constrain.c core/edit/polygon.c core/edit/triangulate.c core/hints/hints_plan.c core/edit/edit_constrained.c core/edit/remove_fixed.c core/edit/memory_bounds.c core/edit/restore.c \
                  core/triangle/% core/contours/levels.c core/exact/degrees.c core/exact/sum.c core/surface/alpha.c core/surface/outside.c core/surface/smooth.c core/surface/weights.c core/fields/column.c core/edit/edit.c core/points/aliases.c core/query/sweep.c core/query/nearest_fixed.c core/edit/remove_large.c core/set/hints_rebuild.c,$(WASM_SOURCES))
WASM_FLAGS   := --target=wasm32-wasi -DNDEBUG -msimd128 -mbulk-memory -mnontrapping-fptoint -msign-ext -std=c11 -D_GNU_SOURCE -ffp-contract=off -I. $(filter-out -Wmissing-prototypes,$(WARNINGS))
WASM_LINK    := -mexec-model=reactor -nostartfiles -Wl,--no-entry,--gc-sections,--strip-all,--export=malloc,--export=free \
                -Wl,--stack-first,-z,stack-size=1048576
WASM_OBJECTS := $(WASM_SOURCES:%.c=$(O)/wasm/%.o)

# Functions that hot loops do not call are compiled for size. test_wasm limits the size of the module.
.PHONY: wasm bundle test_wasm
$(WASM_OBJECTS): WASM_LEVEL := -O2
$(WASM_SMALL:%.c=$(O)/wasm/%.o): WASM_LEVEL := -Oz
$(WASM_OBJECTS): $(O)/wasm/%.o: %.c $(wildcard core/*.h core/*/*.h) clients/rules.mk
	$(call need,clang-14 lld-14 wasi-libc libclang-rt-14-dev-wasm32,command -v $(WASM_CC) wasm-ld-14 && [ -d /usr/include/wasm32-wasi ])
	@mkdir -p $(@D)
	$(WASM_CC) $(WASM_FLAGS) $(WASM_LEVEL) -c -o $@ $<

$(O)/wasm/core.wasm: $(WASM_OBJECTS)
	$(WASM_CC) --target=wasm32-wasi $(WASM_LINK) -o $@ $(WASM_OBJECTS)

wasm: $(O)/wasm/core.wasm
	node clients/js/wasm/bundle.mjs $< "$$($(WASM_CC) --version | head -n 1)"

bundle:
	node clients/js/wasm/bundle.mjs

# The module of a fresh build has the bytes of the committed one, if it is from the same compiler, and passes the tests.
test_wasm: $(O)/wasm/core.wasm $(O)/delaunayd
	clients/js/wasm/check.sh $(O) "$$($(WASM_CC) --version | head -n 1)"

# ---- bench-js: what runs in process beside delaunator, d3-delaunay and earcut, which npm fetches; earcut_fixtures has earcut's test polygons ----

.PHONY: bench-js
bench-js:
	$(call need,nodejs npm,command -v npm)
	@[ -d $(O)/npm_bench/node_modules/earcut_fixtures ] || \
	  npm install --prefix $(O)/npm_bench --no-save --no-audit --no-fund --ignore-scripts --silent delaunator@5.1.0 d3-delaunay@6.0.6 \
	    earcut@3.2.4 earcut_fixtures@npm:earcut@1.4.2
	@node tests/bench/beside_delaunator.mjs $(O)/npm_bench
	@node tests/bench/beside_earcut.mjs $(O)/npm_bench
