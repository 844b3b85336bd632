/* XML of a panel, with a comment on how it was made. */
#include "bsdf/make/make_bsdf.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/version.h>

#include "base/io/out_file.h"

const enum orl_component_kind orl_gonio_component_of[2][2] = {
    {ORL_COMPONENT_REFLECTION_FRONT, ORL_COMPONENT_TRANSMISSION_FRONT},
    {ORL_COMPONENT_REFLECTION_BACK, ORL_COMPONENT_TRANSMISSION_BACK}};

/* ---- The comment ---------------------------------------------------------------------------- */

static void write_sources(const struct orl_gonio_sample *sample, FILE *out)
{
    const struct orl_parsed_scene *d = &sample->lit_scene->scene->parsed_scene;
    fputs("From:", out);
    for (size_t i = 0; i < d->n_files; i++)
        fprintf(out, " %s", d->files[i]);
    fputs("\nSHA-256 of these files, each preceded by its length: ", out);
    for (size_t i = 0; i < sizeof d->digest; i++)
        fprintf(out, "%02x", d->digest[i]);
    putc('\n', out);
}

static void write_settings(const struct orl_bsdf_make_request *r,
                           const struct orl_bsdf_make_result *result, FILE *out)
{
    static const char *const mirrors[] = {"none", "left and right", "up and down", "both"};
    fprintf(out,
            "Cell, repeated infinitely: x %.6g to %.6g, y %.6g to %.6g; z %.6g to %.6g\nSeed %llu, "
            "paths %llu, symmetry %s",
            result->cell[0], result->cell[1], result->cell[2], result->cell[3], result->depth[0],
            result->depth[1], (unsigned long long)r->seed, (unsigned long long)result->paths,
            mirrors[r->symmetry]);
    if (orl_bsdf_basis_is_tree(r->basis))
        fprintf(out, ", cells merged where within %g of their mean, or %g of the light", r->cull,
                r->cull_fraction);
    if (r->accuracy > 0)
        fprintf(out, ", accuracy %g%s", r->accuracy, result->reached ? "" : " (not reached)");
    putc('\n', out);
}

static void write_error_figures(const struct orl_bsdf_make_result *result, FILE *out)
{
    static const char *const sides[2] = {"outside", "inside"};
    for (int front = 0; front < 2; front++) {
        const struct orl_bsdf_share *s = result->diffuse[front];
        fprintf(out,
                "Diffuse light from the %s: transmitted %.5f, standard error %.1e; reflected %.5f, "
                "%.1e\n",
                sides[front], s[1].value, s[1].error, s[0].value, s[0].error);
    }
    fprintf(
        out,
        "Largest relative standard error of values above a hundredth of their part's peak: %.2g\n",
        result->worst);
    if (result->merge_error > 0)
        fprintf(out, "Largest relative rms deviation of merged cells from their mean: %.2g\n",
                result->merge_error);
    fprintf(out, "Light lost inside the panel: %.2g", result->lost);
}

static void write_conversion(const struct orl_gonio_sample *sample,
                             const struct orl_bsdf_make_request *r, FILE *out)
{
    fprintf(out, "Converted by Oriel " ORL_VERSION "\nFrom: %s", sample->source);
    if (orl_bsdf_basis_is_tree(r->basis))
        fprintf(out, "\nCells merged where within %g of their mean, or %g of the light", r->cull,
                r->cull_fraction);
}

static char *write_provenance(const struct orl_gonio_measurement *measurement,
                              const struct orl_bsdf_make_result *result, bool errors)
{
    const struct orl_gonio_sample *sample = measurement->sample;
    const struct orl_bsdf_make_request *request = measurement->request;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    if (errors)
        fputs("This file holds standard errors, not a BSDF. The BSDF they belong to:\n", out);
    if (sample->file) {
        write_conversion(sample, request, out);
    } else {
        fputs("Made from geometry and materials by Oriel " ORL_VERSION "\n", out);
        write_sources(sample, out);
        write_settings(request, result, out);
        write_error_figures(result, out);
    }
    return orl_memstream_close(out, &text) ? text : NULL;
}

/* ---- The file -------------------------------------------------------------------------------- */

int orl_gonio_write(struct orl_document *document, orl_bsdf_write_part *write_part, void *ctx,
                    const struct orl_gonio_measurement *measurement, bool errors,
                    struct orl_bsdf_make_result *result)
{
    const struct orl_bsdf_make_request *request = measurement->request;
    char *comment = write_provenance(measurement, result, errors);
    const struct orl_bsdf_labels labels = {.manufacturer = measurement->sample->file ? "converted"
                                                                                     : "simulated",
                                           .width_m = result->cell[1] - result->cell[0],
                                           .height_m = result->cell[3] - result->cell[2],
                                           .comment = comment,
                                           .write_part = write_part,
                                           .ctx = ctx};
    int code = comment ? 0 : ORL_ERR_NOMEM;
    document->thickness_m = result->depth[1] - result->depth[0];
    snprintf(document->name, sizeof document->name, "%s%s",
             request->name ? request->name : request->files[0], errors ? ", errors" : "");
    if (code == 0)
        code =
            orl_document_write_text(document, &labels, errors ? &result->errors_xml : &result->xml,
                                    errors ? &result->errors_xml_size : &result->xml_size);
    free(comment);
    return code;
}
