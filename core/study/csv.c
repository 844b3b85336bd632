/* Writes a study's points as comma-separated values. */
#include <math.h>

#include <oriel/job/study.h>

#include "base/io/out_file.h"

static void write_names(FILE *stream)
{
    fputs("technique,photons,samples,seeds", stream);
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        fprintf(stream, ",%s_s", orl_stage_name((enum orl_stage)i));
    fputs(",total_s,total_error_s,rms,rms_error,bias,bias_error,noise,p95,peak,map_bytes,"
          "reference_shows,on_front\n",
          stream);
}

/* Writes nothing between the commas if the number is unknown. */
static void write_number(FILE *stream, double value)
{
    if (isfinite(value))
        fprintf(stream, ",%.6g", value);
    else
        fputc(',', stream);
}

static void write_point(FILE *stream, const struct orl_study_point *p)
{
    const double measures[] = {p->total_s,    p->total_error_s, p->rms, p->rms_error, p->bias,
                               p->bias_error, p->noise,         p->p95, p->peak};
    fprintf(stream, "%s,%llu,%u,%u", orl_technique_name(p->setting.technique),
            (unsigned long long)p->setting.photons, p->setting.samples, p->seeds);
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        write_number(stream, p->stages_s[i]);
    for (size_t i = 0; i < sizeof measures / sizeof *measures; i++)
        write_number(stream, measures[i]);
    fprintf(stream, ",%llu,%d,%d\n", (unsigned long long)p->map_bytes, p->reference_shows,
            p->on_front);
}

int orl_study_write_csv(const struct orl_study *study, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    write_names(file.stream);
    for (size_t i = 0; i < study->n_points; i++)
        write_point(file.stream, &study->points[i]);
    return orl_out_close(&file, 0, err);
}
