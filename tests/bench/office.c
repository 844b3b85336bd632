#include "bench/office.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "scene/built/scene.h"
#include "scene/parse/parse.h"

static char materials[] = "materials.rad", room[] = "room.rad", ground[] = "ground.rad",
            sky[] = "sky.rad", glazing[] = "glazing.rad", panel[] = "panel.rad";

const char office_source[] = "client/examples/office";
char *const office_names[OFFICE_FILES] = {materials, room, ground, sky, glazing, panel};
char office_sensors[] = "sensors.txt";

static int open_file(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    const struct office *office = ctx;
    if (strstr(name, ".xml"))
        return office->of_panel.open(office->of_panel.ctx, office->panel_name, ret_file, err);
    return office->of_source.open(office->of_source.ctx, name, ret_file, err);
}

static void close_file(void *ctx, struct orl_file *file)
{
    const struct office *office = ctx;
    office->of_source.close(office->of_source.ctx, file);
}

void office_make_panel(int resolution, char ret_path[BENCH_PATH])
{
    static const char source[] = "client/examples/office/lcp/lcp.rad";
    char program[BENCH_PATH], part[BENCH_PATH], name[32], side[8];
    snprintf(name, sizeof name, "panel-%d.xml", resolution);
    bench_kept(name, ret_path);
    if (access(ret_path, R_OK) == 0)
        return;
    fprintf(stderr, "  the BSDF of a panel of 2^%d is made, once\n", resolution);
    snprintf(name, sizeof name, "panel-%d.part", resolution);
    bench_kept(name, part);
    snprintf(side, sizeof side, "%d", 1 << resolution);
    snprintf(program, sizeof program, "%s/oriel", bench_build());
    const char *const argv[] = {
        program,      "bsdf",          "make",         source, "--cell",     "-0.002 0.002 0 0.004",
        "--basis",    "tensor_tree_4", "--resolution", side,   "--symmetry", "both",
        "--accuracy", "0.03",          "-o",           part,   NULL};
    if (bench_spawn(argv, NULL, NULL, NULL, NULL) != 0 || rename(part, ret_path) != 0)
        bench_fail("oriel bsdf make did not run; is oriel built?", NULL);
}

void office_open(struct office *office, const char *of_panel)
{
    *office = (struct office){.files = {.ctx = office,
                                        .open = open_file,
                                        .close = close_file,
                                        .passed = orl_files_release_pages}};
    bench_make_folder(office->folder);
    if (of_panel)
        snprintf(office->panel, sizeof office->panel, "%s", of_panel);
    else
        office_make_panel(6, office->panel);
    const char *slash = strrchr(office->panel, '/');
    if (!slash)
        bench_fail("the panel's BSDF is in no folder", NULL);
    office->panel_name = slash + 1;
    snprintf(office->panel_folder, sizeof office->panel_folder, "%.*s",
             (int)(slash - office->panel), office->panel);
    office->of_source = orl_files_from_folder(office_source);
    office->of_panel = orl_files_from_folder(office->panel_folder);
}

static bool give_digest(void *ctx, const char *name, unsigned char ret_digest[32])
{
    const struct office *office = ctx;
    const bool known = strstr(name, ".xml") != NULL;
    if (known)
        memcpy(ret_digest, office->digest, 32);
    return known;
}

void office_learn_digest(struct office *office)
{
    struct orl_error err = {0};
    struct orl_file file;
    if (office->of_panel.open(office->of_panel.ctx, office->panel_name, &file, &err) < 0)
        bench_fail("the panel's BSDF", &err);
    crypto_hash_sha256(office->digest, (const unsigned char *)file.data, file.size);
    office->of_panel.close(office->of_panel.ctx, &file);
    office->files.digest = give_digest;
}

void office_close(struct office *office)
{
    orl_scene_release(office->scene);
    bench_remove_folder(office->folder);
}

void office_job(struct orl_job *ret_job)
{
    orl_job_init(ret_job);
    ret_job->photons_exact = true;
    ret_job->technique = ORL_TECHNIQUE_GATHER;
    ret_job->scene_files = (char **)(uintptr_t)office_names;
    ret_job->n_scene_files = OFFICE_FILES;
}

static void load_scene(struct office *office)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    if (orl_scene_parse((const char *const *)(uintptr_t)office_names, OFFICE_FILES, &office->files,
                        &parsed_scene, &err) < 0 ||
        orl_scene_new(&parsed_scene, &office->scene, &err) < 0)
        bench_fail("loading the office", &err);
}

double office_rate(struct office *office, struct orl_thread_pool *pool, int runs)
{
    if (!office->scene)
        load_scene(office);
    return bench_embree_rate(office->scene->geometry, pool, runs);
}
