# Manuals, completion, installation, the Debian package and the container image. Included by the
# Makefile. The folders are GNU's variables; DESTDIR stages them below another root.

PREFIX      ?= /usr/local
prefix      ?= $(PREFIX)
exec_prefix ?= $(prefix)
bindir      ?= $(exec_prefix)/bin
libdir      ?= $(exec_prefix)/lib
datarootdir ?= $(prefix)/share
datadir     ?= $(datarootdir)
mandir      ?= $(datarootdir)/man
docdir      ?= $(datarootdir)/doc/oriel
# The daemon's data is in /var/lib/oriel whatever the prefix: systemd's StateDirectory is there.
sysconfdir  ?= $(if $(filter /usr,$(prefix)),/etc,$(prefix)/etc)
unitdir     ?= $(prefix)/lib/systemd/system
bashcompletiondir ?= $(datarootdir)/bash-completion/completions
zshcompletiondir  ?= $(datarootdir)/zsh/site-functions
javascriptdir     ?= $(datarootdir)/javascript/oriel
# The folder below the prefix that python3 searches for modules.
pythondir   ?= $(shell client/packaging/python_folder $(prefix))
INSTALL         ?= install
INSTALL_PROGRAM ?= $(INSTALL)
INSTALL_DATA    ?= $(INSTALL) -m 644

# Its one place is the header; manuals, package and image read it from there.
VERSION := $(shell sed -n 's/^\#define ORL_VERSION "\(.*\)"/\1/p' core/include/oriel/base/version.h)
# Day of the manuals: the source's own, so that they are the same wherever they are built.
SOURCE_DATE_EPOCH ?= $(shell git log -1 --format=%ct 2>/dev/null || stat -c %Y core/include/oriel/base/version.h)

PACKAGES_INSTALL := $(sort $(PACKAGES_BUILD) python3)
deps-install: ; $(call install_packages,$(PACKAGES_INSTALL))

# ---- Manuals and completion, from the help of the programs ----------------------------------------
PACKAGING := $(BUILD)/packaging
HELP_TEXT := client/packaging/help_text.py
$(PACKAGING)/manuals: client/packaging/manuals.py $(HELP_TEXT) $(BUILD)/oriel $(BUILD)/orield
	@rm -rf $(PACKAGING)/man; mkdir -p $(PACKAGING)
	$(call say,MAN,$(PACKAGING)/man)
	@PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 $< $(BUILD)/oriel $(BUILD)/orield $(VERSION) \
		"$$(LC_ALL=C date -u -d @$(SOURCE_DATE_EPOCH) '+%B %-d, %Y')" $(PACKAGING)/man
	@touch $@
$(PACKAGING)/completions: client/packaging/completions.py $(HELP_TEXT) $(BUILD)/oriel $(BUILD)/orield
	@mkdir -p $(PACKAGING)
	$(call say,GEN,$(PACKAGING)/bash $(PACKAGING)/zsh)
	@PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 $< $(BUILD)/oriel $(BUILD)/orield $(PACKAGING)
	@touch $@
.PHONY: packaging
packaging: all $(PACKAGING)/manuals $(PACKAGING)/completions

# ---- make install ----------------------------------------------------------------------------------
# Documents: their place in the source, and their folder below docdir.
EXAMPLES := $(sort $(shell find client/examples -type f))
GUIDE_FILES := $(sort $(shell find client/guide -type f 2>/dev/null))
PYTHON_MODULE := $(sort $(shell cd client/python && find oriel -type f \( -name '*.py' -o -name py.typed \) 2>/dev/null))
JAVASCRIPT := $(sort $(wildcard client/javascript/*.js client/javascript/*.json))

# $(1): files, $(2): their folder in the source, $(3): the folder to install to.
define install_files
	@for file in $(patsubst $(2)/%,%,$(1)); do \
		mode=644; [ ! -x "$(2)/$$file" ] || mode=755; \
		$(INSTALL) -D -m $$mode "$(2)/$$file" "$(DESTDIR)$(3)/$$file" || exit 1; \
	done
endef

.PHONY: install install-files uninstall install-strip
install: packaging
	@$(MAKE) --no-print-directory install-files
# Copies what has been built.
install-files:
	$(INSTALL) -d "$(DESTDIR)$(bindir)" "$(DESTDIR)$(mandir)/man1" "$(DESTDIR)$(mandir)/man8" "$(DESTDIR)$(unitdir)" \
		"$(DESTDIR)$(bashcompletiondir)" "$(DESTDIR)$(zshcompletiondir)" "$(DESTDIR)$(docdir)" "$(DESTDIR)$(sysconfdir)/oriel"
	$(INSTALL_PROGRAM) $(BUILD)/oriel $(BUILD)/orield "$(DESTDIR)$(bindir)"
	$(INSTALL_DATA) $(PACKAGING)/man/man1/*.1 "$(DESTDIR)$(mandir)/man1"
	$(INSTALL_DATA) $(PACKAGING)/man/man8/*.8 "$(DESTDIR)$(mandir)/man8"
	$(INSTALL_DATA) $(PACKAGING)/bash/oriel $(PACKAGING)/bash/orield "$(DESTDIR)$(bashcompletiondir)"
	$(INSTALL_DATA) $(PACKAGING)/zsh/_oriel $(PACKAGING)/zsh/_orield "$(DESTDIR)$(zshcompletiondir)"
	@# The unit with the folders of this installation.
	sed -e 's|/usr/local/bin/|$(bindir)/|g' -e 's|/etc/oriel/|$(sysconfdir)/oriel/|g' server/orield.service \
		>"$(DESTDIR)$(unitdir)/orield.service"
	@# Options that the administrator has set stay.
	[ -e "$(DESTDIR)$(sysconfdir)/oriel/orield.env" ] || \
		$(INSTALL_DATA) client/packaging/orield.env "$(DESTDIR)$(sysconfdir)/oriel/orield.env"
	$(INSTALL_DATA) LICENSE README.md client/packaging/compose.yaml "$(DESTDIR)$(docdir)"
	$(call install_files,$(EXAMPLES),client/examples,$(docdir)/examples)
	$(call install_files,$(GUIDE_FILES),client/guide,$(docdir)/guide)
	$(call install_files,$(PYTHON_MODULE),client/python,$(pythondir))
	@# The package in Python reads its version from there, as in a wheel.
	@echo $(VERSION) >"$(DESTDIR)$(pythondir)/oriel/VERSION"
	$(call install_files,$(JAVASCRIPT),client/javascript,$(javascriptdir))
install-strip:
	@$(MAKE) --no-print-directory INSTALL_PROGRAM='$(INSTALL_PROGRAM) -s' install

# Removes what install makes, but neither options nor data.
uninstall:
	rm -f "$(DESTDIR)$(bindir)/oriel" "$(DESTDIR)$(bindir)/orield" "$(DESTDIR)$(unitdir)/orield.service"
	rm -f "$(DESTDIR)$(mandir)/man1/oriel.1" "$(DESTDIR)$(mandir)"/man1/oriel-*.1 "$(DESTDIR)$(mandir)/man8/orield.8"
	rm -f "$(DESTDIR)$(bashcompletiondir)/oriel" "$(DESTDIR)$(bashcompletiondir)/orield" \
		"$(DESTDIR)$(zshcompletiondir)/_oriel" "$(DESTDIR)$(zshcompletiondir)/_orield"
	rm -f $(foreach file,$(PYTHON_MODULE) oriel/VERSION,"$(DESTDIR)$(pythondir)/$(file)")
	@rmdir "$(DESTDIR)$(pythondir)/oriel" 2>/dev/null || true
	rm -rf "$(DESTDIR)$(docdir)" "$(DESTDIR)$(javascriptdir)"

# ---- make deb --------------------------------------------------------------------------------------
# The source is copied to a folder of its own, with debian/ at its top as the tools want it.
PACKAGES_DEB := $(PACKAGES_INSTALL) dpkg-dev debhelper dh-apparmor lintian
PACKAGES_DEB_CHECK := $(PACKAGES_DEB) mmdebstrap
deps-deb: ; $(call install_packages,$(PACKAGES_DEB))
deps-deb-check: ; $(call install_packages,$(PACKAGES_DEB_CHECK))
MAINTAINER ?= Oriel authors <oriel@users.noreply.github.com>
DEB        := $(BUILD)/deb
DEB_SOURCE := $(DEB)/oriel-$(VERSION)
DEB_FILE    = $(DEB)/oriel_$(VERSION)_$(shell dpkg --print-architecture).deb
.PHONY: deb deb-check
deb: deps-deb
	@rm -rf $(DEB_SOURCE); mkdir -p $(DEB_SOURCE)
	@git ls-files -z | tar -c --null -T - | tar -x -C $(DEB_SOURCE)
	@cp -r client/packaging/debian $(DEB_SOURCE)/debian
	@echo '$(COMMIT)' >$(DEB_SOURCE)/client/packaging/commit
	@for file in control changelog; do \
		sed -e 's/@VERSION@/$(VERSION)/g' -e 's/@COMMIT@/$(COMMIT)/g' -e 's/@MAINTAINER@/$(MAINTAINER)/g' \
			-e "s/@DATE@/$$(date -R -u -d @$(SOURCE_DATE_EPOCH))/" \
			-e 's/@BUILD_DEPENDS@/$(shell echo $(PACKAGES_INSTALL) | sed 's/ /, /g')/' \
			$(DEB_SOURCE)/debian/$$file.in >$(DEB_SOURCE)/debian/$$file && \
		rm $(DEB_SOURCE)/debian/$$file.in || exit 1; \
	done
	cd $(DEB_SOURCE) && env -u MAKEFLAGS -u MAKELEVEL -u BUILD SOURCE_DATE_EPOCH=$(SOURCE_DATE_EPOCH) \
		DEB_BUILD_OPTIONS="parallel=$(JOBS) nocheck" dpkg-buildpackage --build=binary --no-sign
	lintian --fail-on error,warning $(DEB)/oriel_$(VERSION)_*.changes
	@echo "deb: $(DEB_FILE)"
# Not part of the checks: it takes root, and Debian's archive.
deb-check: deps-deb-check deb
	@tests/deb_check $(DEB_FILE) $(DEB)/check
# For tests.
.PHONY: print-version print-packages
print-version: ; @echo $(VERSION)
print-packages: ; @echo $(PACKAGES_BUILD)
