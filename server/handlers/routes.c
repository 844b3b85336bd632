#include "handlers/handlers.h"

#include "health/metrics.h"
#include "process/limits.h"

static const char *const json_types[] = {"application/json", NULL};
static const char *const scene_types[] = {"multipart/form-data", "application/json",
                                          "application/zip", "application/x-zip-compressed", NULL};

static const struct orl_route table[] = {
    {"GET", "/", ORL_SCOPE_OPEN, orl_handle_index, 0, NULL, false},
    {"GET", "/dashboard/{}/{*}", ORL_SCOPE_OPEN, orl_handle_dashboard_file, 0, NULL, false},
    {"GET", "/oriel.js", ORL_SCOPE_OPEN, orl_handle_javascript, 0, NULL, false},
    {"GET", "/guide", ORL_SCOPE_OPEN, orl_handle_guide, 0, NULL, false},
    {"GET", "/guide/search", ORL_SCOPE_OPEN, orl_handle_guide_search, 0, NULL, false},
    {"GET", "/guide/{}", ORL_SCOPE_OPEN, orl_handle_guide_page, 0, NULL, false},
    {"GET", "/guide/{}/{}", ORL_SCOPE_OPEN, orl_handle_guide_page, 0, NULL, false},
    {"GET", "/healthz", ORL_SCOPE_OPEN, orl_handle_health, 0, NULL, false},
    {"GET", "/readyz", ORL_SCOPE_OPEN, orl_handle_ready, 0, NULL, false},
    {"GET", "/metrics", ORL_SCOPE_READ, orl_handle_metrics, 0, NULL, false},
    {"GET", "/openapi.yaml", ORL_SCOPE_OPEN, orl_handle_openapi, 0, NULL, false},
    {"GET", "/v1/limits", ORL_SCOPE_READ, orl_handle_limits, 0, NULL, false},
    {"POST", "/v1/scenes", ORL_SCOPE_SUBMIT, orl_handle_scene_post, ORL_SERVER_SCENE_BYTES,
     scene_types, false},
    {"GET", "/v1/scenes", ORL_SCOPE_READ, orl_handle_scene_list, 0, NULL, false},
    {"GET", "/v1/scenes/{}", ORL_SCOPE_READ, orl_handle_scene_get, 0, NULL, false},
    {"GET", "/v1/scenes/{}/outline", ORL_SCOPE_READ, orl_handle_scene_outline, 0, NULL, false},
    {"DELETE", "/v1/scenes/{}", ORL_SCOPE_ADMIN, orl_handle_scene_delete, 0, NULL, false},
    {"POST", "/v1/bsdfs", ORL_SCOPE_SUBMIT, orl_handle_bsdf_post, ORL_LIMIT_FILE_BYTES, NULL,
     false},
    {"GET", "/v1/bsdfs", ORL_SCOPE_READ, orl_handle_bsdf_list, 0, NULL, false},
    {"GET", "/v1/bsdfs/{}", ORL_SCOPE_READ, orl_handle_bsdf_get, 0, NULL, false},
    {"GET", "/v1/bsdfs/{}/polar", ORL_SCOPE_READ, orl_handle_bsdf_polar, 0, NULL, false},
    {"DELETE", "/v1/bsdfs/{}", ORL_SCOPE_ADMIN, orl_handle_bsdf_delete, 0, NULL, false},
    {"POST", "/v1/jobs", ORL_SCOPE_SUBMIT, orl_handle_job_post, ORL_LIMIT_JOB_BYTES, json_types,
     false},
    {"GET", "/v1/jobs", ORL_SCOPE_READ, orl_handle_job_list, 0, NULL, false},
    {"GET", "/v1/jobs/{}", ORL_SCOPE_READ, orl_handle_job_get, 0, NULL, false},
    {"DELETE", "/v1/jobs/{}", ORL_SCOPE_SUBMIT, orl_handle_job_delete, 0, NULL, false},
    {"POST", "/v1/jobs/{}/cancel", ORL_SCOPE_SUBMIT, orl_handle_job_cancel, 4096, NULL, false},
    {"GET", "/v1/jobs/{}/document", ORL_SCOPE_READ, orl_handle_job_document, 0, NULL, false},
    {"GET", "/v1/jobs/{}/events", ORL_SCOPE_READ, orl_handle_job_events, 0, NULL, false},
    {"GET", "/v1/jobs/{}/result", ORL_SCOPE_READ, orl_handle_job_result, 0, NULL, false},
    {"GET", "/v1/jobs/{}/files/{*}", ORL_SCOPE_READ, orl_handle_job_file, 0, NULL, true},
    {"POST", "/v1/jobs/{}/links", ORL_SCOPE_READ, orl_handle_job_links, 32768, json_types, false},
    {"POST", "/v1/plans", ORL_SCOPE_SUBMIT, orl_handle_plan_post, ORL_LIMIT_JOB_BYTES, json_types,
     false},
    {"GET", "/v1/events", ORL_SCOPE_READ, orl_handle_all_events, 0, NULL, false},
    {"GET", "/v1/session", ORL_SCOPE_OPEN, orl_handle_session_get, 0, NULL, false},
    {"POST", "/v1/session", ORL_SCOPE_READ, orl_handle_session_post, 0, NULL, false},
    {"DELETE", "/v1/session", ORL_SCOPE_OPEN, orl_handle_session_delete, 0, NULL, false},
    {"GET", "/v1/maps", ORL_SCOPE_READ, orl_handle_map_list, 0, NULL, false},
    {"DELETE", "/v1/maps/{}/{}", ORL_SCOPE_ADMIN, orl_handle_map_delete, 0, NULL, false},
};

_Static_assert(sizeof table / sizeof *table < ORL_METRICS_ROUTES, "a histogram for each route");

const struct orl_routes orl_routes = {table, sizeof table / sizeof *table};
