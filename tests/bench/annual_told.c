/*
 * Writes backward's results of some hours for annual_radiance.py: the office's files, hours, light.
 */
#include <stdio.h>
#include <stdlib.h>

#include "bench/annual.h"

static FILE *open_told(const struct annual_bench *bench, const char *what)
{
    static const char *const words[ANNUAL_SCENES] = {"glass", "panel"};
    char path[BENCH_PATH];
    snprintf(path, sizeof path, "%s/annual-%s-%s.json", bench_build(), words[bench->scene], what);
    FILE *file = fopen(path, "w");
    if (!file)
        bench_fail("what Radiance is to be compared with cannot be written", NULL);
    return file;
}

static void tell_numbers(FILE *file, const char *name, const double *values, size_t n)
{
    fprintf(file, ", \"%s\": [", name);
    for (size_t i = 0; i < n; i++)
        fprintf(file, "%s%.9g", i ? ", " : "", values[i]);
    fprintf(file, "]");
}

static void tell_weather(const struct annual_bench *bench)
{
    char path[BENCH_PATH];
    snprintf(path, sizeof path, "%s/annual-weather.txt", bench_build());
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bench->weather.data, 1, bench->weather.size, file) != bench->weather.size ||
        fclose(file) != 0)
        bench_fail("the weather cannot be written for Radiance", NULL);
}

void annual_tell_hours(const struct annual_bench *bench, double rate)
{
    const struct annual_truth *truth = &bench->truth;
    FILE *file = open_told(bench, "hours");
    tell_weather(bench);
    fprintf(file, "{\"rate\": %.0f, \"panel\": \"%s\", \"sensors\": [", rate, bench->office.panel);
    for (size_t i = 0; i < OFFICE_SENSORS; i++) {
        const struct orl_sensor *s = &bench->sensors[i];
        fprintf(file, "%s[%.9g, %.9g, %.9g, %.9g, %.9g, %.9g]", i ? ", " : "", s->position.x,
                s->position.y, s->position.z, s->direction.x, s->direction.y, s->direction.z);
    }
    fprintf(file, "],\n \"hours\": [");
    for (size_t h = 0; h < truth->n_hours; h++) {
        fprintf(file, "%s\n  {\"row\": %zu", h ? "," : "", truth->steps[h]);
        tell_numbers(file, "lx", truth->lx + h * OFFICE_SENSORS, OFFICE_SENSORS);
        tell_numbers(file, "se", truth->error_lx + h * OFFICE_SENSORS, OFFICE_SENSORS);
        fprintf(file, "}");
    }
    fprintf(file, "\n]}\n");
    fclose(file);
}

void annual_write_viewpoint(const struct annual_bench *bench, const struct orl_viewpoint *viewpoint,
                            const struct annual_truth *hours, const double *dgp)
{
    FILE *file = open_told(bench, viewpoint->name);
    fprintf(file, "{\"seat\": [%.9g, %.9g, %.9g, %.9g, %.9g, %.9g], \"rows\": [", viewpoint->at.x,
            viewpoint->at.y, viewpoint->at.z, viewpoint->towards.x, viewpoint->towards.y,
            viewpoint->towards.z);
    for (size_t h = 0; h < hours->n_hours; h++)
        fprintf(file, "%s%zu", h ? ", " : "", hours->steps[h]);
    fprintf(file, "]");
    tell_numbers(file, "dgp", dgp, hours->n_hours);
    fprintf(file, "}\n");
    fclose(file);
}
