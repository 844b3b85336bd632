#include "handlers/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <oriel/base/version.h>

#include "http/connection/connections.h"
#include "http/context.h"
#include "http/response/reply.h"
#include "maintenance/scrub.h"
#include "process/times.h"
#include "server.h"

static void write_head(FILE *out, const char *name, const char *type, const char *help)
{
    fprintf(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

static void write_number(FILE *out, const char *name, const char *type, const char *help,
                         double value)
{
    write_head(out, name, type, help);
    fprintf(out, "%s %.17g\n", name, value);
}

/* Writes a histogram. labels: 'route="/",class="2xx"' */
static void write_histogram(FILE *out, const char *name, const char *labels,
                            const struct orl_histogram *histogram,
                            const double bounds[ORL_METRICS_BUCKETS])
{
    uint64_t count = 0;
    for (size_t i = 0; i < ORL_METRICS_BUCKETS; i++) {
        count += histogram->buckets[i];
        fprintf(out, "%s_bucket{%s,le=\"%g\"} %llu\n", name, labels, bounds[i],
                (unsigned long long)count);
    }
    count += histogram->buckets[ORL_METRICS_BUCKETS];
    fprintf(out, "%s_bucket{%s,le=\"+Inf\"} %llu\n%s_sum{%s} %.17g\n%s_count{%s} %llu\n", name,
            labels, (unsigned long long)count, name, labels, histogram->sum, name, labels,
            (unsigned long long)count);
}

static bool is_empty(const struct orl_histogram *histogram)
{
    uint64_t count = 0;
    for (size_t i = 0; i <= ORL_METRICS_BUCKETS; i++)
        count += histogram->buckets[i];
    return count == 0;
}

static void write_jobs(FILE *out, const struct orl_server *server)
{
    const struct orl_metrics *metrics = &server->metrics;
    write_number(out, "oriel_queue_depth", "gauge", "Queued jobs",
                 (double)orl_jobs_count(server->jobs, ORL_JOB_QUEUED));
    write_head(out, "oriel_jobs", "gauge", "Stored jobs, by state");
    for (int i = 0; i < ORL_JOB_STATE_COUNT; i++)
        fprintf(out, "oriel_jobs{state=\"%s\"} %zu\n", orl_job_state_name((enum orl_job_state)i),
                orl_jobs_count(server->jobs, (enum orl_job_state)i));
    write_head(out, "oriel_job_runs_total", "counter",
               "Runs of jobs, by the state of the job at the end of the run");
    for (int i = 0; i < ORL_JOB_STATE_COUNT; i++)
        if (i != ORL_JOB_RUNNING)
            fprintf(out, "oriel_job_runs_total{state=\"%s\"} %llu\n",
                    orl_job_state_name((enum orl_job_state)i),
                    (unsigned long long)metrics->ended[i]);
    write_head(out, "oriel_stage_seconds", "histogram",
               "Seconds of successful render jobs, by stage");
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        char label[40];
        snprintf(label, sizeof label, "stage=\"%s\"", orl_stage_name((enum orl_stage)i));
        write_histogram(out, "oriel_stage_seconds", label, &metrics->stages[i],
                        orl_metrics_stage_s);
    }
    write_number(out, "oriel_photons_total", "counter",
                 "Photons traced, including those of failed and cancelled jobs",
                 (double)metrics->health.photons);
    write_number(
        out, "oriel_rays_total", "counter",
        "Rays traced (segments of photons and paths), including those of failed and cancelled jobs",
        (double)metrics->health.rays);
}

static void add_parts(void *ctx, const struct orl_jobs_job *job)
{
    struct orl_job_progress progress;
    if (!job->worker)
        return; /* it shares another job's computation */
    orl_worker_progress(job->worker, &progress);
    orl_metrics_parts(ctx, &progress.parts);
}

static void write_parts(FILE *out, const struct orl_server *server)
{
    struct orl_parts_count parts = server->metrics.parts;
    orl_jobs_running(server->jobs, add_parts, &parts);
    write_head(out, "oriel_parts", "gauge", "Parts of running jobs, by state");
    fprintf(out, "oriel_parts{state=\"waiting\"} %llu\noriel_parts{state=\"running\"} %llu\n",
            (unsigned long long)parts.waiting, (unsigned long long)parts.running);
    write_number(out, "oriel_parts_done_total", "counter", "Completed parts", (double)parts.done);
    write_number(out, "oriel_parts_again_total", "counter",
                 "Restarts of parts that were requeued, lost or failed", (double)parts.again);
    write_number(out, "oriel_parts_lost_seconds_total", "counter",
                 "Run time of requeued, lost or failed parts, in seconds", parts.lost_s);
}

static void write_health(FILE *out, const struct orl_health *health)
{
    const struct {
        const char *what;
        uint64_t count;
    } counts[] = {
        {"non_finite", health->non_finite},         {"bsdf_clamped", health->bsdf_clamped},
        {"bsdf_rescaled", health->bsdf_rescaled},   {"degenerate", health->degenerate},
        {"photons_capped", health->photons_capped}, {"paths_capped", health->paths_capped},
        {"rays_leaked", health->rays_leaked},       {"sparse", health->sparse},
    };
    write_head(out, "oriel_health_total", "counter",
               "Numerical problems by kind, as in result.json");
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        fprintf(out, "oriel_health_total{what=\"%s\"} %llu\n", counts[i].what,
                (unsigned long long)counts[i].count);
}

static void write_cache(FILE *out, struct orl_server *server)
{
    struct orl_map_cache_totals totals;
    orl_map_cache_totals(server->maps, &totals);
    write_number(out, "oriel_cache_entries", "gauge", "Photon maps and loaded BSDFs in the cache",
                 (double)totals.entries);
    write_number(out, "oriel_cache_bytes", "gauge", "Bytes of these maps and BSDFs",
                 (double)totals.bytes);
    write_number(out, "oriel_cache_hits_total", "counter",
                 "Look-ups that found a map or BSDF in the cache", (double)totals.hits);
    write_number(out, "oriel_cache_misses_total", "counter",
                 "Look-ups that did not find a map or BSDF in the cache", (double)totals.misses);
}

static void write_memory_cache(FILE *out, struct orl_server *server)
{
    const struct orl_memory_cache_totals totals = orl_memory_cache_totals(server->memory_cache);
    write_number(out, "oriel_shelf_bytes", "gauge",
                 "Memory of the data that jobs leave for later jobs (--shelf), in bytes",
                 (double)totals.bytes);
    write_number(out, "oriel_shelf_items", "gauge", "Items that jobs left for later jobs",
                 (double)totals.things);
    write_number(out, "oriel_shelf_hits_total", "counter", "Items that later jobs reused",
                 (double)totals.hits);
    write_number(out, "oriel_shelf_scenes", "gauge", "Scenes among these items, which jobs share",
                 (double)totals.shared);
    write_number(out, "oriel_shelf_scene_hits_total", "counter", "Jobs that reused a scene",
                 (double)totals.shared_hits);
}

static void write_storage(FILE *out, const struct orl_server *server)
{
    uint64_t bytes[ORL_STORED_COUNT];
    orl_storage_usage(&server->storage, bytes);
    write_number(out, "oriel_storage_budget_bytes", "gauge", "Storage budget, in bytes",
                 (double)server->storage.budget);
    write_head(out, "oriel_storage_bytes", "gauge", "Stored bytes, by kind");
    for (int i = 0; i < ORL_STORED_COUNT; i++)
        fprintf(out, "oriel_storage_bytes{kind=\"%s\"} %llu\n", orl_stored_names[i],
                (unsigned long long)bytes[i]);
    write_head(out, "oriel_evictions_total", "counter", "Items removed to make room, by kind");
    for (int i = 0; i < ORL_STORED_UPLOADS; i++)
        fprintf(out, "oriel_evictions_total{kind=\"%s\"} %llu\n", orl_stored_names[i],
                (unsigned long long)server->storage.evicted[i]);
}

static void write_memory(FILE *out, const struct orl_memory *memory)
{
    write_number(out, "oriel_memory_capacity_bytes", "gauge",
                 "Memory limit of jobs and checks, in bytes", (double)memory->capacity);
    write_number(out, "oriel_memory_free_bytes", "gauge",
                 "Memory that is neither used nor reserved, in bytes",
                 (double)orl_memory_available(memory));
    write_number(out, "oriel_memory_jobs_bytes", "gauge",
                 "Estimated memory of running jobs, in bytes", (double)memory->jobs);
    write_number(out, "oriel_memory_checks_bytes", "gauge",
                 "Memory reserved for checks of uploads, in bytes", (double)memory->checks);
}

static void write_scrub(FILE *out, const struct orl_server *server)
{
    const struct orl_scrub_totals totals = orl_scrub_thread_totals(server->scrub_thread);
    write_number(out, "oriel_scrub_files_total", "counter", "Files compared with their digests",
                 (double)totals.files);
    write_number(out, "oriel_scrub_bytes_total", "counter", "Bytes compared with their digests",
                 (double)totals.bytes);
    write_number(out, "oriel_scrub_damaged_total", "counter", "Files found damaged or missing",
                 (double)totals.damaged);
}

static void write_http(FILE *out, const struct orl_server *server)
{
    static const char name[] = "oriel_http_request_seconds";
    const struct orl_connections *connections = orl_http_connections(server->http);
    const struct orl_routes *routes = server->context.routes;
    write_number(out, "oriel_http_connections", "gauge", "Open connections",
                 (double)connections->open);
    write_number(
        out, "oriel_event_streams", "gauge", "Open event streams",
        (double)(orl_events_count(server->events) + orl_event_broker_count(server->broker)));
    write_number(out, "oriel_http_slow_clients_total", "counter",
                 "Connections closed because the client was too slow", (double)connections->cut);
    write_head(out, name, "histogram",
               "Seconds from the headers to the end of the reply, by route and status class (0xx: "
               "aborted)");
    for (size_t route = 0; route <= routes->count; route++)
        for (size_t hundreds = 0; hundreds < ORL_METRICS_CLASSES; hundreds++) {
            const struct orl_histogram *one = &server->metrics.http[route][hundreds];
            const struct orl_route *known = route < routes->count ? &routes->table[route] : NULL;
            char labels[160];
            if (is_empty(one))
                continue;
            snprintf(labels, sizeof labels, "method=\"%s\",route=\"%s\",class=\"%zuxx\"",
                     known ? known->method : "", known ? known->path : "", hundreds);
            write_histogram(out, name, labels, one, orl_metrics_http_s);
        }
}

static void write_watchdog(FILE *out, const struct orl_server *server)
{
    static const char name[] = "oriel_loop_turn_seconds";
    const struct orl_loop_watchdog *watchdog = &server->watchdog;
    write_head(out, name, "histogram",
               "Seconds of each iteration of the event loop; requests wait meanwhile");
    write_histogram(out, name, "thread=\"loop\"", &watchdog->turns, orl_metrics_http_s);
    write_number(out, "oriel_loop_longest_turn_seconds", "gauge",
                 "Seconds of the longest iteration so far", watchdog->longest_s);
    write_number(out, "oriel_pool_requests", "gauge",
                 "Requests that run on the thread pool or wait for it",
                 (double)server->context.working);
    write_number(out, "oriel_pool_wait_seconds", "gauge",
                 "Seconds until the thread pool starts a work item, measured every second",
                 orl_loop_watchdog_pool_s(watchdog));
}

static double resident_bytes(void)
{
    char text[128] = "";
    FILE *statm = fopen("/proc/self/statm", "re");
    if (!statm)
        return 0;
    const char *line = fgets(text, sizeof text, statm);
    fclose(statm);
    const char *second = line ? strchr(line, ' ') : NULL; /* resident pages follow the total */
    return second ? (double)strtol(second, NULL, 10) * (double)sysconf(_SC_PAGESIZE) : 0;
}

static void write_process(FILE *out, const struct orl_server *server)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    write_head(out, "oriel_build_info", "gauge", "Always 1; the label is the version");
    fprintf(out, "oriel_build_info{version=\"%s\"} 1\n", ORL_VERSION);
    write_number(out, "process_start_time_seconds", "gauge",
                 "Start of the process, in seconds since 1970",
                 (double)orl_time_now_ms() / 1000 - (orl_time_steady_s() - server->started_s));
    write_number(out, "process_cpu_seconds_total", "counter",
                 "Processor time, user and system, in seconds",
                 (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                     1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec));
    write_number(out, "process_resident_memory_bytes", "gauge", "Resident memory, in bytes",
                 resident_bytes());
}

void orl_handle_metrics(struct orl_request *request)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out) {
        write_jobs(out, request->server);
        write_parts(out, request->server);
        write_health(out, &request->server->metrics.health);
        write_cache(out, request->server);
        write_memory_cache(out, request->server);
        write_storage(out, request->server);
        write_memory(out, &request->server->memory);
        write_scrub(out, request->server);
        write_http(out, request->server);
        write_watchdog(out, request->server);
        write_process(out, request->server);
        if (fclose(out) != 0) {
            free(text);
            text = NULL;
        }
    }
    orl_reply_owned_text(request, 200, "text/plain; version=0.0.4; charset=utf-8", text);
    orl_reply_header(request, "Cache-Control", "no-store");
}
