/* oriel bsdf check FILE: checks a BSDF. Other verbs have files of their own, such as
 * cmd_bsdf_fit.c. */
#include "options/command.h"

#include <stdio.h>
#include <string.h>

#include <oriel/base/suggest.h>
#include <oriel/bsdf/bsdf.h>

#include "bsdf_json/bsdf_json.h"
#include "commands/local.h"
#include "output/reports.h"

static void print_directions(const struct orl_bsdf_check *c)
{
    printf("\n%-14s %10s %21s %21s\n", "light from", "", "outside (file Front)",
           "inside (file Back)");
    printf("%8s %8s %10s %10s %10s %10s %10s\n", "theta", "phi", "", "reflected", "transmit.",
           "reflected", "transmit.");
    for (int i = 0; i < ORL_BSDF_CHECK_DIRECTIONS; i++) {
        const struct orl_bsdf_hemispherical *out = &c->directions[0][i], *in = &c->directions[1][i];
        printf("%8.0f %8.0f %10s %10.4f %10.4f %10.4f %10.4f\n", out->theta_deg, out->phi_deg, "",
               out->reflected, out->transmitted, in->reflected, in->transmitted);
    }
}

/* Prints the extremes; "coarse" allows a comparison with Radiance's checkBSDF. */
static void print_extremes(const struct orl_bsdf_check *c)
{
    static const char *const names[] = {"least", "diffuse", "most", "most, coarse"};
    for (int i = 0; i < 4; i++) {
        printf("%-28s", names[i]);
        for (int k = 0; k < 4; k++) {
            const struct orl_bsdf_extremes *x = &c->extremes[k / 2][k % 2];
            const double values[] = {x->least, x->mean, x->most, x->most_coarse};
            printf(" %10.4f", values[i]);
        }
        printf("\n");
    }
}

static void print_check(const char *file, const struct orl_bsdf_check *c)
{
    const struct orl_bsdf_info *info = &c->info;
    printf("%s: %s, resolution %d, %zu values", file, info->kind, info->resolution, info->values);
    if (info->name[0] != '\0')
        printf(", \"%s\"", info->name);
    if (info->colored)
        printf(", in colour");
    if (info->thickness_m > 0)
        printf(", %.4g mm thick", 1000 * info->thickness_m);
    printf("\n");
    print_directions(c);
    print_extremes(c);
    printf("\n");
    for (size_t i = 0; i < c->n_verdicts; i++)
        printf("%-8s %s\n", orl_bsdf_level_name(c->verdicts[i].level), c->verdicts[i].text);
}

static int examine_file(const char *path, struct orl_bsdf_check *ret_check, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    const int rc = orl_bsdf_file_load(path, &bsdf, err);
    if (rc == 0)
        orl_bsdf_examine(bsdf, ret_check);
    orl_bsdf_unref(bsdf);
    return rc;
}

/* Verbs in files of their own. */
/* Verbs besides check, each with a help of its own. */
static const struct orl_subcommand verbs[] = {
    {"bsdf fit", "DATA...|FILE.json -o FILE.xml [...]",
     "Fit a BSDF to goniophotometer measurements",
     "DATA are pab-opto's text files, with an incident direction each, or CSV with columns\n"
     "theta_in, phi_in, theta_out, phi_out and bsdf or dsf (degrees, theta from the\n"
     "inside's normal). FILE.json is a document (\"kind\": \"bsdf_fit\") with the same\n"
     "members. fit reports how well each direction is predicted by the others.",
     orl_cmd_bsdf_fit, "oriel bsdf fit measured.csv -o glass.xml"},
    {"bsdf make", "PANEL.rad...|FILE.json -o FILE.xml [...]",
     "Make the BSDF of a panel of geometry, by a virtual goniophotometer",
     "The panel is scene files of any geometry and materials in the xy plane, y up, z\n"
     "towards the inside; it is repeated without end. FILE.json is a document (\"kind\":\n"
     "\"bsdf_make\") with the same members.",
     orl_cmd_bsdf_make, "oriel bsdf make blinds.rad -o blinds.xml"},
    {"bsdf convert", "FILE.xml -o FILE.xml [...]",
     "Change the basis, resolution or cull of a BSDF, and print the loss", NULL,
     orl_cmd_bsdf_convert, "oriel bsdf convert blinds.xml -o klems.xml --basis klems_full"},
    {"bsdf compare", "FILE.xml FILE.xml [--report FILE]", "Print the differences of two BSDFs",
     "Differences are printed in total, in cones of two degrees, and as the light that is\n"
     "sent elsewhere.",
     orl_cmd_bsdf_compare, "oriel bsdf compare blinds.xml klems.xml"},
    {"bsdf plot", "FILE.xml [FILE.xml] -o PICTURE [...]",
     "Draw the scattering of light from one direction",
     "Two files are drawn side by side, with their difference.", orl_cmd_bsdf_plot,
     "oriel bsdf plot blinds.xml -o blinds.png --theta 40"},
};
enum { VERB_NAME = sizeof "bsdf " - 1 }; /* where a verb begins in its name */

static int refuse_verb(const struct orl_subcommand *self, const char *given)
{
    struct orl_suggestion suggestion = {.word = given};
    orl_suggestion_add(&suggestion, "check");
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++)
        orl_suggestion_add(&suggestion, verbs[i].name + VERB_NAME);
    return orl_usage_error(self,
                           "\"%s\" is not one of check, fit, make, convert, compare, plot%s%s%s",
                           given, suggestion.best ? "; did you mean \"" : "",
                           suggestion.best ? suggestion.best : "", suggestion.best ? "\"?" : "");
}

int orl_cmd_bsdf(const struct orl_subcommand *self, int argc, char **argv)
{
    bool as_json = false;
    const struct orl_option options[] = {
        {"json", 0, NULL, "print the daemon's reply as JSON", NULL, &as_json},
    };
    struct orl_operands operands;
    struct orl_bsdf_check check = {0};
    struct orl_error err = {0};
    int rc;
    for (size_t i = 0; argc > 1 && i < sizeof verbs / sizeof *verbs; i++)
        if (strcmp(argv[1], verbs[i].name + VERB_NAME) == 0)
            return verbs[i].run(&verbs[i], argc - 1, argv + 1);
    if (argc > 1 && argv[1][0] != '-' && strcmp(argv[1], "check") != 0)
        return refuse_verb(self, argv[1]);
    if (!orl_options_parse(self, argc, argv, options, 1, 2, 2, &operands, &rc))
        return rc;
    if (strcmp(operands.items[0], "check") != 0)
        return refuse_verb(self, operands.items[0]);
    if (examine_file(operands.items[1], &check, &err) < 0)
        return orl_report_error(&err);
    if (!as_json)
        print_check(operands.items[1], &check);
    else if (orl_print_json(orl_bsdf_check_to_json(&check), 9, &err))
        return orl_report_error(&err);
    return check.worst == ORL_BSDF_FAULT ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}
