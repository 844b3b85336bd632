#include "bench/reference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char view_text[] = OFFICE_VIEW;
static char view_name[] = "reference";

static size_t pixels(const struct office_reference *reference)
{
    return (size_t)reference->width * reference->height;
}

/* Settings of a half; its values are the sensors, then the pixels. */
struct halves {
    const struct office *office;
    const struct office_reference *reference;
};

static void render_half(const void *ctx, uint64_t seed, double *ret_values)
{
    const struct office *office = ((const struct halves *)ctx)->office;
    const struct office_reference *reference = ((const struct halves *)ctx)->reference;
    struct orl_view_request view = {.name = view_name,
                                    .view = view_text,
                                    .width = reference->width,
                                    .height = reference->height};
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    struct orl_thread_pool *pool = orl_thread_pool_start(cores > 1 ? (uint32_t)cores : 1);
    char maps[BENCH_PATH + 16], image[BENCH_PATH + 32];
    struct orl_result r;
    struct orl_job job;
    if (!pool)
        bench_fail("out of memory", NULL);
    snprintf(maps, sizeof maps, "%s/maps", office->folder);
    snprintf(image, sizeof image, "%s/%s.hdr", office->folder, view_name);
    const struct bench_env env = {.files = &office->files,
                                  .pool = pool,
                                  .maps = maps,
                                  .output = office->folder,
                                  .now_s = bench_wall_s};
    office_job(&job);
    job.technique = ORL_TECHNIQUE_BACKWARD;
    job.seed = seed;
    job.gather_samples = reference->sensor_samples;
    job.pixel_samples = reference->pixel_samples;
    job.sensors_file = office_sensors;
    job.views = &view;
    job.n_views = pixels(reference) > 0;
    bench_run(&env, &job, &r);
    memcpy(ret_values, r.illuminance_lx, OFFICE_SENSORS * sizeof *ret_values);
    if (job.n_views > 0) {
        double *read = bench_read_luminances(image, (int)view.width, (int)view.height);
        memcpy(ret_values + OFFICE_SENSORS, read, pixels(reference) * sizeof *read);
        free(read);
    }
    orl_result_done(&r);
    bench_remove_folder(maps);
    orl_thread_pool_stop(pool);
}

/* The digest of the scene also depends on the panel. */
static void name_file(const struct office *office, const struct office_reference *reference,
                      char ret_name[BENCH_PATH])
{
    struct orl_scene_summary summary = {0};
    struct orl_error err = {0};
    if (orl_scene_check((const char *const *)(uintptr_t)office_names, OFFICE_FILES, &office->files,
                        NULL, &summary, &err) < 0)
        bench_fail("the office", &err);
    snprintf(ret_name, BENCH_PATH, "reference-%.16s-%ux%u-%u-%u.bin", summary.digest,
             reference->width, reference->height, reference->pixel_samples,
             reference->sensor_samples);
    orl_scene_summary_done(&summary);
}

static bool read_file(const char *path, double *values, size_t n)
{
    FILE *in = fopen(path, "rb");
    const bool whole = in && fread(values, sizeof *values, n, in) == n;
    if (in)
        fclose(in);
    return whole;
}

static void write_file(const char *path, const double *values, size_t n)
{
    char part[BENCH_PATH + 8];
    snprintf(part, sizeof part, "%s.part", path);
    FILE *out = fopen(part, "wb");
    const bool whole = out && fwrite(values, sizeof *values, n, out) == n;
    if (!out || fclose(out) != 0 || !whole || rename(part, path) != 0)
        bench_fail("cannot keep the reference", NULL);
}

static double *copy(const double *values, size_t n)
{
    double *copied = malloc(n * sizeof *copied);
    if (!copied)
        bench_fail("out of memory", NULL);
    memcpy(copied, values, n * sizeof *copied);
    return copied;
}

void bench_reference_find(const char *name, size_t n, bench_reference_half *make, const void *ctx,
                          double *ret_values)
{
    const double started = bench_wall_s(NULL);
    char path[BENCH_PATH];
    bench_kept(name, path);
    if (read_file(path, ret_values, 2 * n))
        return;
    for (uint64_t half = 0; half < 2; half++)
        make(ctx, 1000001 + half, ret_values + half * n);
    write_file(path, ret_values, 2 * n);
    fprintf(stderr, "  reference %s made in %.0f s, and kept\n", name,
            bench_wall_s(NULL) - started);
}

void office_reference_make(const struct office *office, struct office_reference *reference)
{
    const size_t n_pixels = pixels(reference), n = OFFICE_SENSORS + n_pixels;
    double *values = malloc(2 * n * sizeof *values);
    const struct halves halves = {office, reference};
    char name[BENCH_PATH];
    if (!values)
        bench_fail("out of memory", NULL);
    name_file(office, reference, name);
    bench_reference_find(name, n, render_half, &halves, values);
    reference->sensors = (struct bench_reference){copy(values, OFFICE_SENSORS),
                                                  copy(values + n, OFFICE_SENSORS), OFFICE_SENSORS};
    reference->image =
        (struct bench_reference){copy(values + OFFICE_SENSORS, n_pixels),
                                 copy(values + n + OFFICE_SENSORS, n_pixels), n_pixels};
    free(values);
}

void office_reference_done(struct office_reference *reference)
{
    bench_reference_done(&reference->sensors);
    bench_reference_done(&reference->image);
}
