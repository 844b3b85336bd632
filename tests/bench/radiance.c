#include "bench/radiance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/compare.h"
#include "run/request/job_inputs.h"

enum { MOST_ARGUMENTS = 64, COMMAND_BYTES = 1024 };

/* oconv starts the last three for the scene's command lines. */
static const char *const programs[] = {"oconv", "mkpmap", "rtrace",   "rpict",
                                       "xform", "genbox", "gendaylit"};
enum { PROGRAMS = sizeof programs / sizeof *programs };

/* mkpmap options for the photon ports, the materials of the panes. The panes face the room. */
static const char ports[] = "-apo0 panel_mat -apo0 clear_glass";
static const char sensors_name[] = "sensors.pts", results_name[] = "sensors.out",
                  image_name[] = "image.hdr", scene_name[] = "office.oct";

static const struct {
    const char *file, *make, *read, *more; /* more: further options of mkpmap */
} maps[RADIANCE_MAPS] = {
    {"global.pm", "-apg", "-ap global.pm 50", ""},
    {"caustic.pm", "-apc", "-ap caustic.pm 50", ""},
    {"precomputed.pm", "-app", "-ap precomputed.pm 1", "-apP 0.25"},
};

bool radiance_has(const char *program)
{
    const char *path = getenv("PATH");
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        char file[4096];
        snprintf(file, sizeof file, "%.*s/%s", (int)length, path, program);
        if (length > 0 && access(file, X_OK) == 0)
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

const char *radiance_missing(void)
{
    for (int i = 0; i < PROGRAMS; i++)
        if (!radiance_has(programs[i]))
            return programs[i];
    return NULL;
}

struct bench_use radiance_run(const struct radiance *r, const char *input, const char *output,
                              const char *format, ...)
{
    char text[COMMAND_BYTES], failed[COMMAND_BYTES + 32], *rest = NULL;
    const char *argv[MOST_ARGUMENTS + 1] = {NULL};
    struct bench_use use;
    size_t n = 0;
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(failed, sizeof failed, "failed: %s", text);
    for (char *word = strtok_r(text, " ", &rest); word && n < MOST_ARGUMENTS;
         word = strtok_r(NULL, " ", &rest))
        argv[n++] = word;
    if (bench_spawn(argv, r->folder, input, output, &use) != 0)
        bench_fail(failed, NULL);
    return use;
}

/* Writes the sensors as bare numbers, since rtrace reads no comments. */
static void write_sensors(const struct radiance *r)
{
    const struct orl_files *files = &r->office->files;
    char path[BENCH_PATH + 64];
    struct orl_sensor *sensors;
    struct orl_error err = {0};
    struct orl_file file;
    size_t n;
    if (files->open(files->ctx, office_sensors, &file, &err) < 0 ||
        orl_sensors_parse(office_sensors, file.data, file.size, &sensors, &n, &err) < 0)
        bench_fail("the office's sensors", &err);
    files->close(files->ctx, &file);
    snprintf(path, sizeof path, "%s/%s", r->folder, sensors_name);
    FILE *out = fopen(path, "w");
    if (!out)
        bench_fail("cannot write sensors for Radiance", NULL);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%.9g %.9g %.9g %.9g %.9g %.9g\n", sensors[i].position.x,
                sensors[i].position.y, sensors[i].position.z, sensors[i].direction.x,
                sensors[i].direction.y, sensors[i].direction.z);
    if (fclose(out) != 0)
        bench_fail("cannot write sensors for Radiance", NULL);
    free(sensors);
}

static int copy(const struct radiance *r, const char *name)
{
    char path[BENCH_PATH];
    snprintf(path, sizeof path, "%s/%s", office_source, name);
    const char *const argv[] = {"cp", path, r->folder, NULL};
    return bench_spawn(argv, NULL, NULL, NULL, NULL);
}

void radiance_open(struct radiance *r, const struct office *office, const char *name)
{
    char panel[BENCH_PATH + 32];
    r->office = office;
    snprintf(r->folder, sizeof r->folder, "%s/%s", office->folder, name);
    snprintf(panel, sizeof panel, "%s/lcp.xml", r->folder);
    const char *const make[] = {"mkdir", r->folder, NULL};
    const char *const panel_here[] = {"cp", office->panel, panel, NULL};
    int status = bench_spawn(make, NULL, NULL, NULL, NULL);
    status |= bench_spawn(panel_here, NULL, NULL, NULL, NULL);
    for (int i = 0; i < OFFICE_FILES; i++)
        status |= copy(r, office_names[i]);
    status |= copy(r, "upper_pane.rad") | copy(r, "upper_glass.rad");
    if (status != 0)
        bench_fail("cannot copy the office for Radiance", NULL);
    write_sensors(r);
    radiance_octree(r, office_names[OFFICE_FILES - 1], scene_name);
}

void radiance_octree(const struct radiance *r, const char *panes, const char *name)
{
    char list[256] = "";
    for (int i = 0; i + 1 < OFFICE_FILES; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), " %s", office_names[i]);
    radiance_run(r, NULL, name, "oconv%s %s", list, panes);
}

struct bench_use radiance_make_map(const struct radiance *r, enum radiance_map map,
                                   uint64_t photons)
{
    return radiance_run(r, NULL, NULL, "mkpmap %s %s %llu%s %s %s %s", maps[map].make,
                        maps[map].file, (unsigned long long)photons,
                        map == RADIANCE_PRECOMPUTED ? " 50" : "", maps[map].more, ports,
                        scene_name);
}

void radiance_use_maps(const bool uses[RADIANCE_MAPS], char ret_options[256])
{
    *ret_options = '\0';
    for (int map = 0; map < RADIANCE_MAPS; map++)
        if (uses[map])
            snprintf(ret_options + strlen(ret_options), 256 - strlen(ret_options), " %s",
                     maps[map].read);
}

/* Reads irradiance, three channels per line, and converts it to lux. */
static void read_lux(const struct radiance *r, double lx[OFFICE_SENSORS])
{
    char path[BENCH_PATH + 64];
    snprintf(path, sizeof path, "%s/%s", r->folder, results_name);
    FILE *in = fopen(path, "r");
    for (int i = 0; i < OFFICE_SENSORS; i++) {
        struct orl_rgb c;
        if (!in || fscanf(in, "%lf %lf %lf", &c.r, &c.g, &c.b) != 3)
            bench_fail("rtrace wrote no irradiances", NULL);
        lx[i] = ORL_EFFICACY_LM_PER_W * orl_luma(c);
    }
    fclose(in);
}

struct bench_use radiance_sensors(const struct radiance *r, const char *options,
                                  double ret_lx[OFFICE_SENSORS])
{
    const struct bench_use use =
        radiance_run(r, sensors_name, results_name, "rtrace -h -I %s %s", options, scene_name);
    read_lux(r, ret_lx);
    return use;
}

struct bench_use radiance_image(const struct radiance *r, const char *options, uint32_t width,
                                uint32_t height, double **ret_luminances)
{
    char image[BENCH_PATH + 64];
    const struct bench_use use =
        radiance_run(r, NULL, image_name, "rpict %s -x %u -y %u -pa 0 -ps 1 %s %s", OFFICE_VIEW,
                     width, height, options, scene_name);
    snprintf(image, sizeof image, "%s/%s", r->folder, image_name);
    *ret_luminances = bench_read_luminances(image, (int)width, (int)height);
    return use;
}
