/* Requests of fits: defaults, checks, clean-up; the comment in the XML on how the data were
 * made. */
#include <stdlib.h>
#include <string.h>

#include <oriel/base/version.h>
#include <oriel/bsdf/bsdf_fit.h>

#include "base/io/out_file.h"
#include "base/memory/memory.h"
#include "bsdf/fit/fit.h"
#include "bsdf/make/make_bsdf.h"
#include "bsdf/xml/bsdf_xml.h"

const char *orl_bsdf_fit_symmetry_name(enum orl_bsdf_fit_symmetry symmetry)
{
    static const char *const names[ORL_BSDF_FIT_SYMMETRIES] = {
        "auto", "isotropic", "quadrilateral", "left_right", "up_down", "half_turn", "none"};
    return (size_t)symmetry < ORL_BSDF_FIT_SYMMETRIES ? names[symmetry] : NULL;
}

void orl_bsdf_fit_request_init(struct orl_bsdf_fit_request *request)
{
    memset(request, 0, sizeof *request);
    request->resolution = 64;
    request->cull = 0.02;
}

void orl_bsdf_fit_request_done(struct orl_bsdf_fit_request *request)
{
    if (!request)
        return;
    orl_texts_free(request->files, request->n_files);
    free(request->name);
    memset(request, 0, sizeof *request);
}

int orl_bsdf_fit_validate(const struct orl_bsdf_fit_request *r, struct orl_error *err)
{
    if (r->has_basis && !orl_bsdf_basis_name(r->basis))
        return orl_gonio_refuse(err, ORL_ERR_INVALID, "basis", "the basis is unknown");
    if (!orl_bsdf_fit_symmetry_name(r->symmetry))
        return orl_gonio_refuse(err, ORL_ERR_INVALID, "symmetry", "the symmetry is unknown");
    const int code = orl_gonio_check_tree(r->resolution, r->cull, err);
    if (code < 0)
        return code;
    if (!(r->grazing_deg >= 0 && r->grazing_deg <= 45))
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "grazing",
                                "the grazing angle must be from 0 to 45 degrees");
    if (r->has_basis && r->basis == ORL_BSDF_TENSOR_TREE_3 && r->symmetry != ORL_BSDF_FIT_AUTO &&
        r->symmetry != ORL_BSDF_FIT_ISOTROPIC)
        return orl_gonio_refuse(err, ORL_ERR_UNSUPPORTED, "basis",
                                "a tensor tree of rank 3 needs an isotropic sample");
    return 0;
}

/* ---- Comment in the XML ---------------------------------------------------------------------- */

static void say_scans(const struct orl_bsdf_fit_result *f, FILE *out)
{
    static const char *const sides[2] = {"outside", "inside"};
    for (int i = 0; i < 4; i++) {
        const int front = i / 2, t = i % 2;
        size_t scans = 0;
        for (size_t k = 0; k < f->n_scans; k++)
            scans += f->scans[k].front == front && f->scans[k].transmitted == t;
        if (!f->has[front][t])
            continue;
        fprintf(out, "Diffuse light from the %s, %s: %.5f", sides[front],
                t ? "transmitted" : "reflected", f->diffuse[front][t].value);
        if (f->misplaced[front][t] >= 0)
            fprintf(out, ", leave-one-out error %.1e; share misplaced by it %.2g",
                    f->diffuse[front][t].error, f->misplaced[front][t]);
        fprintf(out, "\n  %zu incident directions up to %.4g degrees; extrapolated beyond\n", scans,
                f->theta_most_deg[front][t]);
    }
}

static char *say_all(const struct orl_bsdf_fit_request *request,
                     const struct orl_bsdf_fit_result *f)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fputs("Fitted to measurements by Oriel " ORL_VERSION
          ": radial functions on each scan, mass transport between scans\nFrom:",
          out);
    for (size_t i = 0; i < request->n_files; i++)
        fprintf(out, " %s", request->files[i]);
    fprintf(out, "\n%zu rows, %zu left out as outliers; symmetry %s\n", f->rows, f->n_outliers,
            orl_bsdf_fit_symmetry_name(f->symmetry));
    if (orl_bsdf_basis_is_tree(f->basis))
        fprintf(out, "Cells merged where within %g of their mean\n", request->cull);
    say_scans(f, out);
    return orl_memstream_close(out, &text) ? text : NULL;
}

int orl_fit_write_xml(struct orl_document *document, const struct orl_bsdf_labels *data,
                      const struct orl_bsdf_fit_request *request,
                      struct orl_bsdf_fit_result *result, struct orl_error *err)
{
    struct orl_bsdf_labels labels = *data;
    char *comment = say_all(request, result);
    labels.manufacturer = "measured";
    labels.comment = comment;
    snprintf(document->name, sizeof document->name, "%s",
             request->name       ? request->name
             : result->sample[0] ? result->sample
                                 : request->files[0]);
    const int code =
        comment ? orl_document_write_text(document, &labels, &result->xml, &result->xml_size)
                : ORL_ERR_NOMEM;
    free(comment);
    return code == 0 ? 0 : orl_error_set(err, code, "out of memory for the BSDF's text");
}
