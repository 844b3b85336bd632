#include "result/version_report.h"

#include <jansson.h>
#include <oriel/base/version.h>

static const char license[] = "MIT"; /* the identifier of SPDX */

enum { SHARED_LIBRARIES = ORL_CORE_LIBRARIES + 1 };

/* Libraries of core and api, which both programs use. */
static void fill_shared(struct orl_library_version libraries[SHARED_LIBRARIES])
{
    struct orl_library_version *jansson = &libraries[ORL_CORE_LIBRARIES];
    orl_core_library_versions(libraries);
    jansson->name = "jansson";
    snprintf(jansson->version, sizeof jansson->version, "%s", jansson_version_str());
}

static void print_text(FILE *stream, const struct orl_version_report *report,
                       const struct orl_library_version *shared)
{
    fprintf(stream, "%s %s\ncommit %s\nlicense %s\n", report->program, ORL_VERSION,
            *report->commit ? report->commit : "unknown", license);
    for (size_t i = 0; i < SHARED_LIBRARIES; i++)
        fprintf(stream, "%s %s\n", shared[i].name, shared[i].version);
    for (size_t i = 0; i < report->n_libraries; i++)
        fprintf(stream, "%s %s\n", report->libraries[i].name, report->libraries[i].version);
}

static int add_library(json_t *object, const struct orl_library_version *library)
{
    return json_object_set_new(object, library->name, json_string(library->version));
}

static int print_json(FILE *stream, const struct orl_version_report *report,
                      const struct orl_library_version *shared, struct orl_error *err)
{
    json_t *libraries = json_object();
    int failed = 0;
    for (size_t i = 0; i < SHARED_LIBRARIES; i++)
        failed = failed || add_library(libraries, &shared[i]) != 0;
    for (size_t i = 0; i < report->n_libraries; i++)
        failed = failed || add_library(libraries, &report->libraries[i]) != 0;
    json_t *json = json_pack("{s:s, s:s, s:s?, s:s, s:o}", "program", report->program, "version",
                             ORL_VERSION, "commit", *report->commit ? report->commit : NULL,
                             "license", license, "libraries", libraries);
    if (!json || failed) {
        json_decref(json);
        return orl_error_no_memory(err);
    }
    const int rc = json_dumpf(json, stream, JSON_INDENT(2));
    json_decref(json);
    if (rc != 0 || fputc('\n', stream) == EOF)
        return orl_error_set(err, ORL_ERR_IO, "the version cannot be written");
    return 0;
}

int orl_version_report_print(FILE *stream, const struct orl_version_report *report, bool as_json,
                             struct orl_error *err)
{
    struct orl_library_version shared[SHARED_LIBRARIES];
    fill_shared(shared);
    if (as_json)
        return print_json(stream, report, shared, err);
    print_text(stream, report, shared);
    return 0;
}
