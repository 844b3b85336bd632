/*
 * Versions of the libraries that the core uses, as they are at run time. A program can run with
 * another version of a shared library than the one it was built with.
 */
#ifndef ORIEL_JOB_LIBRARY_VERSIONS_H
#define ORIEL_JOB_LIBRARY_VERSIONS_H

#include <stddef.h>

enum { ORL_CORE_LIBRARIES = 8, ORL_LIBRARY_VERSION_TEXT = 32 };

struct orl_library_version {
    const char *name; /* as its project spells it: "Embree" */
    char version[ORL_LIBRARY_VERSION_TEXT];
};

/* Fills in the core's libraries. The version of Embree is "?" if Embree does not start. Threads:
 * any. */
void orl_core_library_versions(struct orl_library_version ret_versions[ORL_CORE_LIBRARIES]);

#endif
