#include "output/study_table.h"

#include <math.h>

#include "http/json_get.h"
#include "output/progress.h"

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
        fprintf(to, "times of %zu of %zu points are not known to %.0f %%: was the machine busy?\n",
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
        fprintf(to, "; %zu left out, not known to 1 %%", r->left_out);
    fprintf(to, "\n\n  %-12s %8s %8s %8s %8s %8s %8s %7s %6s %7s %7s %7s", "technique", "photons",
            "samples", "photon s", "map s", "render s", "total s", "rms %", "+-", "bias %",
            "noise %", "p95 %");
    if (study->of_views)
        fprintf(to, " %7s", "peak %");
    fprintf(to, " %9s\n", "maps");
    for (size_t i = 0; i < study->n_points; i++)
        print_point(to, &study->points[i], study->of_views);
    fprintf(to,
            "\n* nothing is both faster and more accurate; ~ the reference's own error shows\n");
    if (isfinite(study->rays_per_s))
        fprintf(to, "a second is worth %.2f M ray-times: single rays by Embree alone, one thread\n",
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
    format_setting((uint64_t)orl_json_number(point, "photons", 0),
                   (uint32_t)orl_json_number(point, "samples", 0), photons, samples);
    snprintf(ret_text, size, "%s, %s photons, %s samples: %.2f s, rms %.2f %%",
             orl_json_text(point, "technique"), photons, samples,
             orl_json_number(point, "total_s", NAN), 100 * orl_json_number(point, "rms", NAN));
}
