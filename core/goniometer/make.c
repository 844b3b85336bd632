/* The way from a request to a BSDF: rounds of paths, until errors are as asked for. */
#include <stdlib.h>
#include <string.h>

#include "goniometer/made.h"

enum { AT_ONCE = 32 }; /* items between two words of progress */

struct round {
    const struct orl_bsdf_make_request *request;
    const struct orl_bsdf_make_env *env;
    const struct orl_gonio_sample *sample;
    struct orl_gonio_sheet *sheet;
    const struct orl_sobol *sobol;
    uint32_t *wanted; /* paths in each batch, by item; 0: enough there are */
    uint32_t number;
    size_t first;
};

static void measure_item(void *arg, size_t index, uint32_t member)
{
    const struct round *r = arg;
    const size_t item = r->first + index;
    (void)member;
    if (r->wanted[item] > r->sheet->paths[item])
        orl_gonio_sheet_measure(r->sheet, r->sample, r->sobol, r->request->seed, item,
                                r->wanted[item]);
}

static int measure(struct round *r)
{
    const size_t items = r->sheet->items;
    for (r->first = 0; r->first < items; r->first += AT_ONCE) {
        const size_t count = items - r->first < AT_ONCE ? items - r->first : AT_ONCE;
        const int code = orl_crew_try(r->env->crew, count, measure_item, r);
        if (code < 0 || orl_is_cancelled(r->env->cancel))
            return ORL_ERR_CANCELLED;
        if (r->env->progress)
            r->env->progress(r->env->ctx, r->number, (double)(r->first + count) / (double)items);
    }
    return 0;
}

/* All of them that mirrors make of one have as many paths. */
static void want_mirrored(struct round *r, size_t item, uint32_t paths)
{
    const size_t cells = (size_t)r->sheet->basis.n_cells;
    for (unsigned m = 0; m <= ORL_BSDF_QUADRILATERAL; m++)
        if ((m & r->request->symmetry) == m)
            r->wanted[item - item % cells +
                      (size_t)orl_gonio_mirrored(&r->sheet->basis, (int)(item % cells),
                                                 (enum orl_bsdf_symmetry)m)] = paths;
}

/* Doubles the paths of items that need it. Whether there are any that may have more. */
static bool want_more(struct round *r)
{
    const size_t cells = (size_t)r->sheet->basis.n_cells;
    const uint32_t most = r->request->paths_most / ORL_GONIO_BATCHES;
    bool any = false;
    for (size_t item = 0; item < r->sheet->items; item++)
        r->wanted[item] = 0;
    for (size_t front = 0; front < 2; front++) {
        double peaks[2];
        orl_gonio_peaks(r->sheet, front, peaks);
        for (size_t item = front * cells; item < (front + 1) * cells; item++) {
            const uint32_t paths = 2 * r->sheet->paths[item];
            if (paths > most || orl_gonio_worst(r->sheet, item, peaks) <= r->request->accuracy)
                continue;
            want_mirrored(r, item, paths);
            any = true;
        }
    }
    return any;
}

static int measure_all(struct round *r, struct orl_error *err)
{
    const uint32_t first = (r->request->paths + ORL_GONIO_BATCHES - 1) / ORL_GONIO_BATCHES;
    int code;
    for (size_t item = 0; item < r->sheet->items; item++)
        r->wanted[item] = first;
    do {
        code = measure(r);
        r->number++;
    } while (code == 0 && r->request->accuracy > 0 && want_more(r));
    return code < 0 ? orl_error_set(err, code, "cancelled") : 0;
}

static const char *klems_name(enum orl_bsdf_basis basis)
{
    static const char *const names[ORL_BSDF_BASES] = {"LBNL/Klems Full", "LBNL/Klems Half",
                                                      "LBNL/Klems Quarter"};
    return names[basis];
}

static int make_of(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                   const struct orl_gonio_sample *sample, struct orl_gonio_sheet *sheet,
                   struct orl_bsdf_made *made, struct orl_error *err)
{
    struct orl_sobol *sobol = malloc(sizeof *sobol);
    uint32_t *wanted = malloc(sheet->items * sizeof *wanted);
    struct round round = {request, env, sample, sheet, sobol, wanted, 1, 0};
    int code = sobol && wanted ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (code == 0) {
        orl_sobol_init(sobol);
        orl_crew_heed(env->crew, env->cancel);
        code = measure_all(&round, err);
        orl_crew_heed(env->crew, NULL);
    }
    if (code == 0)
        code = orl_gonio_tell(sheet, sample, made, err);
    if (code == 0) {
        made->reached = !(request->accuracy > 0) || made->worst <= request->accuracy;
        code = orl_gonio_write(sheet, sample, request, made, err);
    }
    free(sobol);
    free(wanted);
    return code;
}

int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_made *ret_made, struct orl_error *err)
{
    struct orl_gonio_sample sample;
    struct orl_gonio_sheet sheet = {0};
    struct orl_bsdf_made made = {0};
    int code = orl_bsdf_make_validate(request, err);
    if (code == 0)
        code = orl_gonio_sample_load(request, env, &sample, err);
    if (code < 0)
        return code;
    code = orl_gonio_sheet_init(&sheet, klems_name(request->basis), request->color,
                                request->symmetry, err);
    if (code == 0)
        code = make_of(request, env, &sample, &sheet, &made, err);
    orl_gonio_sheet_done(&sheet);
    orl_gonio_sample_done(&sample);
    if (code == 0)
        *ret_made = made;
    else
        orl_bsdf_made_done(&made);
    return code;
}
