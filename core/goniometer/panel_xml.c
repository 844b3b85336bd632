#include "goniometer/panel_xml.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/version.h>

const enum orl_bsdf_part orl_gonio_part_of[2][2] = {
    {ORL_PART_REFLECTION_FRONT, ORL_PART_TRANSMISSION_FRONT},
    {ORL_PART_REFLECTION_BACK, ORL_PART_TRANSMISSION_BACK}};

/* ---- The comment ---------------------------------------------------------------------------- */

static void say_sources(const struct orl_gonio_sample *sample, FILE *out)
{
    const struct orl_description *d = &sample->world->scene->description;
    fputs("From:", out);
    for (size_t i = 0; i < d->n_files; i++)
        fprintf(out, " %s", d->files[i]);
    fputs("\nSHA-256 of these, each behind its length: ", out);
    for (size_t i = 0; i < sizeof d->digest; i++)
        fprintf(out, "%02x", d->digest[i]);
    putc('\n', out);
}

static void say_settings(const struct orl_bsdf_make_request *r, const struct orl_bsdf_made *made,
                         FILE *out)
{
    static const char *const mirrors[] = {"none", "left and right", "up and down", "both"};
    fprintf(out,
            "Cell, repeated without end: x %.6g to %.6g, y %.6g to %.6g; z %.6g to %.6g\n"
            "Seed %llu, paths %llu, symmetry %s",
            made->cell[0], made->cell[1], made->cell[2], made->cell[3], made->depth[0],
            made->depth[1], (unsigned long long)r->seed, (unsigned long long)made->paths,
            mirrors[r->symmetry]);
    if (orl_bsdf_basis_is_tree(r->basis))
        fprintf(out, ", cells as one where within %g of their mean, or %g of the light", r->cull,
                r->unseen);
    if (r->accuracy > 0)
        fprintf(out, ", accuracy %g%s", r->accuracy, made->reached ? "" : " (not reached)");
    putc('\n', out);
}

static void say_errors(const struct orl_bsdf_made *made, FILE *out)
{
    static const char *const sides[2] = {"outside", "inside"};
    for (int front = 0; front < 2; front++) {
        const struct orl_bsdf_share *s = made->diffuse[front];
        fprintf(out,
                "Diffuse light from the %s: transmitted %.5f, standard error %.1e; reflected %.5f, "
                "%.1e\n",
                sides[front], s[1].value, s[1].error, s[0].value, s[0].error);
    }
    fprintf(out,
            "Largest standard error of values above a hundredth of their part's peak: %.2g of the "
            "value\n",
            made->worst);
    if (made->joined > 0)
        fprintf(out, "Largest that cells joined are off by from their mean, as rms: %.2g of it\n",
                made->joined);
    fprintf(out, "Light given up inside: %.2g", made->lost);
}

static void say_converted(const struct orl_gonio_sample *sample,
                          const struct orl_bsdf_make_request *r, FILE *out)
{
    fprintf(out, "Converted by Oriel " ORL_VERSION "\nFrom: %s", sample->source);
    if (orl_bsdf_basis_is_tree(r->basis))
        fprintf(out, "\nCells as one where within %g of their mean, or %g of the light", r->cull,
                r->unseen);
}

static char *say_all(const struct orl_gonio_sample *sample,
                     const struct orl_bsdf_make_request *request, const struct orl_bsdf_made *made,
                     bool errors)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    if (errors)
        fputs("Standard errors in place of values: no BSDF. Of these it is said:\n", out);
    if (sample->file) {
        say_converted(sample, request, out);
    } else {
        fputs("Made of geometry and materials by Oriel " ORL_VERSION "\n", out);
        say_sources(sample, out);
        say_settings(request, made, out);
        say_errors(made, out);
    }
    const bool failed = ferror(out);
    if (fclose(out) == 0 && !failed)
        return text;
    free(text);
    return NULL;
}

/* ---- The file -------------------------------------------------------------------------------- */

static int write_out(const struct orl_document *document, const struct orl_bsdf_labels *labels,
                     char **ret_xml, size_t *ret_size)
{
    FILE *out = open_memstream(ret_xml, ret_size);
    if (!out)
        return ORL_ERR_NOMEM;
    orl_document_write(document, labels, out);
    const bool failed = ferror(out);
    return fclose(out) == 0 && !failed ? 0 : ORL_ERR_NOMEM;
}

/* Contents and destination of a file. */
struct sheet {
    bool errors;
    char **xml;
    size_t *size;
    orl_bsdf_write_part *write_part;
    void *ctx;
};

static int write_sheet(struct orl_document *document, const struct sheet *sheet,
                       const struct orl_gonio_sample *sample,
                       const struct orl_bsdf_make_request *request,
                       const struct orl_bsdf_made *made)
{
    char *comment = say_all(sample, request, made, sheet->errors);
    const struct orl_bsdf_labels labels = {.manufacturer = sample->file ? "converted" : "simulated",
                                           .width_m = made->cell[1] - made->cell[0],
                                           .height_m = made->cell[3] - made->cell[2],
                                           .comment = comment,
                                           .write_part = sheet->write_part,
                                           .ctx = sheet->ctx};
    int code = comment ? 0 : ORL_ERR_NOMEM;
    document->thickness_m = made->depth[1] - made->depth[0];
    snprintf(document->name, sizeof document->name, "%s%s",
             request->name ? request->name : request->files[0], sheet->errors ? ", errors" : "");
    if (code == 0)
        code = write_out(document, &labels, sheet->xml, sheet->size);
    free(comment);
    return code;
}

int orl_gonio_write(struct orl_document *document, orl_bsdf_write_part *write_part, void *ctx,
                    const struct orl_gonio_sample *sample,
                    const struct orl_bsdf_make_request *request, struct orl_bsdf_made *made)
{
    const struct sheet sheet = {false, &made->xml, &made->xml_size, write_part, ctx};
    return write_sheet(document, &sheet, sample, request, made);
}

int orl_gonio_write_errors(struct orl_document *document, orl_bsdf_write_part *write_part,
                           void *ctx, const struct orl_gonio_sample *sample,
                           const struct orl_bsdf_make_request *request, struct orl_bsdf_made *made)
{
    const struct sheet sheet = {true, &made->errors_xml, &made->errors_xml_size, write_part, ctx};
    return write_sheet(document, &sheet, sample, request, made);
}
