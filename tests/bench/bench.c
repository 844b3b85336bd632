#include "bench/bench.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void bench_fail(const char *what, const struct orl_error *err)
{
    char text[1024] = "";
    if (err)
        orl_error_format(err, text, sizeof text);
    fprintf(stderr, "bench: %s%s%s\n", what, err ? ": " : "", text);
    exit(1);
}

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double bench_wall_s(void *ctx)
{
    (void)ctx;
    return read_clock(CLOCK_MONOTONIC);
}

double bench_cpu_s(void *ctx)
{
    (void)ctx;
    return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}

double bench_own_s(void *ctx)
{
    unsigned long long ran, queued = 0;
    FILE *in = fopen("/proc/thread-self/schedstat", "r");
    if (in && fscanf(in, "%llu %llu", &ran, &queued) != 2)
        queued = 0;
    if (in)
        fclose(in);
    return bench_wall_s(ctx) - 1e-9 * (double)queued;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, compare_doubles);
    return values[n / 2];
}

/* The standard error of a median is 1.25 times that of a mean; the median deviation is 1 / 1.4826
 * of a standard deviation. */
double bench_median_error(double *values, int n, double *ret_error)
{
    const double median = bench_median(values, n);
    for (int i = 0; i < n; i++)
        values[i] = fabs(values[i] - median);
    *ret_error = 1.25 * 1.4826 * bench_median(values, n) / sqrt(n);
    return median;
}

uint64_t bench_number(const char *variable, uint64_t otherwise)
{
    const char *text = getenv(variable);
    return text && *text ? strtoull(text, NULL, 10) : otherwise;
}

bool bench_lists(const char *variable, const char *word)
{
    const char *text = getenv(variable);
    const size_t length = strlen(word);
    if (!text || !*text)
        return true;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
        if ((at == text || strchr(" ,", at[-1])) && (!at[length] || strchr(" ,", at[length])))
            return true;
    return false;
}

struct bench_list bench_numbers(const char *variable, const struct bench_list *otherwise)
{
    const char *text = getenv(variable);
    struct bench_list list = {.n = 0};
    char *end;
    if (!text || !*text)
        return *otherwise;
    while (list.n < BENCH_MOST_NUMBERS) {
        const double value = strtod(text, &end);
        if (end == text)
            break;
        list.values[list.n++] = value;
        text = *end ? end + 1 : end;
    }
    if (list.n == 0 || *text)
        bench_fail("a list of numbers cannot be read, or is too long", NULL);
    return list;
}

const char *bench_build(void)
{
    const char *build = getenv("ORIEL_BUILD");
    return build ? build : "build";
}

void bench_kept(const char *name, char ret_path[BENCH_PATH])
{
    snprintf(ret_path, BENCH_PATH, "%s/bench", bench_build());
    mkdir(ret_path, 0777);
    snprintf(ret_path, BENCH_PATH, "%s/bench/%s", bench_build(), name);
}

void bench_make_folder(char ret_folder[BENCH_PATH])
{
    snprintf(ret_folder, BENCH_PATH, "/tmp/oriel-bench-XXXXXX");
    if (!mkdtemp(ret_folder))
        bench_fail("no temporary folder", NULL);
}

void bench_remove_folder(const char *folder)
{
    const char *const argv[] = {"rm", "-rf", folder, NULL};
    bench_spawn(argv, NULL, NULL, NULL, NULL);
}

/* Runs in the child: replaces a standard stream by a file. */
static void redirect(const char *path, int flags, int stream)
{
    const int file = open(path, flags, 0644);
    if (file < 0 || dup2(file, stream) < 0)
        _exit(126);
    close(file);
}

int bench_spawn(const char *const *argv, const char *folder, const char *input, const char *output,
                struct bench_use *ret_use)
{
    int status = -1;
    struct rusage use;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        if (folder && chdir(folder) < 0)
            _exit(126);
        redirect(input ? input : "/dev/null", O_RDONLY, STDIN_FILENO);
        if (output)
            redirect(output, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
        execvp(argv[0], (char *const *)(uintptr_t)argv);
        _exit(127);
    }
    if (child < 0 || wait4(child, &status, 0, &use) < 0)
        bench_fail("cannot start a program", NULL);
    if (ret_use)
        *ret_use = (struct bench_use){
            .cpu_s = (double)use.ru_utime.tv_sec + 1e-6 * (double)use.ru_utime.tv_usec +
                     (double)use.ru_stime.tv_sec + 1e-6 * (double)use.ru_stime.tv_usec,
            .peak_bytes = 1024.0 * (double)use.ru_maxrss};
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

double bench_peak_bytes(void)
{
    FILE *in = fopen("/proc/self/status", "r");
    char line[128];
    double kib = NAN;
    while (in && isnan(kib) && fgets(line, sizeof line, in))
        if (sscanf(line, "VmHWM: %lf", &kib) != 1)
            kib = NAN;
    if (in)
        fclose(in);
    return 1024 * kib;
}

void bench_run(const struct bench_env *env, const struct orl_job *job,
               struct orl_result *ret_result)
{
    struct orl_folder_store folder;
    struct orl_error err = {0};
    atomic_bool cancel = false;
    snprintf(folder.folder, sizeof folder.folder, "%s", env->maps);
    const struct orl_map_store store = orl_map_store_in_folder(&folder);
    const struct orl_run_env run = {.pool = env->pool,
                                    .files = env->files,
                                    .store = &store,
                                    .memory_cache = env->memory_cache,
                                    .output_folder = env->output,
                                    .cancel = &cancel,
                                    .now_s = env->now_s,
                                    .view_ready = env->view_ready,
                                    .ctx = env->ctx};
    if (orl_run(job, &run, ret_result, &err) < 0)
        bench_fail("a job", &err);
}
