#include "scene/parse/command/commands.h"

#include <string.h>
#include <strings.h>

#include "bsdf/xml/bsdf_xml.h"
#include "scene/generate/mgf/mgf.h"

/* A BSDF file and its geometry. */
struct package {
    const char *file; /* name in the command */
    const char *resolved;
    char name[256]; /* without folder and extension */
    struct orl_bsdf *bsdf;
    struct orl_bsdf_geometry file_geometry;
};

/* ---- Faces ----------------------------------------------------------------------------------- */

/* Adds the BSDF's rectangle as a proxy in front of (offset positive) or behind its geometry; 0:
 * there is no geometry. Like pkgBSDF it leaves a small clearance. */
static void add_face(struct orl_text *text, const struct package *package, double offset)
{
    static const double clearance = 2e-5, reach = 1.00004;
    const double x = package->file_geometry.width / 2, y = package->file_geometry.height / 2;
    const double z = offset > 0 ? offset * clearance : offset * (1 + clearance);
    const char *const side = offset > 0 ? "_f" : offset < 0 ? "_b" : "";
    orl_text_add(text, "void BSDF 'm_%s%s'\n6 %.9g '%s' 0 1 0 .\n0\n0\n", package->name, side,
                 offset * reach, package->file);
    orl_text_add(text, "'m_%s%s' polygon '%s%s'\n0\n0\n12", package->name, side, package->name,
                 side);
    orl_text_add(text, "\n %.6e %.6e %.6e\n %.6e %.6e %.6e", -x, -y, z, x, -y, z);
    orl_text_add(text, "\n %.6e %.6e %.6e\n %.6e %.6e %.6e\n", x, y, z, -x, y, z);
}

/* Returns true if the BSDF reflects light from behind; less than a thousandth is ignored. */
static bool reflects_behind(const struct orl_bsdf *bsdf)
{
    for (int i = 0; i < 90; i += 15) {
        const double angle = i * M_PI / 180;
        for (int k = 0; k < 4; k++) {
            const struct orl_vec3 in =
                orl_v3(sin(angle) * cos(k * M_PI_2), sin(angle) * sin(k * M_PI_2), -cos(angle));
            if (orl_rgb_max(orl_bsdf_albedo(bsdf, in, ORL_BSDF_REFLECT)) > 1e-3)
                return true;
        }
    }
    return false;
}

static int write_package(const struct package *package, struct orl_text *text,
                         struct orl_error *err)
{
    const struct orl_bsdf_geometry *file_geometry = &package->file_geometry;
    if (!(file_geometry->width > 0 && file_geometry->height > 0)) {
        orl_error_set(err, ORL_ERR_RANGE,
                      "the BSDF does not give the width and height of its panel");
        orl_error_hint(err,
                       "add Width and Height to the Material of %.80s, or use the BSDF as the "
                       "material of your own polygon",
                       package->resolved);
        return ORL_ERR_RANGE;
    }
    if (!file_geometry->geometry) {
        add_face(text, package, 0);
        return 0;
    }
    if (!(file_geometry->thickness > 0))
        return orl_error_set(err, ORL_ERR_RANGE, "the BSDF's geometry has no thickness");
    add_face(text, package, file_geometry->thickness);
    if (reflects_behind(package->bsdf))
        add_face(text, package, -file_geometry->thickness);
    const struct orl_mgf mgf = {.text = {.file = package->resolved,
                                         .line = file_geometry->geometry_line,
                                         .data = file_geometry->geometry,
                                         .size = file_geometry->geometry_size},
                                .unit_m = file_geometry->geometry_unit,
                                .emission = 1};
    return orl_mgf_write(&mgf, text, err);
}

/* ---- pkgBSDF --------------------------------------------------------------------------------- */

static int read_package_words(const char *const *words, size_t count, struct package *package,
                              struct orl_error *err)
{
    bool to_output = false;
    size_t i = 1;
    for (; i < count && words[i][0] == '-'; i++) {
        if (strcmp(words[i], "-s") != 0 && strcmp(words[i], "-i") != 0)
            return orl_error_set(err, ORL_ERR_SYNTAX, "pkgBSDF: '%.40s' is not an option",
                                 words[i]);
        to_output |= words[i][1] == 's';
    }
    if (!to_output)
        return orl_error_refuse(err, ORL_ERR_SYNTAX, "add -s",
                                "pkgBSDF without -s writes a file and adds nothing to the scene");
    if (i + 1 != count)
        return orl_error_set(err, ORL_ERR_SYNTAX, "pkgBSDF -s takes one file");
    package->file = words[i];
    const char *const base = basename(words[i]);
    const size_t length = strlen(base);
    if (length < 5 || length - 4 >= sizeof package->name || strchr(words[i], '\'') ||
        strcasecmp(base + length - 4, ".xml") != 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "pkgBSDF: '%.80s' does not end in .xml",
                             words[i]);
    memcpy(package->name, base, length - 4);
    return 0;
}

int orl_parser_pkgbsdf(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err)
{
    struct package package = {0};
    size_t index = 0;
    int code = read_package_words(words, count, &package, err);
    if (code == 0)
        code = orl_sources_find(&parser->sources, scope->folder, package.file, &index, err);
    if (code == 0)
        code = orl_sources_bsdf(&parser->sources, index, &package.bsdf, err);
    if (code < 0)
        return code;
    const struct orl_source *source = &parser->sources.items[index];
    package.resolved = source->name;
    code = orl_bsdf_geometry_read(source->name, source->file.data, source->file.size,
                                  &package.file_geometry, err);
    if (code == 0)
        code = write_package(&package, text, err);
    orl_bsdf_geometry_done(&package.file_geometry);
    return code;
}

/* ---- MGF ------------------------------------------------------------------------------------- */

struct opening {
    struct orl_parser *parser;
    const struct orl_scope *scope;
};

static int open_mgf(void *ctx, const char *folder, const char *name, struct orl_mgf_text *ret_text,
                    struct orl_error *err)
{
    const struct opening *const opening = ctx;
    struct orl_sources *const sources = &opening->parser->sources;
    size_t index = 0;
    int code = orl_sources_find(sources, folder, name, &index, err);
    if (code == 0)
        code = orl_parser_count_text(opening->parser, opening->scope,
                                     sources->items[index].file.size, err);
    if (code == 0)
        *ret_text = (struct orl_mgf_text){.file = sources->items[index].name,
                                          .folder = sources->items[index].folder,
                                          .line = 1,
                                          .data = sources->items[index].file.data,
                                          .size = sources->items[index].file.size};
    return code;
}

int orl_parser_mgf(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err)
{
    struct opening opening = {parser, scope};
    struct orl_mgf whole = *mgf;
    const int code = open_mgf(&opening, scope->folder, name, &whole.text, err);
    whole.open = open_mgf;
    whole.ctx = &opening;
    return code ? code : orl_mgf_write(&whole, text, err);
}

int orl_parser_mgf2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err)
{
    struct orl_words left = {.program = "mgf2rad", .at = words + 1, .left = count - 1};
    struct orl_mgf mgf = {.unit_m = 1, .emission = 1};
    int code = 0;
    while (code == 0 && left.left > 0 && left.at[0][0] == '-') {
        const char *const option = orl_words_take(&left);
        if (strcmp(option, "-g") == 0)
            code = orl_words_number(&left, option, &mgf.glow_radius, err);
        else if (strcmp(option, "-e") == 0)
            code = orl_words_number(&left, option, &mgf.emission, err);
        else if (strcmp(option, "-s") != 0)
            code = orl_error_set(err, ORL_ERR_UNSUPPORTED, "mgf2rad: '%.40s' is not supported",
                                 option);
    }
    if (code == 0 && left.left != 1)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "mgf2rad takes exactly one file");
    if (code == 0 && !(mgf.glow_radius >= 0 && mgf.emission >= 0))
        code = orl_error_set(err, ORL_ERR_RANGE, "mgf2rad: numbers must not be negative");
    return code ? code : orl_parser_mgf(parser, scope, left.at[0], &mgf, text, err);
}
