# rules.mk - the client library, static and shared, with its one header; `make install`.
#
#   make lib             build/lib/libdelaunay.a, build/lib/libdelaunay.so.0, build/include/delaunay_client.h
#   make install         PREFIX=/usr/local DESTDIR=

.PHONY: lib install

PREFIX      ?= /usr/local
VERSION     := $(shell sed -n 's/.*DELAUNAYD_VERSION "\(.*\)".*/\1/p' server/ops/config.h)
LIB_SOURCES := clients/lib/delaunay_client.c proto/buf.c proto/reply_read.c proto/request.c
PIC         := $(LIB_SOURCES:%.c=$(O)/pic/%.o)

$(O)/clients/main.o: COMPILE += -DDELAUNAY_VERSION='"$(VERSION)"'

# Line editing at the prompt, with whichever library is there; LINE_EDITING= builds without. Neither is needed.
can_link = $(shell echo 'int main(void) { return readline("") == 0; }' | \
             $(CC) -include stdio.h -include $(1) -x c - -o /dev/null $(2) >/dev/null 2>&1 && echo yes)
LINE_EDITING ?= $(if $(call can_link,editline/readline.h,-ledit),edit,$(if $(call can_link,readline/readline.h,-lreadline),readline))
EDIT_DEFINE   = $(if $(filter edit,$(CHOSEN_EDITING)),-DHAVE_EDITLINE,$(if $(filter readline,$(CHOSEN_EDITING)),-DHAVE_READLINE))
# Found out once, and only when something is compiled or linked that asks for it.
CHOSEN_EDITING = $(eval CHOSEN_EDITING := $(LINE_EDITING))$(CHOSEN_EDITING)
$(O)/clients/cli/edit.o: COMPILE += $(EDIT_DEFINE)
$(O)/delaunay $(O)/tests/clients_tests: LDLIBS += $(if $(CHOSEN_EDITING),-l$(CHOSEN_EDITING))

lib: $(O)/lib/libdelaunay.a $(O)/lib/libdelaunay.so.0 $(O)/include/delaunay_client.h $(O)/lib/pkgconfig/delaunay.pc

$(O)/pic/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) -fPIC -MMD -MP -c -o $@ $<

$(O)/lib/libdelaunay.a: $(PIC)
	@mkdir -p $(@D)
	rm -f $@ && ar rcs $@ $^

$(O)/lib/libdelaunay.so.0: $(PIC) clients/lib/delaunay.map
	@mkdir -p $(@D)
	$(COMPILE) -shared -Wl,-soname,libdelaunay.so.0 -Wl,--version-script,clients/lib/delaunay.map -o $@ $(PIC)
	ln -sf libdelaunay.so.0 $(O)/lib/libdelaunay.so

# One header: that of the replies is put in place of its #include.
$(O)/include/delaunay_client.h: clients/lib/delaunay_client.h proto/reply_read.h
	@mkdir -p $(@D)
	sed -e '/#include "proto\/reply_read.h"/{r proto/reply_read.h' -e 'd}' clients/lib/delaunay_client.h >$@

$(O)/lib/pkgconfig/delaunay.pc: clients/lib/delaunay.pc.in Makefile
	@mkdir -p $(@D)
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' $< >$@

install: all lib
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin include lib/pkgconfig share/bash-completion/completions)
	install $(O)/delaunayd $(O)/delaunay $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(O)/include/delaunay_client.h $(DESTDIR)$(PREFIX)/include
	install -m 644 $(O)/lib/libdelaunay.a $(O)/lib/libdelaunay.so.0 $(DESTDIR)$(PREFIX)/lib
	ln -sf libdelaunay.so.0 $(DESTDIR)$(PREFIX)/lib/libdelaunay.so
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' clients/lib/delaunay.pc.in \
	  >$(DESTDIR)$(PREFIX)/lib/pkgconfig/delaunay.pc
	install -d $(addprefix $(DESTDIR)$(PREFIX)/share/man/,man1 man8)
	install -m 644 man/delaunay.1 $(DESTDIR)$(PREFIX)/share/man/man1
	install -m 644 man/delaunayd.8 $(DESTDIR)$(PREFIX)/share/man/man8
	install -d $(addprefix $(DESTDIR)$(PREFIX)/share/,zsh/site-functions fish/vendor_completions.d)
	$(O)/delaunay completion bash >$(DESTDIR)$(PREFIX)/share/bash-completion/completions/delaunay
	$(O)/delaunay completion zsh >$(DESTDIR)$(PREFIX)/share/zsh/site-functions/_delaunay
	$(O)/delaunay completion fish >$(DESTDIR)$(PREFIX)/share/fish/vendor_completions.d/delaunay.fish

# ---- the npm package, with the daemon's binary: build/npm/delaunayd-VERSION.tgz ----

.PHONY: npm
npm: all
	$(call need,nodejs npm,command -v npm)
	@rm -rf $(O)/npm && mkdir -p $(O)/npm/package/bin
	@cp -r clients/js/*.js clients/js/*.mjs clients/js/*.ts clients/js/*.mts clients/js/*.json clients/js/README.md clients/js/lib LICENSE $(O)/npm/package
	@install $(O)/delaunayd $(O)/npm/package/bin
	@cd $(O)/npm/package && npm pack --silent --pack-destination ..

# ---- interop: other people's clients, and ours in other languages ----

$(O)/interop/hiredis_talk: tests/interop/hiredis_talk.c
	@mkdir -p $(@D)
	$(CC) -O2 -std=c11 -Wall -Wextra -o $@ $< -lhiredis

.PHONY: interop_clients
interop: interop_clients
interop_clients: all lib
	$(call need,redis-tools libhiredis-dev python3-redis python3-numpy python3-scipy python3-matplotlib python3-pytest python3-pip nodejs haproxy netcat-openbsd, \
	  command -v redis-cli && command -v node && command -v haproxy && command -v nc && \
	  /usr/bin/python3 -c 'import redis, numpy, scipy, matplotlib, pip, pytest')
	@$(MAKE) --no-print-directory $(O)/interop/hiredis_talk
	tests/interop/clients.sh $(O)
	$(if $(shell command -v npm),$(MAKE) --no-print-directory npm && tests/interop/node/package.sh $(O),@echo "no npm, so no test of the npm package")
