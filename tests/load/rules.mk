# rules.mk - build/load, the load generator, and `make load`: a short standard set of scenarios, beside redis-server and
# beanstalkd where these are installed.
#
#   make load                        two to three minutes
#   make load LOAD_POINTS=10000000   the size of the set that is triangulated meanwhile (default 1000000)

.PHONY: load

LOAD_POINTS ?= 1000000

all: $(O)/load
LOAD_OBJECTS := $(patsubst %.c,$(O)/%.o,$(wildcard tests/load/*.c)) $(O)/server/ops/histogram.o $(PROTO)
$(O)/load: $(filter-out %/watchers.o,$(LOAD_OBJECTS))
$(O)/watchers: $(filter-out %/load.o,$(LOAD_OBJECTS))
$(O)/load $(O)/watchers:
	$(COMPILE) $(LDFLAGS) -o $@ $^ $(LDLIBS)

load: all
	@tests/load/standard.sh $(O) $(LOAD_POINTS) | tee $(O)/load.md
	@echo "the tables are in $(O)/load.md, drawings in $(O)/load-*.svg"

# Throughput beside another daemon, such as that of an earlier version, in alternating runs: three minutes.
#
#   make load-beside OTHER=../before/build/delaunayd
.PHONY: load-beside
load-beside: all
	@tests/load/beside.sh $(O) $(or $(OTHER),$(error OTHER=PROGRAM is missing))

# Throughput by the number of reactors, from 1 to half of the processors; the other half generates the load.
#
#   make load-reactors REACTORS_OF="1 2 4 8" GENERATORS=8
.PHONY: load-reactors
HALF := $(shell n=$$(getconf _NPROCESSORS_ONLN); echo $$(((n + 1) / 2)))
GENERATORS ?= $(HALF)
REACTORS_OF ?= $(shell n=1; while [ $$n -lt $(HALF) ]; do echo $$n; n=$$((2 * n)); done; echo $(HALF))
load-reactors: all
	@tests/load/reactors.sh $(O) "$(REACTORS_OF)" $(GENERATORS) | tee $(O)/load-reactors.md

# The time of a stranger's PING beside 1,000 clients that all ask at the same moment: a minute.
#
#   make load-herd REACTORS=4
.PHONY: load-herd
load-herd: all
	@tests/load/herd.sh $(O) $(or $(REACTORS),1) | tee $(O)/load-herd.md

# Mirrors of a set that is edited at random, with kills of the daemon, lost connections and pauses: up to half an hour.
#
#   make soak EDITS=1000000 SEEDS=100
.PHONY: soak
EDITS ?= 1000000
SEEDS ?= 100
soak: all
	@python3 tests/interop/mirrors.py $(O) --edits $(EDITS) --seeds $(SEEDS)

# The cost of WATCH: how soon events come, alone and for 200 watchers; inserts with and without a watcher; memory of watchers
# that do not read: three minutes.
#
#   make load-watch POINTS=1000000 LARGE=10000000
.PHONY: load-watch
load-watch: all $(O)/watchers
	@python3 tests/load/watch.py $(O) --points $(or $(POINTS),1000000) --large $(LARGE)

# The cost of following: catching up, the lag, and inserts with and without a follower: two minutes.
.PHONY: load-follow
load-follow: all
	@python3 tests/load/follow.py $(O)

# The effect of single expensive requests on other clients, and of stress on memory: four minutes.
#
#   make stress SCENARIOS=hub LARGE=1000000
.PHONY: stress
LARGE ?= 10000000
stress: all $(DISK_SHIM)
	@python3 tests/load/stress.py --large $(LARGE) $(O)/delaunayd $(SCENARIOS)
