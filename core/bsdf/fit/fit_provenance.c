/* Comment in the XML on how the data were made. */
#include <oriel/base/version.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/fit/fit_output.h"
#include "bsdf/xml/write_xml.h"

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
            fprintf(out, ", error by leaving directions out %.1e; misplaced by that %.2g of it",
                    f->diffuse[front][t].error, f->misplaced[front][t]);
        fprintf(out, "\n  %zu incident directions to %.4g degrees; beyond it is extrapolated\n",
                scans, f->theta_most_deg[front][t]);
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
          ": radial functions on each scan, transport of mass between\nFrom:",
          out);
    for (size_t i = 0; i < request->n_files; i++)
        fprintf(out, " %s", request->files[i]);
    fprintf(out, "\n%zu rows, %zu left out as outliers; symmetry %s\n", f->rows, f->n_outliers,
            orl_bsdf_fit_symmetry_name(f->symmetry));
    if (orl_bsdf_basis_is_tree(f->basis))
        fprintf(out, "Cells as one where within %g of their mean\n", request->cull);
    say_scans(f, out);
    const bool failed = ferror(out);
    if (fclose(out) == 0 && !failed)
        return text;
    free(text);
    return NULL;
}

int orl_fit_write_xml(struct orl_document *document, const struct orl_bsdf_labels *data,
                      const struct orl_bsdf_fit_request *request,
                      struct orl_bsdf_fit_result *result, struct orl_error *err)
{
    struct orl_bsdf_labels labels = *data;
    char *comment = say_all(request, result);
    FILE *out = comment ? open_memstream(&result->xml, &result->xml_size) : NULL;
    bool fine = out != NULL;
    labels.manufacturer = "measured";
    labels.comment = comment;
    snprintf(document->name, sizeof document->name, "%s",
             request->name       ? request->name
             : result->sample[0] ? result->sample
                                 : request->files[0]);
    if (out) {
        orl_document_write(document, &labels, out);
        fine = !ferror(out);
        fine = fclose(out) == 0 && fine;
    }
    free(comment);
    return fine ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF's text");
}
