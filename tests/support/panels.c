#include "support/panels.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static char name[] = "panel.rad";

static struct orl_bsdf_make_request request_of(const struct panel *panel, char **files)
{
    struct orl_bsdf_make_request r;
    orl_bsdf_make_request_init(&r);
    r.files = files;
    r.n_files = 1;
    r.basis = panel->basis;
    r.symmetry = panel->symmetry;
    r.color = panel->color;
    r.has_cell = panel->cell != NULL;
    for (int i = 0; r.has_cell && i < 4; i++)
        r.cell[i] = panel->cell[i];
    r.paths = panel->paths ? panel->paths : 4096;
    r.resolution = panel->resolution ? panel->resolution : 16;
    r.cull = panel->cull > 0 ? panel->cull : r.cull;
    r.accuracy = panel->accuracy;
    r.paths_most = panel->paths_most ? panel->paths_most : r.paths_most;
    r.want_errors = panel->want_errors;
    r.seed = panel->seed ? panel->seed : 1;
    return r;
}

int panel_try(const struct panel *panel, const atomic_bool *cancel,
              struct orl_bsdf_make_result *ret_made, struct orl_error *ret_err)
{
    char *files[] = {name};
    const char *const names[] = {name};
    const struct orl_file content = {.data = panel->text, .size = strlen(panel->text)};
    struct orl_memory_files memory = {names, &content, 1};
    const struct orl_files provider = orl_files_from_memory(&memory);
    const struct orl_bsdf_make_request request = request_of(panel, files);
    const struct orl_bsdf_make_env env = {
        .files = &provider,
        .pool = orl_thread_pool_start(panel->threads ? panel->threads : 1),
        .cancel = cancel};
    assert_non_null(env.pool);
    const int code = orl_bsdf_make(&request, &env, ret_made, ret_err);
    orl_thread_pool_stop(env.pool);
    return code;
}

struct orl_bsdf_make_result panel_make(const struct panel *panel)
{
    struct orl_bsdf_make_result made = {0};
    struct orl_error err = {0};
    if (panel_try(panel, NULL, &made, &err) < 0)
        fail_msg("%s", err.message);
    return made;
}

struct orl_bsdf *panel_read(const struct orl_bsdf_make_result *made)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    if (orl_bsdf_load_xml("made.xml", made->xml, made->xml_size, &bsdf, &err) < 0)
        fail_msg("line %d: %s", err.line, err.message);
    return bsdf;
}

double fresnel(double cosine, double n)
{
    const double inside = sqrt(1 - (1 - cosine * cosine) / (n * n));
    const double s = (cosine - n * inside) / (cosine + n * inside);
    const double p = (n * cosine - inside) / (n * cosine + inside);
    return 0.5 * (s * s + p * p);
}

void slab_shares(double cosine, double n, double pass, double *ret_reflected,
                 double *ret_transmitted)
{
    const double r = fresnel(cosine, n), rest = 1 - r * r * pass * pass;
    *ret_transmitted = (1 - r) * (1 - r) * pass / rest;
    *ret_reflected = r + (1 - r) * (1 - r) * r * pass * pass / rest;
}
