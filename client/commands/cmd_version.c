/* oriel version, which `oriel --version` runs, too. */
#include "options/command.h"

#include <stdio.h>

#include <curl/curl.h>

#include "commit.h"
#include "output/reports.h"
#include "result/version_report.h"

int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv)
{
    bool as_json = false;
    const struct orl_option options[] = {
        {"json", 0, NULL, "print an object, for programs", NULL, &as_json},
    };
    struct orl_operands operands;
    struct orl_library_version curl = {.name = "libcurl"};
    struct orl_error err = {0};
    int code;
    if (!orl_options_parse(self, argc, argv, options, 1, 0, 0, &operands, &code))
        return code;
    snprintf(curl.version, sizeof curl.version, "%s", curl_version_info(CURLVERSION_NOW)->version);
    const struct orl_version_report report = {
        .program = "oriel", .commit = ORL_COMMIT, .libraries = &curl, .n_libraries = 1};
    return orl_version_report_print(stdout, &report, as_json, &err) ? orl_report_error(&err)
                                                                    : ORL_EXIT_OK;
}
