# Oriel. Plain `make` leaves build/oriel (the command) and build/orield (the daemon).
# `make help` lists the targets.

BUILD   ?= build
CC      ?= cc
MODE    ?= release
JOBS    ?= $(shell nproc)
WERROR  ?= -Werror

# Debian packages: what the build needs, and what the checks need beyond that.
PACKAGES_BUILD := gcc libc6-dev make libembree-dev libmicrohttpd-dev libjansson-dev libuv1-dev \
	libsqlite3-dev libexpat1-dev libpng-dev libtiff-dev zlib1g-dev libsodium-dev libcurl4-openssl-dev libopenexr-dev \
	libgnutls28-dev nettle-dev libxxhash-dev libarchive-dev libmd4c-html0-dev libjs-chart.js python3 python3-yaml
# Node and npm where there are none: others than Debian's do.
PACKAGES_CHECK := $(PACKAGES_BUILD) libcmocka-dev curl python3-numpy python3-pip python3-setuptools \
	python3-wheel valgrind slurm-wlm munge mandoc $(if $(shell command -v node),,nodejs)
PACKAGES_BROWSER := chromium $(if $(shell command -v node),,nodejs) $(if $(shell command -v npm),,npm)
PACKAGES_LINT  := $(PACKAGES_CHECK) clang clang-tidy clang-format mypy pyflakes3
PACKAGES_DEMO  := $(PACKAGES_BUILD)
PACKAGES_PERF  := $(PACKAGES_CHECK) wrk
PACKAGES_FUZZ  := $(PACKAGES_BUILD) clang llvm libclang-rt-14-dev

WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes \
	-Wmissing-prototypes -Wvla -Wformat=2 -Wundef -fno-common
# No option here may change what a floating-point expression means: results are compared by bytes.
OPT_release := -O3 -fno-math-errno -fno-trapping-math
# Assertions on the program's own invariants (ORL_DEBUG) are in the builds for tests alone.
OPT_asan    := -O1 -DORL_DEBUG -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT_tsan    := -O1 -DORL_DEBUG -fsanitize=thread -fno-omit-frame-pointer
# Counts that threads lose tell the same lines; counting them all takes three times as long.
OPT_cover   := -O1 --coverage -fprofile-update=single
OPT_fuzz    := $(OPT_asan) -fsanitize=fuzzer-no-link
STD      := -std=c17 -D_GNU_SOURCE -ffp-contract=off -g
CFLAGS   ?=
ALL_CFLAGS = $(STD) $(WARNINGS) $(WERROR) $(OPT_$(MODE)) $(CFLAGS) -pthread
ALL_LDFLAGS = $(OPT_$(MODE)) -Wl,--build-id $(LDFLAGS) -pthread

# Embree 3 on Debian 12, 4 on later releases; core/scene/geometry/embree.c serves both.
EMBREE_LIB := $(if $(wildcard /usr/include/embree4/rtcore.h),-lembree4,-lembree3)
# Debian 12's library has its version in its name, later ones have not.
EXR_LIB := $(if $(wildcard /usr/lib/*/libOpenEXRCore.so),-lOpenEXRCore,-lOpenEXRCore-3_1)
CORE_LIBS   := $(EMBREE_LIB) -lexpat -lpng -ltiff -lz $(EXR_LIB) -lsodium -lnettle -ljansson -lm
SERVER_LIBS := -lmicrohttpd -lgnutls -luv -lsqlite3 -larchive -lmd4c-html
CLIENT_LIBS := -lcurl

CORE_SRC   := $(sort $(wildcard core/*/*.c core/*/*/*.c core/*/*/*/*.c))
API_SRC    := $(sort $(wildcard api/*.c api/*/*.c))
SERVER_SRC := $(sort $(wildcard server/*.c server/*/*.c server/*/*/*.c))
CLIENT_SRC := $(sort $(wildcard client/*.c client/*/*.c))
FUZZ_TARGETS := $(patsubst tests/fuzz/%.c,%,$(sort $(wildcard tests/fuzz/fuzz_*.c)))
# Programs of tests/bench; the rest there is shared.
BENCH_SRC  := $(patsubst %,tests/bench/%.c,speed scale table2 gallery calibration annual \
	eta_course polygons hello)
SUPPORT_SRC := $(sort $(wildcard tests/support/*.c) $(FUZZ_TARGETS:%=tests/fuzz/%.c) \
	tests/fuzz/promise.c $(filter-out $(BENCH_SRC),$(wildcard tests/bench/*.c)))
TEST_SUITES := unit stats validation stability api migrations
TEST_SRC   := $(sort $(foreach s,$(TEST_SUITES),$(wildcard tests/$(s)/test_*.c)))

# Where objects outside the core are: the build with counters has none of its own.
OTHERS     ?= $(BUILD)
# Boundaries by include path: only the core sees its own internals.
INC_core    := -Icore/include -iquote core
INC_api     := -Icore/include -iquote api -iquote $(OTHERS)/generated
INC_server  := -Icore/include -iquote api -iquote server -iquote $(OTHERS)/generated
INC_client  := -Icore/include -iquote api -iquote client -iquote $(OTHERS)/generated
INC_tests   := -Icore/include -iquote core -iquote api -iquote server -iquote tests \
	-iquote $(OTHERS)/generated

obj = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))
other = $(patsubst %.c,$(OTHERS)/obj/%.o,$(1))
CORE_OBJ   := $(call obj,$(CORE_SRC))
API_OBJ    := $(call other,$(API_SRC)) $(OTHERS)/obj/generated/schemas.o
SERVER_OBJ := $(call other,$(SERVER_SRC))
CLIENT_OBJ := $(call other,$(CLIENT_SRC))
SUPPORT_OBJ := $(call other,$(SUPPORT_SRC))
SERVER_LIB_OBJ := $(filter-out %/server/main.o,$(SERVER_OBJ))
TEST_BIN   := $(patsubst tests/%.c,$(BUILD)/tests/%,$(TEST_SRC))

.PHONY: all help clean check demo torture lint format asan tsan bench bench-scale bench-polygons load dashboards check-perf table2 gallery \
	calibration annual study tests deps-build deps-check deps-browser deps-lint deps-demo deps-perf deps-fuzz fuzz fuzzers stability cie171 oracles FORCE
all: $(BUILD)/oriel $(BUILD)/orield

help:
	@sed -n 's/^## //p' $(firstword $(MAKEFILE_LIST))

## make            build/oriel and build/orield
## make demo       install what is needed, then upload, render and show the paper's office
## make check      install what is needed, build what changed, run every test; ends with
##                 "N passed, N failed"
## make long       the same tests with all their seeds and cases (ORIEL_LONG=1); about an hour of a processor
## make reference  the guide's pages about job documents and results, from api/schema
## make openapi-lint  the OpenAPI document by a public validator, from npm
## make generated-clients  two clients that public generators make of it, compiled and tried on a daemon
## make coverage   the share of core's lines that tests run, counted anew when something changed
## make wheel      the Python package as a wheel, in build/python
## make lint       formatting, boundaries, clang-tidy, a build with clang, and mypy and pyflakes of Python
## make asan       all tests under AddressSanitizer and UndefinedBehaviorSanitizer
## make tsan       the threaded tests under ThreadSanitizer
## make browser    the dashboard's tests alone, in Chromium; screenshots in build/browser
## make guide-check  all commands of README and guide, long ones too; their output compared
## make stability  the 48 hard cases in their long form, as a table of measured values and bounds
## make cie171     CIE 171:2006, cases 5.4 to 5.14, as a table of references and results
## make oracles    skies, the white furnace, the moved office: the same kind of table
## make fuzz       every reader of untrusted input under libFuzzer, SECONDS=60 each
## make bench      what the office costs in ray-times, beside its targets and Radiance's times if it
##                 is there: a table, and build/bench.json; with OLD=commit, small jobs by that commit
##                 and this one in turns
## make bench-scale  how that grows with photons, threads and little memory
## make bench-polygons  what five million polygons take to load, in bytes and seconds
## make bench-slurm  what parts, waves and merging cost, on a Slurm on loopback, and what 1 to 1000 nodes
##                 are worth by that: tables, and build/bench-slurm.json
## make load       how the daemon bears many clients, idle and while all cores render: a table
## make dashboards  200 dashboards at once while all cores render, and what one page takes: a table
## make eta        what ten jobs were said to take still, beside what they took: a table
## make check-perf  work and errors of small jobs against the best commit on record (tests/bench/ratchet)
## make table2     the techniques' times and errors on the office, beside Radiance's if it is there
## make study      what accuracy costs in time on the office: a table, and build/study/study.png
## make bsdf-study  BSDFs of panels against closed forms and, if they are there, Radiance's genBSDF and
##                 pabopto2bsdf: tables, and pictures in build/bsdf-study
## make annual     a year of daylight in the office, in ray-times, beside hours of it by backward, and
##                 glare of its seats beside pictures: tables, and build/annual.json; then verdicts of
##                 100 seeds in four rooms
## make bench-annual  how a year's cost grows with window groups, mirrors and sensors: a table
## make paths      each source of light by each chain of surfaces and technique, against plain path
##                 tracing: a table, and how often intervals hold; half an hour, for truths
## make rare-rooms  the same of thirty rooms in which light is rare
## make gallery    pictures by all techniques, side by side, in build/gallery
## make calibration  whether errors stated are errors made: intervals, error maps, jobs by accuracy
##                 or deadline, predictions; long (tests/bench/tables.md has its parts)
## make glare      DGP and glare sources of pictures beside evalglare's, if it is there, and of discs
##                 beside arithmetic; then how often DGP's intervals hold; some minutes
## make torture    a daemon killed 500 times under load (TORTURE_KILLS), faults of disk, files,
##                 database and memory, each call that can fail, 200 power cuts, malformed requests,
##                 cancels: what it answered for is kept
## make slurm      jobs in parts, and faults, on a real Slurm on loopback, in long forms: the office
##                 whole, 24 skies, an accuracy, a year; slurmctld away for 30 s
## make siege      a daemon under attack, SIEGE_SECONDS (600): all at once and each alone, beside a
##                 polite client whose waiting is bounded
## make install    programs, manuals, completion, systemd unit, examples, guide and clients, below PREFIX
##                 (/usr/local) and DESTDIR; make uninstall removes them, but neither options nor data
## make deb        the Debian package, in build/deb
## make deb-check  that package in a Debian 12 of its own, as root: installed, upgraded, removed, purged
## make image      the Dockerfile built by buildah on a base by debootstrap, as root; the demo in it
## make format     clang-format in place

# ---- Packages ------------------------------------------------------------------------------------
# Installs the packages that are missing, and says so first. Debian's own packages only.
define install_packages
@missing=""; for p in $(1); do \
	dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'install ok installed' || missing="$$missing $$p"; \
	done; \
	if [ -n "$$missing" ]; then \
		echo "Installing Debian packages:$$missing"; \
		run=""; [ "$$(id -u)" = 0 ] || run=sudo; \
		$$run apt-get update -qq && \
		$$run env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing >/dev/null || exit 1; \
	fi
endef
deps-build: ; $(call install_packages,$(PACKAGES_BUILD))
deps-check: ; $(call install_packages,$(PACKAGES_CHECK))
deps-browser: ; $(call install_packages,$(PACKAGES_BROWSER))
deps-lint:  ; $(call install_packages,$(PACKAGES_LINT))
deps-demo:  ; $(call install_packages,$(PACKAGES_DEMO))
deps-perf:  ; $(call install_packages,$(PACKAGES_PERF))
deps-fuzz:  ; $(call install_packages,$(PACKAGES_FUZZ))

# `make V=1` shows the commands.
V ?= 0
Q := $(if $(filter 1,$(V)),,@)
say = $(if $(filter 1,$(V)),,@echo "  $(1)  $(2)")

# ---- Build ---------------------------------------------------------------------------------------
# A change of flags rebuilds: the stamp holds the command line.
$(BUILD)/flags: FORCE
	@mkdir -p $(@D); echo '$(CC) $(ALL_CFLAGS)' | cmp -s - $@ || echo '$(CC) $(ALL_CFLAGS)' > $@

define compile_rule
$(BUILD)/obj/$(1)/%.o: $(1)/%.c $(BUILD)/flags
	@mkdir -p $$(@D)
	$$(call say,CC,$$@)
	$$(Q)$$(CC) $$(ALL_CFLAGS) $(2) -MMD -MP -c $$< -o $$@
endef
$(eval $(call compile_rule,core,$(INC_core)))
$(eval $(call compile_rule,api,$(INC_api)))
$(eval $(call compile_rule,server,$(INC_server)))
$(eval $(call compile_rule,client,$(INC_client)))
# Programs of tests/bench are measured; the code of the other tests only has to compile quickly.
OPT_tests := $(if $(filter release,$(MODE)),-O1)
$(eval $(call compile_rule,tests,$(INC_tests) $$(if $$(filter tests/bench/%,$$<),,$$(OPT_tests))))

# The description of documents and of the interface: as C, and as one OpenAPI document. They have
# numbers that headers define.
DESCRIBE := PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 api/schema/describe.py
DESCRIBED := $(wildcard api/schema/*.yaml api/schema/*.py api/openapi/*.yaml) \
	$(wildcard core/include/oriel/*/*.h api/*/*.h server/http/*.h server/http/*/*.h) server/process/limits.h
$(BUILD)/generated/schemas.stamp: $(DESCRIBED)
	@mkdir -p $(@D)
	@$(DESCRIBE) tables $(@D) && touch $@
$(BUILD)/generated/schemas.h $(BUILD)/generated/schemas.c: $(BUILD)/generated/schemas.stamp ;
$(BUILD)/generated/openapi.yaml: $(DESCRIBED)
	@mkdir -p $(@D)
	@$(DESCRIBE) openapi >$@.part && mv $@.part $@
$(BUILD)/obj/generated/schemas.o: $(BUILD)/generated/schemas.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call say,CC,$@)
	$(Q)$(CC) $(ALL_CFLAGS) $(INC_api) -MMD -MP -c $< -o $@
$(call other,$(API_SRC) $(SERVER_SRC) $(CLIENT_SRC) $(TEST_SRC)) $(SUPPORT_OBJ): | $(OTHERS)/generated/schemas.h

# Files that the daemon carries inside: migrations and the API contract.
EMBEDDED := $(sort $(wildcard migrations/*.sql)) $(BUILD)/generated/openapi.yaml
$(BUILD)/generated/embedded.h: $(EMBEDDED) Makefile
	@mkdir -p $(@D)
	@{ echo '/* Generated from migrations, api/openapi and api/schema by the Makefile. */'; \
	echo 'static const struct { const char *name; const char *text; } orl_embedded[] = {'; \
	for f in $(EMBEDDED); do \
		printf '{"%s",\n' "$${f#$(BUILD)/generated/}"; \
		sed -e 's/\\/\\\\/g' -e 's/"/\\"/g' -e 's/^/"/' -e 's/$$/\\n"/' "$$f"; \
		echo '},'; \
	done; echo '};'; } > $@
# The dashboard: its files, the JavaScript client, and Chart.js of Debian's libjs-chart.js.
DASHBOARD := $(sort $(wildcard client/dashboard/*.html client/dashboard/*.css client/dashboard/*.js \
	client/dashboard/*.svg client/dashboard/*/*.js)) client/javascript/oriel.js
CHART_JS  ?= /usr/share/javascript/chart.js/chart.min.js
$(BUILD)/generated/dashboard.h: client/dashboard/embed $(CHART_JS) $(DASHBOARD)
	@mkdir -p $(@D)
	@client/dashboard/embed dashboard $(CHART_JS) $(DASHBOARD) >$@.part && mv $@.part $@
# The guide: pages and their pictures; a README is not a page.
GUIDE := $(sort $(filter-out %/README.md,$(wildcard client/guide/*.md client/guide/*/*.md)) \
	$(wildcard client/guide/pictures/*.png client/guide/pictures/*.svg))
$(BUILD)/generated/guide_files.h: client/dashboard/embed $(GUIDE)
	@mkdir -p $(@D)
	@client/dashboard/embed guide $(GUIDE) >$@.part && mv $@.part $@
# The commit that the programs are built from. A copy without git has it in client/packaging/commit.
ifndef COMMIT
COMMIT := $(shell git rev-parse --short=12 HEAD 2>/dev/null || grep -xE '[0-9a-f]+' client/packaging/commit)
endif
$(BUILD)/generated/commit.h: FORCE
	@mkdir -p $(@D); echo '#define ORL_COMMIT "$(COMMIT)"' | cmp -s - $@ || echo '#define ORL_COMMIT "$(COMMIT)"' >$@
$(call other,client/commands/cmd_version.c server/main.c): $(OTHERS)/generated/commit.h
GENERATED := $(patsubst %,$(OTHERS)/generated/%.h,embedded dashboard guide_files)
$(SERVER_OBJ): | $(GENERATED)
$(call other,$(TEST_SRC)): | $(OTHERS)/generated/embedded.h

$(BUILD)/liboriel.a: $(CORE_OBJ) $(API_OBJ)
	@rm -f $@; ar rcs $@ $^
$(BUILD)/orield: $(SERVER_OBJ) $(BUILD)/liboriel.a
	$(call say,LD,$@)
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(SERVER_LIBS) $(CORE_LIBS)
$(BUILD)/oriel: $(CLIENT_OBJ) $(BUILD)/liboriel.a
	$(call say,LD,$@)
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(CLIENT_LIBS) $(CORE_LIBS)
# What tests link beside the library: all of the daemon but its main, and their own shared code.
$(OTHERS)/libtests.a: $(SUPPORT_OBJ) $(SERVER_LIB_OBJ)
	@rm -f $@; ar rcs $@ $^
# Over 300 programs: a fast linker, and no copy of the debug information where a sanitizer needs none.
FAST_LD := $(firstword $(foreach l,gold lld,$(if $(shell command -v ld.$(l)),-fuse-ld=$(l))))
TEST_LDFLAGS := $(FAST_LD) $(if $(filter release cover,$(MODE)),-Xlinker -S)
$(BUILD)/tests/%: $(OTHERS)/obj/tests/%.o $(OTHERS)/libtests.a $(BUILD)/liboriel.a
	@mkdir -p $(@D)
	$(call say,LD,$@)
	$(Q)$(CC) $(ALL_LDFLAGS) $(TEST_LDFLAGS) -o $@ $^ -lcmocka -lgnutls $(SERVER_LIBS) $(CLIENT_LIBS) $(CORE_LIBS)
# Its allocator is for the libraries, too.
$(BUILD)/tests/unit/test_embree_memory: ALL_LDFLAGS += -rdynamic

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)

# ---- Checks --------------------------------------------------------------------------------------
SHIMS := $(patsubst %,$(BUILD)/tests/%.so,faulty scarce recorder shifted)
tests: all $(TEST_BIN) $(SHIMS) packaging

# Loaded into a daemon, to make its disk or memory fail, and to record what it writes.
$(BUILD)/tests/%.so: tests/torture/%.c
	@mkdir -p $(@D)
	$(call say,LD,$@)
	$(Q)$(CC) $(STD) $(WARNINGS) $(WERROR) -O1 -shared -fPIC -o $@ $<

# The wheel of the Python package, built from a copy, for setuptools writes beside its sources.
PYTHON_TREE := $(BUILD)/python/tree
PYTHON_SRC  := $(wildcard client/python/oriel/*.py) client/python/oriel/py.typed client/python/pyproject.toml client/python/setup.py \
	client/python/README.md
VERSION_H   := core/include/oriel/base/version.h
.PHONY: wheel
wheel: $(BUILD)/python/ready
$(BUILD)/python/ready: $(PYTHON_SRC) $(VERSION_H)
	$(call say,WHEEL,$(@D))
	$(Q)rm -rf $(@D); mkdir -p $(PYTHON_TREE)/client/python/oriel $(PYTHON_TREE)/$(dir $(VERSION_H))
	$(Q)cp $(filter client/python/oriel/%,$(PYTHON_SRC)) $(PYTHON_TREE)/client/python/oriel
	$(Q)cp client/python/pyproject.toml client/python/setup.py client/python/README.md $(PYTHON_TREE)/client/python
	$(Q)cp $(VERSION_H) $(PYTHON_TREE)/$(dir $(VERSION_H))
	$(Q)/usr/bin/python3 -m pip --quiet --disable-pip-version-check wheel --no-build-isolation --no-deps --no-index \
		--wheel-dir $(@D) $(PYTHON_TREE)/client/python && touch $@

# What tests/browser takes, as its package-lock.json has it.
BROWSER_LOCK := tests/browser/package.json tests/browser/package-lock.json
$(BUILD)/browser/ready: $(BROWSER_LOCK)
	@mkdir -p $(@D); cp $(BROWSER_LOCK) $(@D)
	$(call say,NPM,$(@D))
	$(Q)cd $(@D) && npm ci --ignore-scripts --no-audit --no-fund --silent && touch $(@F)

check: deps-check deps-browser
	@$(MAKE) --no-print-directory -j$(JOBS) tests $(BUILD)/browser/ready
	@tests/run $(BUILD) tests/browser/run tests/guide/run $(TEST_BIN)
.PHONY: long
long: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) tests
	@ORIEL_LONG=1 TEST_TIMEOUT=3600 tests/run $(BUILD) $(TEST_BIN)
.PHONY: guide-check
guide-check: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@ORIEL_BUILD=$(BUILD) tests/guide/run --long
.PHONY: browser
browser: deps-check deps-browser
	@$(MAKE) --no-print-directory -j$(JOBS) all $(BUILD)/browser/ready
	@tests/run $(BUILD) tests/browser/run

# The figure for coverage comes from a second build of the core, with counters, and from the suites
# that look at the core: what users run is what the tests themselves are about. Nothing else waits for
# it. Programs that take long (tests/durations) ask much of lines that others run as well.
COVER_SUITES := unit stats validation
COVER_LONG := $(shell awk '!/^\#/ && $$1 > 10 { print $$2 }' tests/durations)
COVER_TESTS := $(filter-out $(COVER_LONG),$(patsubst %.c,%,$(foreach s,$(COVER_SUITES),$(filter tests/$(s)/%,$(TEST_SRC)))))
COVER_BIN := $(COVER_TESTS:%=$(BUILD)/%)
COVER_LEAST := 85
.PHONY: coverage
coverage: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) cover-others
	@$(MAKE) --no-print-directory -j$(JOBS) BUILD=$(BUILD)/cover OTHERS=$(BUILD) MODE=cover \
		CC='$(if $(findstring clang,$(CC)),gcc,$(CC))' $(BUILD)/cover/counted; \
		status=$$?; cat $(BUILD)/cover/coverage.txt; exit $$status
.PHONY: cover-others
cover-others: $(COVER_TESTS:%=$(BUILD)/obj/%.o) $(BUILD)/libtests.a $(API_OBJ)
$(BUILD)/counted: $(COVER_BIN) tests/coverage tests/run $(wildcard tests/fixtures/*)
	@echo "  counting the lines that tests run"
	@tests/coverage $(BUILD) $(COVER_LEAST) $(COVER_BIN) >$(@D)/coverage.txt
	@touch $@

asan: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) BUILD=$(BUILD)/asan MODE=asan tests
	@ASAN_OPTIONS=detect_leaks=1 LSAN_OPTIONS=suppressions=$(CURDIR)/tests/lsan.supp:print_suppressions=0 \
		UBSAN_OPTIONS=print_stacktrace=1 TEST_TIMEOUT=900 \
		$(MAKE) --no-print-directory BUILD=$(BUILD)/asan MODE=asan run-tests
# Validation and samplers run on one thread, but for programs that name `threads`.
THREADED_BIN := $(filter-out $(BUILD)/tests/validation/% $(BUILD)/tests/stats/%,$(TEST_BIN)) \
	$(patsubst %.c,$(BUILD)/%,$(shell grep -l threads tests/validation/*.c tests/stats/*.c))
tsan: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) BUILD=$(BUILD)/tsan MODE=tsan tests
	@TSAN_OPTIONS=suppressions=$(CURDIR)/tests/tsan.supp TEST_TIMEOUT=900 \
		$(MAKE) --no-print-directory BUILD=$(BUILD)/tsan MODE=tsan run-threaded

HARD_CASES := 48
# Parts may fail by themselves; all are run.
TORTURE_KILLS ?= 500
torture: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(SHIMS)
	@export PYTHONDONTWRITEBYTECODE=1; failed=0; \
		python3 tests/torture/torture.py $(BUILD) --kills $(TORTURE_KILLS) || failed=1; \
		python3 tests/torture/faults.py $(BUILD) || failed=1; \
		python3 tests/torture/every.py $(BUILD) || failed=1; \
		python3 tests/torture/powercuts.py $(BUILD) --cuts 200 || failed=1; \
		python3 tests/torture/malformed.py $(BUILD) --count 10000 || failed=1; \
		python3 tests/torture/cancel.py $(BUILD) || failed=1; \
		python3 tests/torture/cancel_kinds.py $(BUILD) || failed=1; exit $$failed

# Long forms: the office in its own size, Slurm's controller away for half a minute.
SLURM_BIN := $(filter $(BUILD)/tests/api/test_slurm%,$(TEST_BIN))
.PHONY: slurm
slurm: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(SLURM_BIN)
	@ORIEL_SLURM_LONG=1 TEST_JOBS=1 TEST_TIMEOUT=3600 tests/run $(BUILD) $(SLURM_BIN)

SIEGE_SECONDS ?= 600
.PHONY: siege image
siege: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/torture/siege.py $(BUILD) --seconds $(SIEGE_SECONDS)

# Not part of the checks: it takes root, and Debian's archive.
PACKAGES_IMAGE := buildah debootstrap crun
deps-image: ; $(call install_packages,$(PACKAGES_IMAGE))
image: deps-image deps-build
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/oriel
	@tests/image $(BUILD) $(BUILD)/image

STABILITY_BIN := $(filter $(BUILD)/tests/stability/%,$(TEST_BIN))
stability: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(STABILITY_BIN)
	@tests/stability_table $(BUILD) $(HARD_CASES) $(STABILITY_BIN)

CIE171_BIN := $(filter $(BUILD)/tests/validation/test_cie171%,$(TEST_BIN))
cie171: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) $(CIE171_BIN)
	@tests/stability_table $(BUILD) rows $(CIE171_BIN)
ORACLE_BIN := $(patsubst %,$(BUILD)/tests/validation/test_%,sky_illuminance sky_radiance furnace office_moved)
oracles: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) $(ORACLE_BIN)
	@tests/stability_table $(BUILD) rows $(ORACLE_BIN)

# Smaller limits, so that small inputs reach them. New units go to the build folder; the committed
# corpus only grows by hand.
SECONDS ?= 60
fuzz: deps-fuzz
	@$(MAKE) --no-print-directory -j$(JOBS) BUILD=$(BUILD)/fuzz MODE=fuzz CC=clang WERROR= \
		CFLAGS='-include tests/fuzz/limits.h -iquote server' fuzzers
	@tests/fuzz/run $(BUILD)/fuzz $(SECONDS) $(JOBS) $(FUZZ_TARGETS)
# What of the daemon reads hostile bytes by itself.
FUZZ_SERVER_OBJ := $(patsubst %,$(BUILD)/obj/server/%.o,uploads/unzip uploads/incoming \
	uploads/multipart http/quota/quota http/request/parse_request http/router http/access/origin_policy \
	http/access/tokens process/origin process/times process/embedded_files store/files/scene_bundle \
	store/files/folders store/database/db store/database/migrate store/rows/stored_tokens)
fuzzers: $(FUZZ_TARGETS:%=$(BUILD)/%)
$(FUZZ_TARGETS:%=$(BUILD)/obj/tests/fuzz/driver_%.o): $(BUILD)/obj/tests/fuzz/driver_%.o: \
		tests/fuzz/driver.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call say,CC,$@)
	$(Q)$(CC) $(ALL_CFLAGS) $(INC_tests) -DFUZZ_TARGET=$* -MMD -MP -c $< -o $@
$(FUZZ_TARGETS:%=$(BUILD)/%): $(BUILD)/%: $(BUILD)/obj/tests/fuzz/driver_%.o \
		$(BUILD)/obj/tests/fuzz/%.o $(BUILD)/obj/tests/fuzz/promise.o $(BUILD)/obj/tests/support/wire.o $(FUZZ_SERVER_OBJ) \
		$(BUILD)/liboriel.a
	$(call say,LD,$@)
	$(Q)$(CC) $(ALL_LDFLAGS) -fsanitize=fuzzer -o $@ $^ -larchive -lmicrohttpd -lsqlite3 $(CORE_LIBS)
# A public validator of the OpenAPI document, and clients that public generators make of it. Not part
# of the checks: they take 200 MB of npm's packages.
CLIENTS_LOCK := tests/clients/package.json tests/clients/package-lock.json
$(BUILD)/clients/ready: $(CLIENTS_LOCK)
	@mkdir -p $(@D); cp $(CLIENTS_LOCK) $(@D)
	$(call say,NPM,$(@D))
	$(Q)cd $(@D) && npm ci --ignore-scripts --no-audit --no-fund --silent && touch $(@F)
CLIENTS_BIN := $(BUILD)/clients/node_modules/.bin
.PHONY: openapi-lint generated-clients
openapi-lint: deps-browser $(BUILD)/generated/openapi.yaml $(BUILD)/clients/ready
	@REDOCLY_TELEMETRY=off REDOCLY_SUPPRESS_UPDATE_NOTICE=true $(CLIENTS_BIN)/redocly lint \
		$(BUILD)/generated/openapi.yaml --config tests/clients/redocly.yaml
generated-clients: deps-check deps-browser $(BUILD)/generated/openapi.yaml $(BUILD)/clients/ready
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@cp tests/clients/*.ts tests/clients/tsconfig.json $(BUILD)/clients
	@$(CLIENTS_BIN)/openapi-typescript $(BUILD)/generated/openapi.yaml --default-non-nullable=false \
		-o $(BUILD)/clients/generated/types.ts
	@$(CLIENTS_BIN)/openapi-ts -i $(BUILD)/generated/openapi.yaml -o $(BUILD)/clients/generated/sdk \
		-c @hey-api/client-fetch
	@$(CLIENTS_BIN)/tsc -p $(BUILD)/clients
	@node tests/clients/run.mjs $(BUILD)

# Pages of the guide, from the description of documents; they are committed.
.PHONY: reference
reference: deps-build
	@$(DESCRIBE) reference client/guide/reference
.PHONY: run-tests run-threaded
run-tests:
	@tests/run $(BUILD) $(TEST_BIN)
run-threaded:
	@tests/run $(BUILD) $(THREADED_BIN)

LINT_SRC := $(CORE_SRC) $(API_SRC) $(SERVER_SRC) $(CLIENT_SRC)
ALL_C := $(shell git ls-files '*.c' '*.h' 2>/dev/null)
lint: deps-lint $(BUILD)/generated/schemas.h $(GENERATED) $(BUILD)/generated/commit.h
	@clang-format --dry-run --Werror $(ALL_C)
	tests/check_boundaries
	tests/check_names
	tests/check_promises
	tests/check_guide
	cd client/python && mypy --cache-dir $(abspath $(BUILD))/mypy && pyflakes3 oriel setup.py ../../tests/api/python_*.py
	@$(MAKE) --no-print-directory -j$(JOBS) all
	tests/check_circles $(BUILD)
	@printf '%s\n' $(CORE_SRC) | xargs -P $(JOBS) -I{} clang-tidy --quiet {} -- $(STD) $(INC_core)
	@printf '%s\n' $(API_SRC) $(SERVER_SRC) $(CLIENT_SRC) | \
		xargs -P $(JOBS) -I{} clang-tidy --quiet {} -- $(STD) $(INC_server) -iquote client
	@$(MAKE) --no-print-directory -j$(JOBS) BUILD=$(BUILD)/clang CC=clang tests
	@echo "lint: clean"
format:
	clang-format -i $(ALL_C)

# Programs that time parallel loops apart from the rest (tests/bench/pool_clock.c).
$(BUILD)/tests/bench/speed $(BUILD)/tests/bench/scale: \
	ALL_LDFLAGS += -Wl,--wrap=orl_parallel_for -Wl,--wrap=orl_parallel_try
# OLD=commit: instead, the ratchet's rows by that commit and this one in turns.
OLD ?=
bench: deps-check
ifneq ($(OLD),)
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/oriel
	@test -d $(BUILD)/old/$(OLD) || git worktree add --force --detach $(BUILD)/old/$(OLD) $(OLD)
	@$(MAKE) --no-print-directory -C $(BUILD)/old/$(OLD) -j$(JOBS) build/oriel
	@$(RATCHET) times $(BUILD) $(BUILD)/old/$(OLD)/build
else
	@$(MAKE) --no-print-directory -j$(JOBS) all $(BUILD)/tests/bench/speed
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/speed
endif
.PHONY: bench-slurm
bench-slurm: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/slurm.py $(BUILD)
bench-scale: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(BUILD)/tests/bench/scale
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/scale
bench-polygons: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/tests/bench/polygons
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/polygons
load: deps-perf
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/orield $(BUILD)/tests/bench/hello
	@PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tests/bench/load.py $(BUILD)
dashboards: deps-check deps-browser
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/orield $(BUILD)/browser/ready
	@PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tests/bench/dashboards.py $(BUILD)
RATCHET := PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 tests/bench/ratchet/ratchet.py
check-perf: deps-perf
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/oriel
	@$(RATCHET) check $(BUILD)
paths rare-rooms: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/tests/bench/paths
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/paths $(if $(filter paths,$@),cells,rooms)
table2 gallery calibration: %: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(BUILD)/tests/bench/$*
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/$*

VERDICTS_BIN := $(BUILD)/tests/validation/test_annual_verdicts
annual: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(BUILD)/tests/bench/annual $(VERDICTS_BIN)
	@ORIEL_BUILD=$(BUILD) $(BUILD)/tests/bench/annual
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/annual_radiance.py $(BUILD)
	@ORIEL_VERDICT_SEEDS=$${ORIEL_VERDICT_SEEDS:-100} $(VERDICTS_BIN)

.PHONY: bench-annual
bench-annual: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/annual_scale.py $(BUILD)

.PHONY: eta
eta: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/eta.py $(BUILD)

.PHONY: glare
GLARE_BIN := $(BUILD)/tests/validation/test_glare_errors
glare: deps-check
	@$(MAKE) --no-print-directory -j$(JOBS) all $(GLARE_BIN)
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/glare.py $(BUILD)
	@tests/stability_table $(BUILD) rows $(GLARE_BIN)

# In a copy of the office, where the panel's BSDF is made once.
STUDY := $(BUILD)/study
study: deps-demo
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/oriel
	@mkdir -p $(STUDY)/office
	@cp client/examples/office/*.rad client/examples/office/*.json client/examples/office/sensors.txt \
		$(STUDY)/office/
	@test -s $(STUDY)/office/lcp.xml || $(BUILD)/oriel bsdf make client/examples/office/lcp/lcp.json \
		-o $(STUDY)/office/lcp.xml
	@$(BUILD)/oriel study $(STUDY)/office/study.json --output $(STUDY)

.PHONY: bsdf-study
bsdf-study: deps-demo
	@$(MAKE) --no-print-directory -j$(JOBS) $(BUILD)/oriel
	@PYTHONDONTWRITEBYTECODE=1 python3 tests/bench/bsdf_study.py $(BUILD)

demo: deps-demo
	@$(MAKE) --no-print-directory -j$(JOBS) all
	@client/examples/office/demo $(BUILD)

include client/packaging/packaging.mk

clean:
	rm -rf $(BUILD)
