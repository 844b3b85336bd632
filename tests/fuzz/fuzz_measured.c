/*
 * Goniophotometer measurements. Accepted input is fitted in the smallest basis; most of it has too
 * few samples to be fitted.
 */
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/fit/measurements/measurements.h"
#include "fuzz/fuzz.h"

static void check_rows(const struct orl_fit_data *data)
{
    size_t rows = 0;
    for (size_t i = 0; i < data->n_scans; i++) {
        const struct orl_fit_scan *scan = &data->scans[i];
        FUZZ_PROMISE(scan->theta_deg >= 0 && scan->theta_deg < 90 && scan->n_rows > 0);
        FUZZ_PROMISE(fabs(orl_length(scan->in) - 1) < 1e-6 && scan->in.z >= 0);
        for (size_t k = 0; k < scan->n_rows; k++) {
            const struct orl_fit_row *row = &scan->rows[k];
            const struct orl_vec3 d = orl_v3((double)row->x, (double)row->y, (double)row->z);
            FUZZ_PROMISE(fabs(orl_length(d) - 1) < 1e-5 && row->z >= 0 && row->line > 0);
            FUZZ_PROMISE(isfinite(row->value));
        }
        rows += scan->n_rows;
    }
    FUZZ_PROMISE(rows <= data->n_rows);
}

static void fit(const uint8_t *bytes, size_t size)
{
    char name[] = "data.txt", *files[] = {name};
    const char *const names[] = {name};
    const struct orl_file content = {.data = (const char *)bytes, .size = size};
    struct orl_memory_files memory = {names, &content, 1};
    const struct orl_files provider = orl_files_from_memory(&memory);
    struct orl_thread_pool *pool = orl_thread_pool_new(1);
    const struct orl_bsdf_make_env env = {.files = &provider, .pool = pool};
    struct orl_bsdf_fit_request request;
    struct orl_bsdf_fit_result fitted;
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    FUZZ_PROMISE(pool != NULL);
    orl_bsdf_fit_request_init(&request);
    request.files = files;
    request.n_files = 1;
    request.resolution = 4;
    const int code = orl_bsdf_fit(&request, &env, &fitted, &err);
    orl_thread_pool_free(pool);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return;
    }
    FUZZ_PROMISE(strlen(fitted.xml) == fitted.xml_size);
    FUZZ_PROMISE(orl_bsdf_load_xml("fitted.xml", fitted.xml, fitted.xml_size, &bsdf, &err) == 0);
    for (size_t i = 0; i < fitted.n_scans; i++)
        FUZZ_PROMISE(isfinite(fitted.scans[i].total) && fitted.scans[i].total >= 0);
    orl_bsdf_unref(bsdf);
    orl_bsdf_fit_result_done(&fitted);
}

bool fuzz_measured(const uint8_t *data, size_t size)
{
    const struct orl_fit_read_options reading = {.grazing_deg = size % 3 ? 0 : 5,
                                                 .reversed = size % 2 != 0};
    struct orl_fit_data rows = {0};
    struct orl_error err = {0};
    const int code = orl_fit_read("data.txt", 0, (const char *)data, size, &reading, &rows, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        check_rows(&rows);
    FUZZ_PROMISE(code < 0 || rows.n_rows == 0 || orl_bsdf_is_measured((const char *)data, size));
    orl_fit_data_done(&rows);
    if (code == 0)
        fit(data, size);
    return code == 0;
}
