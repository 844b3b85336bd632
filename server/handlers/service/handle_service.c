#include "handlers/handlers.h"

#include <jansson.h>

#include <oriel/base/version.h>
#include <oriel/job/picture.h>

#include "http/response/reply.h"
#include "process/embedded_files.h"
#include "process/limits.h"
#include "process/times.h"
#include "server.h"

void orl_handle_index(struct orl_request *request)
{
    if (orl_dashboard_is_wanted(request)) {
        orl_dashboard_reply(request);
        return;
    }
    orl_reply_json(
        request, 200,
        json_pack("{s:s, s:s, s:s, s:s, s:{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:s}}",
                  "service", "oriel", "version", ORL_VERSION, "api", "v1", "contract",
                  "/openapi.yaml", "links", "scenes", "/v1/scenes", "bsdfs", "/v1/bsdfs", "jobs",
                  "/v1/jobs", "maps", "/v1/maps", "limits", "/v1/limits", "health", "/healthz",
                  "session", "/v1/session", "guide", "/guide", "javascript", "/oriel.js"));
    orl_reply_header(request, "Vary", "Accept");
}

/* Liveness: the loop runs. */
void orl_handle_health(struct orl_request *request)
{
    const struct orl_server *server = request->server;
    orl_reply_json(request, 200,
                   json_pack("{s:s, s:s, s:s, s:f}", "status", "ok", "disk",
                             server->disk.full ? "full" : "ok", "version", ORL_VERSION, "uptime_s",
                             orl_time_steady_s() - server->started_s));
    orl_reply_header(request, "Cache-Control", "no-store");
}

/* Readiness: the daemon accepts jobs, the disk has space for them, and the pool, which runs them,
 * responds. Requests to a stopping daemon are refused before any handler (serve.c). */
void orl_handle_ready(struct orl_request *request)
{
    const struct orl_jobs *jobs = request->server->jobs;
    const bool draining = request->server->stop.draining, full = orl_jobs_full(jobs);
    const bool busy = orl_loop_watchdog_pool_s(&request->server->watchdog) > ORL_SERVER_POOL_S;
    const bool disk = request->server->disk.full;
    const char *status = draining ? "stopping"
                         : disk   ? "disk full"
                         : full   ? "queue full"
                         : busy   ? "busy"
                                  : "ready";
    orl_reply_json(request, draining || disk || full || busy ? 503 : 200,
                   json_pack("{s:s, s:I, s:I}", "status", status, "queued",
                             (json_int_t)orl_jobs_count(jobs, ORL_JOB_QUEUED), "running",
                             (json_int_t)orl_jobs_count(jobs, ORL_JOB_RUNNING)));
    orl_reply_header(request, "Cache-Control", "no-store");
    if (draining || disk || full || busy)
        orl_reply_header(request, "Retry-After", "10");
}

void orl_handle_openapi(struct orl_request *request)
{
    const char *text = orl_embedded_file_find("openapi.yaml");
    if (text)
        orl_reply_text(request, "application/yaml", text);
    else
        orl_reply_not_found(request, "contract");
}

void orl_handle_limits(struct orl_request *request)
{
    static const struct {
        const char *name;
        json_int_t value;
    } limits[] = {
        {"file_bytes", ORL_LIMIT_FILE_BYTES},
        {"scene_bytes", ORL_SERVER_SCENE_BYTES},
        {"scene_files", ORL_LIMIT_SCENE_FILES},
        {"zip_entries", ORL_SERVER_ZIP_ENTRIES},
        {"zip_ratio", ORL_SERVER_ZIP_RATIO},
        {"surfaces", ORL_LIMIT_SURFACES},
        {"instances", ORL_LIMIT_INSTANCES},
        {"placed_surfaces", ORL_LIMIT_INSTANCED_SURFACES},
        {"polygon_vertices", ORL_LIMIT_POLYGON_VERTICES},
        {"bsdf_values", ORL_LIMIT_BSDF_VALUES},
        {"bsdf_tree_depth", ORL_LIMIT_TREE_DEPTH},
        {"sensors", ORL_LIMIT_SENSORS},
        {"views", ORL_LIMIT_VIEWS},
        {"skies", ORL_LIMIT_SKIES},
        {"pictures", ORL_LIMIT_PICTURES},
        {"grids", ORL_LIMIT_GRIDS},
        {"matrix_cells", ORL_LIMIT_MATRIX_CELLS},
        {"image_side", ORL_LIMIT_IMAGE_SIDE},
        {"image_pixels", ORL_LIMIT_IMAGE_PIXELS},
        {"picture_points", ORL_LIMIT_PICTURE_POINTS},
        {"scale_divisions", ORL_LIMIT_DIVISIONS},
        {"heat_maps", ORL_HEAT_MAPS},
        {"heat_map_thresholds", ORL_HEAT_MAP_THRESHOLDS},
        {"photons", ORL_LIMIT_PHOTONS},
        {"job_bytes", ORL_LIMIT_JOB_BYTES},
        {"study_runs", ORL_SERVER_STUDY_RUNS},
        {"accuracy_samples", ORL_LIMIT_GOAL_SAMPLES},
        {"deadline_s", ORL_LIMIT_DEADLINE_S},
        {"study_list", ORL_LIMIT_STUDY_LIST},
        {"queued_jobs", ORL_SERVER_QUEUE},
        {"client_jobs", ORL_SERVER_CLIENT_JOBS},
        {"client_streams", ORL_SERVER_CLIENT_STREAMS},
        {"idempotency_key_s", ORL_SERVER_KEY_S},
        {"unfetched_results_s", ORL_SERVER_UNFETCHED_S},
        {"priority", ORL_PRIORITY_MAX},
        {"session_s", ORL_SERVER_SESSION_S},
        {"sessions", ORL_SERVER_SESSIONS},
        {"link_s", ORL_SERVER_LINK_S},
        {"links", ORL_SERVER_LINKS},
        {"connections", ORL_SERVER_CONNECTIONS},
        {"event_streams", ORL_SERVER_STREAMS},
        {"address_connections", ORL_SERVER_ADDRESS_CONNECTIONS},
        {"body_bytes_per_s", (json_int_t)ORL_SERVER_BODY_RATE},
    };
    const json_int_t budget = (json_int_t)request->server->storage.budget;
    const json_int_t memory_cache = (json_int_t)request->server->config.memory_cache_bytes;
    const struct orl_config *config = &request->server->config;
    json_t *doc =
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "storage_bytes", budget, "shelf_bytes",
                  memory_cache, "job_s", (json_int_t)config->job_timeout_s, "kept_jobs",
                  (json_int_t)config->keep_jobs, "kept_days", (json_int_t)config->keep_days,
                  "memory_bytes", (json_int_t)request->server->memory.capacity,
                  "check_memory_bytes", (json_int_t)config->check_memory);
    for (size_t i = 0; doc && i < sizeof limits / sizeof *limits; i++)
        if (json_object_set_new(doc, limits[i].name, json_integer(limits[i].value))) {
            json_decref(doc);
            doc = NULL;
            break;
        }
    orl_reply_json(request, 200, doc);
}
