#include <math.h>
#include <stdio.h>
#include <string.h>

#include "http/json_get.h"
#include "options/command.h"
#include "output/reports.h"
#include "output/style.h"
#include "output/terminal.h"
#include "json/problem.h"

int orl_report_reply_to_error(const char *body, size_t size, long status, struct orl_error *err)
{
    json_t *problem = size ? json_loadb(body, size, 0, NULL) : NULL;
    struct orl_error found = {0};
    if (json_is_object(problem))
        orl_problem_to_error(problem, &found);
    json_decref(problem);
    if (!found.message[0])
        return orl_error_set(err, status == 404 ? ORL_ERR_NOT_FOUND : ORL_ERR_INVALID,
                             "the daemon answered %ld and gave no reason", status);
    if (err)
        *err = found;
    return found.code;
}

int orl_report_error(const struct orl_error *err)
{
    char text[2 * ORL_ERROR_TEXT_MAX + 2 * ORL_ERROR_NAME_MAX + 64];
    orl_error_format(err, text, sizeof text);
    /* The line starts with the file, as compilers do, or else with the program's name. */
    fprintf(stderr, "%s%s%s%s\n", orl_style_begin(stderr, ORL_STYLE_BAD),
            err->file[0] ? "" : "oriel: ", text, orl_style_end(stderr));
    return ORL_EXIT_FAILED;
}

int orl_print_json(json_t *json, size_t digits, struct orl_error *err)
{
    int rc = json ? 0 : orl_error_no_memory(err);
    if (json && json_dumpf(json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(digits)) != 0)
        rc = orl_error_set(err, ORL_ERR_IO, "standard output cannot be written");
    json_decref(json);
    if (rc == 0)
        putchar('\n');
    return rc;
}

void orl_print_warnings(json_t *warnings)
{
    for (size_t i = 0; i < json_array_size(warnings); i++)
        fprintf(stderr, "%swarning:%s %s\n", orl_style_begin(stderr, ORL_STYLE_WARNING),
                orl_style_end(stderr), json_string_value(json_array_get(warnings, i)));
    json_decref(warnings);
}

void orl_report_job_error(const json_t *job)
{
    const json_t *problem = json_object_get(job, "error");
    struct orl_error err;
    if (!json_is_object(problem))
        return;
    orl_problem_to_error(problem, &err);
    orl_report_error(&err);
}

enum { NAME_WIDTH = 24, CELL = 32 };

/* Prints at most `most` UTF-8 characters, padded with blanks. */
static void print_padded(const char *text, int most)
{
    int characters = 0;
    for (const char *c = text; *c; c++) {
        if ((*c & 0xc0) != 0x80 && characters++ == most)
            break;
        putchar(*c);
    }
    printf("%*s", characters < most ? most - characters : 0, "");
}

/* Prints the name, or else the tags, if any. */
static void print_name(const json_t *job)
{
    const json_t *tags = json_object_get(job, "tags");
    char text[400] = "";
    size_t used = 0;
    if (*orl_get_text(job, "name")) {
        print_padded(orl_get_text(job, "name"), NAME_WIDTH);
        return;
    }
    for (size_t i = 0; i < json_array_size(tags) && used + 1 < sizeof text; i++) {
        const char *tag = json_string_value(json_array_get(tags, i));
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%s", i ? "," : "", tag ? tag : "");
    }
    print_padded(text, NAME_WIDTH);
}

/* Formats "42.0 %", or "" if unknown. */
static void format_share(double percent, char ret_text[CELL])
{
    if (percent >= 0)
        snprintf(ret_text, CELL, "%.1f %%", percent);
    else
        ret_text[0] = '\0';
}

void orl_print_job(const json_t *job)
{
    const double eta_s = orl_get_number(job, "eta_s", -1);
    const double position = orl_get_number(job, "queue_position", -1);
    char percent[CELL], eta[CELL] = "", error[CELL];
    format_share(orl_get_number(job, "percent", -1), percent);
    format_share(100 * orl_get_number(job, "error", -1), error);
    if (eta_s >= 0)
        orl_format_duration(eta_s, eta, sizeof eta);
    else if (position > 0)
        snprintf(eta, sizeof eta, "%.0f. in line", position);
    printf("%-8.8s  ", orl_get_text(job, "id"));
    print_name(job);
    const char *state = orl_get_text(job, "state");
    printf("  %-6s  %s%-10s%s  %8s  %11s  %7s  %.19s\n", orl_get_text(job, "kind"),
           orl_style_begin(stdout, orl_style_of_word(state)), state, orl_style_end(stdout), percent,
           eta, error, orl_get_text(job, "created"));
}

void orl_print_job_heading(void)
{
    printf("%s%-8s  %-*s  %-6s  %-10s  %8s  %11s  %7s  %s%s\n",
           orl_style_begin(stdout, ORL_STYLE_HEADING), "id", NAME_WIDTH, "name", "kind", "state",
           "progress", "eta", "error", "created (UTC)", orl_style_end(stdout));
}

void orl_print_jobs(const json_t *jobs)
{
    const json_t *job;
    size_t i;
    orl_print_job_heading();
    json_array_foreach(jobs, i, job)
    {
        orl_print_job(job);
    }
}

static void format_setting(uint64_t photons, uint32_t samples, char ret_photons[32],
                           char ret_samples[32])
{
    snprintf(ret_photons, 32, "-");
    snprintf(ret_samples, 32, "-");
    if (photons)
        orl_format_amount((double)photons, "", ret_photons, 32);
    if (samples)
        snprintf(ret_samples, 32, "%u", samples);
}

/* Prints a fraction in percent, or a dash if unknown. */
static void print_percent(FILE *to, int width, double fraction)
{
    if (isfinite(fraction))
        fprintf(to, " %*.2f", width, 100 * fraction);
    else
        fprintf(to, " %*s", width, "-");
}

static void print_point(FILE *to, const struct orl_study_point *p, bool of_views)
{
    char photons[32], samples[32], bytes[32];
    format_setting(p->setting.photons, p->setting.samples, photons, samples);
    orl_format_amount((double)p->map_bytes, "B", bytes, sizeof bytes);
    fprintf(to, "%c %-12s %8s %8s %8.2f %8.2f %8.2f %8.2f", p->on_front ? '*' : ' ',
            orl_technique_name(p->setting.technique), photons, samples,
            p->stages_s[ORL_STAGE_PHOTONS], p->stages_s[ORL_STAGE_MAPS],
            p->stages_s[ORL_STAGE_RENDER], p->total_s);
    print_percent(to, 7, p->rms);
    print_percent(to, 6, p->rms_error);
    print_percent(to, 7, p->bias);
    print_percent(to, 7, p->noise);
    print_percent(to, 7, p->p95);
    if (of_views)
        print_percent(to, 7, p->peak);
    fprintf(to, " %9s%s\n", p->map_bytes ? bytes : "-", p->reference_shows ? " ~" : "");
}

static void print_fit(FILE *to, const struct orl_study_fit *fit)
{
    static const char *const behind[ORL_FIT_TERMS] = {"", " / N", " / N^2", " / S"};
    bool first = true;
    fprintf(to, "%-12s rms^2 =", orl_technique_name(fit->technique));
    for (int t = 0; t < ORL_FIT_TERMS; t++) {
        if (isnan(fit->terms[t]))
            continue;
        fprintf(to, "%s (%.2g +- %.1g)%s", first ? "" : " +", fit->terms[t], fit->errors[t],
                behind[t]);
        first = false;
    }
    fprintf(to, "; %.0f %% off", 100 * fit->residual);
    if (isfinite(fit->chi2))
        fprintf(to, ", chi2 %.1f", fit->chi2);
    fprintf(to, "\n");
}

/* Reports times that vary between seeds, because other programs may have been running. */
static void print_unsteady(FILE *to, const struct orl_study *study)
{
    const double steady = 0.1;
    size_t n = 0;
    for (size_t i = 0; i < study->n_points; i++)
        n += study->points[i].total_error_s > steady * study->points[i].total_s ? 1 : 0;
    if (n > 0)
        fprintf(to,
                "times of %zu of %zu points are uncertain by more than %.0f %%: was the machine "
                "busy?\n",
                n, study->n_points, 100 * steady);
}

void orl_study_print(FILE *to, const struct orl_study *study)
{
    const struct orl_study_reference *r = &study->reference;
    fprintf(to,
            "reference: backward, %u samples in %u runs, %.1f s; standard error %.2f %% (largest "
            "%.2f %%)",
            r->samples, r->runs, r->seconds, 100 * r->standard_error, 100 * r->worst);
    fprintf(to, " of %zu %s", r->values, study->of_views ? "pixels" : "sensors");
    if (r->left_out)
        fprintf(to, "; %zu left out, with standard errors above 1 %%", r->left_out);
    fprintf(to, "\n\n  %-12s %8s %8s %8s %8s %8s %8s %7s %6s %7s %7s %7s", "technique", "photons",
            "samples", "photon s", "map s", "render s", "total s", "rms %", "+-", "bias %",
            "noise %", "p95 %");
    if (study->of_views)
        fprintf(to, " %7s", "peak %");
    fprintf(to, " %9s\n", "maps");
    for (size_t i = 0; i < study->n_points; i++)
        print_point(to, &study->points[i], study->of_views);
    fprintf(to, "\n* no other setting is both faster and more accurate; ~ affected by the "
                "reference's own error\n");
    if (isfinite(study->rays_per_s))
        fprintf(to,
                "speed of this machine: %.2f M rays per second (single rays, Embree, one thread)\n",
                1e-6 * study->rays_per_s);
    print_unsteady(to, study);
    if (study->n_fits > 0)
        fprintf(to, "\nN photons, S samples:\n");
    for (size_t i = 0; i < study->n_fits; i++)
        print_fit(to, &study->fits[i]);
}

void orl_format_study_point(const json_t *point, char *ret_text, size_t size)
{
    char photons[32], samples[32];
    format_setting((uint64_t)orl_get_number(point, "photons", 0),
                   (uint32_t)orl_get_number(point, "samples", 0), photons, samples);
    snprintf(ret_text, size, "%s, %s photons, %s samples: %.2f s, rms %.2f %%",
             orl_get_text(point, "technique"), photons, samples,
             orl_get_number(point, "total_s", NAN), 100 * orl_get_number(point, "rms", NAN));
}

static void print_value(FILE *to, const json_t *verdict)
{
    const json_t *value = json_object_get(verdict, "value");
    const json_t *interval = json_object_get(verdict, "interval_95");
    const json_t *low = json_array_get(interval, 0), *high = json_array_get(interval, 1);
    if (!json_is_number(value))
        return;
    fprintf(to, ": %.4g", json_number_value(value));
    if (json_is_number(low) && json_is_number(high))
        fprintf(to, " [%.4g, %.4g]", json_number_value(low), json_number_value(high));
}

static void print_verdict(FILE *to, const json_t *verdict)
{
    const char *rule = orl_get_text(verdict, "rule"), *target = orl_get_text(verdict, "target");
    const char *grid = orl_get_text(verdict, "grid"), *note = orl_get_text(verdict, "note");
    const char *word = orl_get_text(verdict, "verdict");
    fprintf(to, "%s%-10s%s %s%s%s (%s)", orl_style_begin(to, orl_style_of_word(word)), word,
            orl_style_end(to), rule, *rule && *target ? ": " : "", target,
            *grid ? grid : "all grids");
    print_value(to, verdict);
    fprintf(to, "%s%s\n", *note ? ": " : "", note);
}

void orl_print_verdicts(FILE *to, const json_t *verdicts)
{
    const json_t *one;
    size_t i;
    json_array_foreach(verdicts, i, one)
    {
        print_verdict(to, one);
    }
}
