/* Writes the file around the data: labels, structure, and a block for each part and channel. */
#include "bsdf/xml/bsdf_xml.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/out_file.h"

void orl_write_value(FILE *out, float value)
{
    char text[32];
    int digits = 6;
    do {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
    } while (digits++ < 9 && strtof(text, NULL) != value);
    fputs(text, out);
}

/* Writes the data of one channel: a line per direction out; directions in run along the line. */
static void write_matrix(const struct orl_matrix *matrix, FILE *out)
{
    const int n_a = matrix->basis[ORL_AXIS_A].n_cells, n_b = matrix->basis[ORL_AXIS_B].n_cells;
    for (int b = 0; b < n_b; b++) {
        for (int a = 0; a < n_a; a++) {
            orl_write_value(out, matrix->values[(size_t)a * (size_t)n_b + (size_t)b]);
            fputs(a + 1 < n_a ? ",\t" : ",\n", out);
        }
    }
}

/* ---- Text ------------------------------------------------------------------------------------ */

/* Returns the bytes of the character at text; 0 if it is not valid UTF-8 or not allowed in XML
 * (control characters, U+FFFE, U+FFFF). */
static int character_bytes(const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    /* leads[n]: least lead byte of characters longer than n bytes; leads[4]: of none. */
    static const unsigned char leads[] = {0, 0xc2, 0xe0, 0xf0, 0xf5};
    uint32_t code = at[0];
    int n = 1;
    if (code < 0x80)
        return code >= ' ';
    while (n < 4 && at[0] >= leads[n])
        n++;
    if (n == 1 || at[0] >= leads[4])
        return 0;
    code &= 0x7fU >> n;
    for (int i = 1; i < n; i++) {
        if ((at[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (at[i] & 0x3fU);
    }
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool half = code >= 0xd800 && code < 0xe000; /* half of a surrogate pair of UTF-16 */
    return code < least[n] || code > 0x10ffff || half || (code | 1) == 0xffff ? 0 : n;
}

/* Writes a character, or '?' for an invalid one; returns the bytes of text consumed. */
static int write_character(FILE *out, const char *text)
{
    const int n = character_bytes(text);
    if (n == 0)
        putc('?', out);
    else
        fwrite(text, 1, (size_t)n, out);
    return n > 0 ? n : 1;
}

/* Writes text with XML's special characters as entities. */
static void write_text(FILE *out, const char *text)
{
    while (*text) {
        const char *name = *text == '<' ? "&lt;" : *text == '>' ? "&gt;" : "&amp;";
        if (*text != '<' && *text != '>' && *text != '&') {
            text += write_character(out, text);
            continue;
        }
        fputs(name, out);
        text++;
    }
}

/* Writes a comment. Two dashes would end it, so a space is put between them. */
static void write_comment(FILE *out, const char *text)
{
    char before = '\n';
    fputs("<!--\n", out);
    while (*text) {
        if (*text == '-' && before == '-')
            putc(' ', out);
        before = *text;
        if (*text == '\n')
            putc(*text++, out);
        else
            text += write_character(out, text);
    }
    fputs("\n-->\n", out);
}

static void write_length(FILE *out, const char *name, double length_m)
{
    if (length_m > 0)
        fprintf(out, "<%s unit=\"meter\">%.6g</%s>\n", name, length_m, name);
}

static void write_basis(FILE *out, const struct orl_basis *basis)
{
    double lower = 0;
    fprintf(out, "<AngleBasis>\n<AngleBasisName>%s</AngleBasisName>\n", basis->name);
    for (int r = 0; r < basis->n_rings; r++) {
        const struct orl_theta_ring *ring = &basis->rings[r];
        const double upper = acos(sqrt(ring->cos2_high)) / ORL_DEG_TO_RAD;
        const double middle = r == 0 ? 0 : 0.5 * (lower + upper);
        fprintf(out,
                "<AngleBasisBlock>\n<Theta>%.5g</Theta>\n<nPhis>%d</nPhis>\n<ThetaBounds>\n"
                "<LowerTheta>%.5g</LowerTheta>\n<UpperTheta>%.5g</UpperTheta>\n</ThetaBounds>\n"
                "</AngleBasisBlock>\n",
                middle, ring->cells, lower, upper);
        lower = upper;
    }
    fputs("</AngleBasis>\n", out);
}

static const struct orl_basis *basis_of(const struct orl_document *d)
{
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++)
        if (d->parts[i].present)
            return &d->parts[i].matrix.basis[0];
    return NULL;
}

static void write_definition(FILE *out, const struct orl_document *d)
{
    static const char *const names[] = {[ORL_STRUCTURE_NONE] = "",
                                        [ORL_STRUCTURE_TREE3] = "TensorTree3",
                                        [ORL_STRUCTURE_TREE4] = "TensorTree4",
                                        [ORL_STRUCTURE_MATRIX] = "Columns"};
    const struct orl_basis *basis = d->structure == ORL_STRUCTURE_MATRIX ? basis_of(d) : NULL;
    fprintf(out, "<DataDefinition>\n<IncidentDataStructure>%s</IncidentDataStructure>\n",
            names[d->structure]);
    if (basis)
        write_basis(out, basis);
    fputs("</DataDefinition>\n", out);
}

static void write_head(FILE *out, const struct orl_document *d,
                       const struct orl_bsdf_labels *labels)
{
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", out);
    if (labels->comment)
        write_comment(out, labels->comment);
    fputs("<WindowElement xmlns=\"http://windows.lbl.gov\" "
          "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
          "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
          "<WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n"
          "<Optical>\n<Layer>\n<Material>\n<Name>",
          out);
    write_text(out, d->name);
    fputs("</Name>\n<Manufacturer>", out);
    write_text(out, labels->manufacturer);
    fputs("</Manufacturer>\n<DeviceType>Other</DeviceType>\n", out);
    write_length(out, "Thickness", d->thickness_m);
    write_length(out, "Width", labels->width_m);
    write_length(out, "Height", labels->height_m);
    fputs("</Material>\n", out);
    write_definition(out, d);
}

/* Writes a channel's name in the schema, and its detector; a chromaticity has none. */
static void write_channel(FILE *out, bool matrix, enum orl_bsdf_channel channel)
{
    static const char *const names[2][ORL_CHANNEL_COUNT] = {{"Visible", "CIE-u", "CIE-v"},
                                                            {"Visible", "CIE-X", "CIE-Z"}};
    fprintf(out,
            "<Wavelength unit=\"Integral\">%s</Wavelength>\n"
            "<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n",
            names[matrix][channel]);
    if (matrix || channel == ORL_CHANNEL_VISIBLE)
        fprintf(out, "<DetectorSpectrum>ASTM E308 1931 %c.dsp</DetectorSpectrum>\n",
                "YXZ"[channel]);
}

static void write_data(FILE *out, const struct orl_document *d,
                       const struct orl_bsdf_labels *labels, enum orl_component_kind part,
                       enum orl_bsdf_channel channel)
{
    const struct orl_component *c = &d->parts[part];
    if (d->structure != ORL_STRUCTURE_MATRIX)
        labels->write_part(labels->ctx, part, channel, out);
    else
        write_matrix(
            channel == ORL_CHANNEL_VISIBLE ? &c->matrix : &c->chroma.matrix[(int)channel - 1], out);
}

static void write_block(FILE *out, const struct orl_document *d,
                        const struct orl_bsdf_labels *labels, enum orl_component_kind part,
                        enum orl_bsdf_channel channel)
{
    const bool reflection =
        part == ORL_COMPONENT_REFLECTION_FRONT || part == ORL_COMPONENT_REFLECTION_BACK;
    const char *basis = d->parts[part].matrix.basis[0].name;
    fputs("<WavelengthData>\n<LayerNumber>System</LayerNumber>\n", out);
    write_channel(out, d->structure == ORL_STRUCTURE_MATRIX, channel);
    fprintf(out, "<WavelengthDataBlock>\n<WavelengthDataDirection>%s</WavelengthDataDirection>\n",
            orl_component_names[part]);
    if (d->structure == ORL_STRUCTURE_MATRIX)
        fprintf(out, "<ColumnAngleBasis>%s</ColumnAngleBasis>\n<RowAngleBasis>%s</RowAngleBasis>\n",
                basis, basis);
    else
        fputs("<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n", out);
    fprintf(out, "<ScatteringDataType>%s</ScatteringDataType>\n<ScatteringData>\n",
            reflection ? "BRDF" : "BTDF");
    write_data(out, d, labels, part, channel);
    fputs("</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n", out);
}

void orl_document_write(const struct orl_document *document, const struct orl_bsdf_labels *labels,
                        FILE *out)
{
    write_head(out, document, labels);
    for (int channel = ORL_CHANNEL_VISIBLE; channel < ORL_CHANNEL_COUNT; channel++)
        for (int part = 0; part < ORL_COMPONENT_COUNT; part++) {
            const struct orl_component *component = &document->parts[part];
            const bool *given = component->chroma.given;
            if (component->present && (channel == ORL_CHANNEL_VISIBLE || (given[0] && given[1])))
                write_block(out, document, labels, (enum orl_component_kind)part,
                            (enum orl_bsdf_channel)channel);
        }
    fputs("</Layer>\n</Optical>\n</WindowElement>\n", out);
}

int orl_document_write_text(const struct orl_document *document,
                            const struct orl_bsdf_labels *labels, char **ret_text, size_t *ret_size)
{
    FILE *out = open_memstream(ret_text, ret_size);
    if (!out)
        return ORL_ERR_NOMEM;
    orl_document_write(document, labels, out);
    return orl_memstream_close(out, ret_text) ? 0 : ORL_ERR_NOMEM;
}
