#include "bench/office.h"

#include <stdio.h>
#include <string.h>

#include "light/world.h"
#include "scene/parse.h"

static char materials[] = "materials.rad", room[] = "room.rad", ground[] = "ground.rad",
            sky[] = "sky.rad", glazing[] = "glazing.rad", panel[] = "panel.rad";

const char office_source[] = "client/examples/office";
char *const office_names[OFFICE_FILES] = {materials, room, ground, sky, glazing, panel};
char office_sensors[] = "sensors.txt";

static int open_file(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    const struct office *office = ctx;
    const struct orl_files *from = strstr(name, ".xml") ? &office->of_folder : &office->of_source;
    return from->open(from->ctx, name, ret_file, err);
}

static void close_file(void *ctx, struct orl_file *file)
{
    const struct office *office = ctx;
    office->of_source.close(office->of_source.ctx, file);
}

/* The panel's BSDF, 2^6, by the example's own generator. */
static void make_panel(const struct office *office)
{
    char program[BENCH_PATH], path[BENCH_PATH + 16];
    snprintf(program, sizeof program, "%s/oriel-lcp", bench_build());
    snprintf(path, sizeof path, "%s/lcp.xml", office->folder);
    const char *const argv[] = {program, "--resolution", "6", "--seed", "1", "-o", path, NULL};
    if (bench_spawn(argv, NULL, NULL, NULL, NULL) != 0)
        bench_fail("oriel-lcp did not run; is it built?", NULL);
}

void office_open(struct office *office)
{
    bench_make_folder(office->folder);
    office->files = (struct orl_files){.ctx = office, .open = open_file, .close = close_file};
    office->of_source = orl_files_from_folder(office_source);
    office->of_folder = orl_files_from_folder(office->folder);
    make_panel(office);
}

void office_close(struct office *office)
{
    bench_remove_folder(office->folder);
}

void office_job(struct orl_job *ret_job)
{
    orl_job_init(ret_job);
    ret_job->technique = ORL_TECHNIQUE_GATHER;
    ret_job->scene_files = (char **)(uintptr_t)office_names;
    ret_job->n_scene_files = OFFICE_FILES;
}

double office_rate(const struct office *office, int runs, double (*now_s)(void *ctx))
{
    struct orl_description description = {0};
    struct orl_world *world;
    struct orl_error err = {0};
    if (orl_scene_parse((const char *const *)(uintptr_t)office_names, OFFICE_FILES, &office->files,
                        &description, &err) < 0 ||
        orl_world_new(&description, &world, &err) < 0)
        bench_fail("loading the office", &err);
    const double rate = bench_embree_rate(world->geometry, runs, now_s);
    orl_world_free(world);
    return rate;
}
