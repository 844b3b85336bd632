/*
 * `make bench-polygons`: time and memory of loading a scene of five million polygons.
 *
 * Two kinds: polygons that share their corners, and polygons that share none (support/polygons.h).
 * It prints polygons parsed per second, by processor time and by wall time; resident bytes per
 * polygon once loaded, and at peak; and the stages of three jobs by orl_run. The first stores the
 * parsed scene, the second finds it in the memory cache, the third, in another process, reads the
 * stored scene (scene/cache/scene_cache_file.h).
 *
 * ORIEL_POLYGONS: number of polygons, 5000000. ORIEL_POLYGONS_KINDS: "shared", "apart".
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/bench.h"
#include "scene/built/scene.h"
#include "scene/parse/parse.h"
#include "support/polygons.h"

enum { A_FILE = 1000000, MOST_FILES = 6, NAME = 32 };

struct files {
    char folder[BENCH_PATH];
    char names[MOST_FILES][NAME];
    const char *list[MOST_FILES];
    size_t n, polygons;
};

static void write_file(struct files *files, const char *name, const char *text, size_t size)
{
    char path[BENCH_PATH + NAME];
    snprintf(files->names[files->n], NAME, "%s", name);
    snprintf(path, sizeof path, "%s/%s", files->folder, name);
    FILE *const f = fopen(path, "w");
    if (!f || fwrite(text, 1, size, f) != size || fclose(f) != 0)
        bench_fail("a file of polygons", NULL);
    files->list[files->n] = files->names[files->n];
    files->n++;
}

static void write_files(struct files *files, bool apart)
{
    files->n = 0;
    write_file(files, "materials.rad", polygons_materials, strlen(polygons_materials));
    for (size_t first = 0; first < files->polygons; first += A_FILE) {
        const size_t left = files->polygons - first, count = left < A_FILE ? left : A_FILE;
        char name[NAME];
        size_t size;
        char *const text = polygons_text(first, count, apart, &size);
        if (!text)
            bench_fail("out of memory", NULL);
        snprintf(name, sizeof name, "polygons-%zu.rad", first / A_FILE);
        write_file(files, name, text, size);
        free(text);
    }
}

/* ---- Loaded by itself ------------------------------------------------------------------------ */

static void load(const struct files *files)
{
    const struct orl_files from = orl_files_from_folder(files->folder);
    const double n = (double)files->polygons;
    struct orl_parsed_scene parsed_scene;
    struct orl_scene *scene = NULL;
    struct orl_error err = {0};
    struct orl_thread_pool *const pool = orl_thread_pool_start(2);
    const double empty = (double)polygons_resident_bytes();
    const double wall = bench_wall_s(NULL), cpu = bench_cpu_s(NULL);
    if (orl_scene_parse(files->list, files->n, &from, &parsed_scene, &err) < 0)
        bench_fail("parsing", &err);
    const double parsed_wall = bench_wall_s(NULL), parsed_cpu = bench_cpu_s(NULL);
    const double described = (double)polygons_resident_bytes();
    if (orl_scene_new(&parsed_scene, &scene, &err) < 0)
        bench_fail("building", &err);
    if (orl_scene_find_ports(scene, pool, &err) < 0)
        bench_fail("finding windows", &err);
    const double built_wall = bench_wall_s(NULL), built_cpu = bench_cpu_s(NULL);
    printf("  parse         %6.2f M polygons/s by the clock, %.2f by processor time\n",
           n / (parsed_wall - wall) / 1e6, n / (parsed_cpu - cpu) / 1e6);
    printf("  build         %6.2f s by the clock, %.2f by processor time\n",
           built_wall - parsed_wall, built_cpu - parsed_cpu);
    const double bytes = (double)polygons_resident_bytes() - empty;
    printf("  resident      %6.1f bytes a polygon; as text is parsed %.1f, at most %.1f\n",
           bytes / n, (described - empty) / n, (bench_peak_bytes() - empty) / n);
    printf("  thought       %6.1f bytes a polygon\n", (double)orl_scene_bytes(scene) / n);
    orl_scene_release(scene);
    orl_thread_pool_stop(pool);
}

/* ---- In jobs --------------------------------------------------------------------------------- */

static void run_job(const struct files *files, const struct orl_run_env *env, const char *which)
{
    struct orl_sensor sensor = {{20, 20, 50}, {0, 0, 1}};
    struct orl_job job;
    struct orl_result result;
    struct orl_error err = {0};
    orl_job_init(&job);
    job.scene_files = (char **)(uintptr_t)files->list;
    job.n_scene_files = files->n;
    job.sensors = &sensor;
    job.n_sensors = 1;
    job.gather_samples = 16;
    job.technique = ORL_TECHNIQUE_BACKWARD;
    job.sky.model = ORL_SKY_BY_CIE;
    job.sky.cie_type = ORL_SKY_OVERCAST;
    job.sky.input = ORL_SKY_DIFFUSE_LX;
    job.sky.first = 10000;
    if (orl_run(&job, env, &result, &err) < 0)
        bench_fail("a job", &err);
    printf("  %-13s load %.2f s, bvh %.2f s, plan %.2f s, all %.2f s\n", which,
           result.timings_s[ORL_STAGE_LOAD], result.timings_s[ORL_STAGE_BVH],
           result.timings_s[ORL_STAGE_PLAN], result.total_s);
    orl_result_done(&result);
}

static void run_some(const struct files *files, const char *const *which, size_t n)
{
    const struct orl_files from = orl_files_from_folder(files->folder);
    struct orl_thread_pool *const pool = orl_thread_pool_start(2);
    struct orl_memory_cache *const memory_cache = orl_memory_cache_new(UINT64_MAX);
    struct orl_folder_store kept;
    const struct orl_map_store store = orl_map_store_in_folder(&kept);
    atomic_bool cancel = false;
    const struct orl_run_env env = {.pool = pool,
                                    .files = &from,
                                    .store = &store,
                                    .memory_cache = memory_cache,
                                    .files_id = "polygons",
                                    .output_folder = files->folder,
                                    .cancel = &cancel,
                                    .now_s = bench_wall_s};
    snprintf(kept.folder, sizeof kept.folder, "%s/kept", files->folder);
    for (size_t i = 0; i < n; i++)
        run_job(files, &env, which[i]);
    orl_memory_cache_free(memory_cache);
    orl_thread_pool_stop(pool);
}

static void run_jobs(const struct files *files)
{
    static const char *const which[] = {"first job", "second job"};
    run_some(files, which, 2);
}

static void run_another(const struct files *files)
{
    static const char *const which[] = {"kept scene"};
    run_some(files, which, 1);
}

/* Runs the work in a child process. */
static void in_child(void (*work)(const struct files *files), const struct files *files)
{
    int status = 0;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        work(files);
        fflush(stdout);
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
        bench_fail("a process", NULL);
}

int main(void)
{
    static const char *const kinds[2] = {"shared", "apart"};
    static struct files files;
    files.polygons = bench_number("ORIEL_POLYGONS", 5000000);
    bench_make_folder(files.folder);
    for (int apart = 0; apart < 2; apart++) {
        if (!bench_lists("ORIEL_POLYGONS_KINDS", kinds[apart]))
            continue;
        write_files(&files, apart != 0);
        printf("%zu polygons, corners %s\n", files.polygons, kinds[apart]);
        in_child(load, &files);
        in_child(run_jobs, &files);
        in_child(run_another, &files);
    }
    bench_remove_folder(files.folder);
    return 0;
}
