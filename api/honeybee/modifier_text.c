/* Writes modifiers in Radiance's syntax. */
#include "honeybee/modifiers.h"

#include <string.h>
#include <strings.h>

enum { DEPTH = 16, NUMBERS = 9 };

/* Numeric argument of a type, in Radiance's order, with the schema's default. */
struct field {
    const char *name;
    double otherwise;
    double least, most;
};
static const struct kind {
    const char *type, *radiance;
    struct field fields[7];
} kinds[] = {
    {"Plastic",
     "plastic",
     {{"r_reflectance", 0, 0, 1},
      {"g_reflectance", 0, 0, 1},
      {"b_reflectance", 0, 0, 1},
      {"specularity", 0, 0, 1},
      {"roughness", 0, 0, 1}}},
    {"Metal",
     "metal",
     {{"r_reflectance", 0, 0, 1},
      {"g_reflectance", 0, 0, 1},
      {"b_reflectance", 0, 0, 1},
      {"specularity", 0.9, 0, 1},
      {"roughness", 0, 0, 1}}},
    {"Trans",
     "trans",
     {{"r_reflectance", 0, 0, 1},
      {"g_reflectance", 0, 0, 1},
      {"b_reflectance", 0, 0, 1},
      {"specularity", 0, 0, 1},
      {"roughness", 0, 0, 1},
      {"transmitted_diff", 0, 0, 1},
      {"transmitted_spec", 0, 0, 1}}},
    {"Glass",
     "glass",
     {{"r_transmissivity", 0, 0, 1.1},
      {"g_transmissivity", 0, 0, 1.1},
      {"b_transmissivity", 0, 0, 1.1}}},
    {"Mirror",
     "mirror",
     {{"r_reflectance", 1, 0, 1}, {"g_reflectance", 1, 0, 1}, {"b_reflectance", 1, 0, 1}}},
    {"Light",
     "light",
     {{"r_emittance", 0, 0, 1e12}, {"g_emittance", 0, 0, 1e12}, {"b_emittance", 0, 0, 1e12}}},
    {"Glow",
     "glow",
     {{"r_emittance", 0, 0, 1e12},
      {"g_emittance", 0, 0, 1e12},
      {"b_emittance", 0, 0, 1e12},
      {"max_radius", 0, -1e12, 1e12}}},
    {"BSDF", "BSDF", {{NULL, 0, 0, 0}}},
    {"aBSDF", "aBSDF", {{NULL, 0, 0, 0}}},
};

struct modifier_writer {
    struct orl_hb *hb;
    struct orl_hb_file *file;
    unsigned depth;
};

static int write_one(struct modifier_writer *w, size_t modifier_index, const struct orl_hb_at *at);

/* Writes a modifier that another names, before it. For NULL, null and Void, *ret_identifier is
 * "void". */
static int write_needed(struct modifier_writer *w, const json_t *value, const struct orl_hb_at *at,
                        const char **ret_identifier)
{
    size_t modifier_index = 0;
    *ret_identifier = "void";
    if (!value || json_is_null(value) || strcasecmp(orl_hb_type_of(value), "Void") == 0 ||
        (json_is_string(value) && strcmp(json_string_value(value), "void") == 0))
        return 0;
    int rc = orl_hb_modifier_find(w->hb, value, at, &modifier_index);
    if (rc == 0)
        rc = write_one(w, modifier_index, at);
    if (rc == 0)
        *ret_identifier = w->hb->modifiers[modifier_index].identifier;
    return rc;
}

static int write_dependencies(struct modifier_writer *w, const json_t *json,
                              const struct orl_hb_at *at)
{
    struct orl_hb_walk dependencies;
    const char *identifier;
    int rc = orl_hb_walk(w->hb, json, at, "dependencies", &dependencies);
    for (const json_t *dependency; rc == 0 && (dependency = orl_hb_next(&dependencies));)
        rc = write_needed(w, dependency, &dependencies.here, &identifier);
    return rc;
}

static int read_numbers(struct modifier_writer *w, const struct kind *kind, const json_t *json,
                        const struct orl_hb_at *at, double values[NUMBERS], size_t *ret_count)
{
    size_t n = 0;
    for (; n < sizeof kind->fields / sizeof *kind->fields && kind->fields[n].name; n++) {
        const struct field *field = &kind->fields[n];
        const struct orl_hb_at here = {at, field->name, 0};
        const json_t *value = orl_hb_get(json, field->name);
        values[n] = field->otherwise;
        const int rc = value ? orl_hb_number(w->hb, value, &here, &values[n]) : 0;
        if (rc)
            return rc;
        if (values[n] < field->least || values[n] > field->most)
            return orl_hb_fail(&here, w->hb->err, ORL_ERR_RANGE, "it must be from %g to %g",
                               field->least, field->most);
    }
    *ret_count = n;
    return 0;
}

/* Reads three numbers per reflectance or transmittance, up to the first that is absent. Later
 * ones are ignored. */
static int read_diffuse(struct modifier_writer *w, const json_t *json, const struct orl_hb_at *at,
                        double values[NUMBERS], size_t *ret_count)
{
    static const char *const names[] = {"front_diffuse_reflectance", "back_diffuse_reflectance",
                                        "diffuse_transmittance"};
    *ret_count = 0;
    for (size_t i = 0; i < 3; i++) {
        const struct orl_hb_at here = {at, names[i], 0};
        const json_t *value = orl_hb_get(json, names[i]);
        struct orl_vec3 rgb;
        if (!value)
            return 0;
        const int rc = orl_hb_point(w->hb, value, &here, &rgb);
        if (rc)
            return rc;
        values[3 * i] = rgb.x;
        values[3 * i + 1] = rgb.y;
        values[3 * i + 2] = rgb.z;
        *ret_count = 3 * i + 3;
    }
    return 0;
}

/* Writes the XML in the model to a file. */
static int write_bsdf_file(struct modifier_writer *w, struct orl_hb_modifier *modifier,
                           const struct orl_hb_at *at)
{
    const struct orl_hb_at here = {at, "bsdf_data", 0};
    const json_t *data = orl_hb_get(modifier->json, "bsdf_data");
    struct orl_hb_file file;
    if (modifier->has_file)
        return 0;
    if (!json_is_string(data))
        return orl_hb_fail(&here, w->hb->err, ORL_ERR_INVALID,
                           "the text of a BSDF file is expected here");
    const int rc = orl_hb_begin(w->hb, &file);
    if (rc)
        return rc;
    fwrite(json_string_value(data), 1, json_string_length(data), file.stream);
    modifier->has_file = true;
    return orl_hb_end(w->hb, &file, "model/bsdf/%s.xml", modifier->identifier);
}

/* Counts the words of xform's options, as Radiance splits them. */
static int count_words(const char *text, size_t length, size_t *ret_count)
{
    bool inside = false;
    *ret_count = 0;
    for (size_t i = 0; i < length; i++) {
        if (text[i] != ' ' && (text[i] < '+' || text[i] > 'z' || text[i] == '\\'))
            return -1;
        *ret_count += text[i] != ' ' && !inside;
        inside = text[i] != ' ';
    }
    return 0;
}

/* Writes the strings of a BSDF: thickness (only of BSDF), file, up, function file, transform. */
static int write_bsdf_strings(struct modifier_writer *w, struct orl_hb_modifier *modifier,
                              const struct orl_hb_at *at)
{
    const json_t *json = modifier->json, *up = orl_hb_get(json, "up_orientation"),
                 *thick = orl_hb_get(json, "thickness"), *with = orl_hb_get(json, "transform");
    const struct orl_hb_at in_up = {at, "up_orientation", 0}, in_thick = {at, "thickness", 0},
                           in_file = {at, "function_file", 0}, in_with = {at, "transform", 0};
    const bool has_thickness = strcasecmp(orl_hb_type_of(json), "BSDF") == 0;
    const char *function = json_string_value(orl_hb_get(json, "function_file"));
    struct orl_vec3 v = orl_v3(0.01, 0.01, 1);
    double thickness = 0;
    size_t words = 0;
    int rc = up ? orl_hb_point(w->hb, up, &in_up, &v) : 0;
    if (rc == 0 && thick)
        rc = orl_hb_number(w->hb, thick, &in_thick, &thickness);
    if (rc == 0 && function && strcmp(function, ".") != 0)
        rc = orl_hb_fail(&in_file, w->hb->err, ORL_ERR_UNSUPPORTED,
                         "a model cannot contain a function file: only \".\" is allowed here");
    if (rc == 0 && with &&
        (!json_is_string(with) ||
         count_words(json_string_value(with), json_string_length(with), &words)))
        rc = orl_hb_fail(&in_with, w->hb->err, ORL_ERR_INVALID,
                         "options of xform are expected here");
    if (rc)
        return rc;
    FILE *stream = w->file->stream;
    fprintf(stream, "%zu ", words + (has_thickness ? 6 : 5));
    if (has_thickness)
        fprintf(stream, "%.17g ", thickness);
    fprintf(stream, "model/bsdf/%s.xml %.17g %.17g %.17g . %s\n", modifier->identifier, v.x, v.y,
            v.z, words > 0 ? json_string_value(with) : "");
    return 0;
}

/* Writes the string arguments after the modifier's name. */
static int write_strings(struct modifier_writer *w, struct orl_hb_modifier *modifier,
                         const struct orl_hb_at *at, const char *alternate)
{
    const char *type = orl_hb_type_of(modifier->json);
    if (strcasecmp(type, "BSDF") == 0 || strcasecmp(type, "aBSDF") == 0)
        return write_bsdf_strings(w, modifier, at);
    if (alternate)
        fprintf(w->file->stream, "1 %s\n", alternate);
    else
        fputs("0\n", w->file->stream);
    return 0;
}

/* Appends the optional index of refraction of glass. */
static int add_index(struct modifier_writer *w, const json_t *json, const struct orl_hb_at *at,
                     double values[NUMBERS], size_t *count)
{
    const struct orl_hb_at here = {at, "refraction_index", 0};
    const json_t *index = orl_hb_get(json, "refraction_index");
    if (!index || strcasecmp(orl_hb_type_of(json), "Glass") != 0)
        return 0;
    const int rc = orl_hb_number(w->hb, index, &here, &values[*count]);
    if (rc == 0 && !(values[*count] > 1 && values[*count] < 10))
        return orl_hb_fail(&here, w->hb->err, ORL_ERR_RANGE, "it must be above 1 and below 10");
    *count += rc == 0;
    return rc;
}

static int write_values(struct modifier_writer *w, size_t modifier_index, const struct kind *kind,
                        const char *modified_by, const char *alternate, const struct orl_hb_at *at)
{
    struct orl_hb_modifier *modifier = &w->hb->modifiers[modifier_index];
    double values[NUMBERS];
    size_t count = 0;
    const bool bsdf = !kind->fields[0].name;
    int rc = bsdf ? read_diffuse(w, modifier->json, at, values, &count)
                  : read_numbers(w, kind, modifier->json, at, values, &count);
    if (rc == 0)
        rc = add_index(w, modifier->json, at, values, &count);
    if (rc == 0 && bsdf)
        rc = write_bsdf_file(w, modifier, at);
    if (rc)
        return rc;
    FILE *stream = w->file->stream;
    fprintf(stream, "%s %s %s\n", modified_by, kind->radiance, modifier->identifier);
    rc = write_strings(w, modifier, at, alternate);
    fprintf(stream, "0\n%zu", count);
    for (size_t i = 0; i < count; i++)
        fprintf(stream, " %.17g", values[i]);
    fputs("\n\n", stream);
    return rc;
}

static int write_own(struct modifier_writer *w, size_t modifier_index, const struct orl_hb_at *at)
{
    const json_t *json = w->hb->modifiers[modifier_index].json;
    const json_t *other = json_object_get(json, "alternate_material");
    const struct orl_hb_at in_modifier = {at, "modifier", 0},
                           in_other = {at, "alternate_material", 0}, in_type = {at, "type", 0};
    const char *modified_by = "void", *alternate = NULL;
    size_t k = 0;
    while (k < sizeof kinds / sizeof *kinds && strcasecmp(kinds[k].type, orl_hb_type_of(json)) != 0)
        k++;
    if (k == sizeof kinds / sizeof *kinds) {
        orl_hb_fail(&in_type, w->hb->err, ORL_ERR_UNSUPPORTED,
                    "modifiers of type '%.60s' are not known", orl_hb_type_of(json));
        orl_error_hint(w->hb->err, "Known are Plastic, Metal, Trans, Glass, Mirror, Glow, Light, "
                                   "BSDF, aBSDF and Void");
        return ORL_ERR_UNSUPPORTED;
    }
    int rc = write_dependencies(w, json, at);
    if (rc == 0)
        rc = write_needed(w, json_object_get(json, "modifier"), &in_modifier, &modified_by);
    if (rc == 0 && other && !json_is_null(other))
        rc = write_needed(w, other, &in_other, &alternate);
    return rc ? rc : write_values(w, modifier_index, &kinds[k], modified_by, alternate, at);
}

static int write_one(struct modifier_writer *w, size_t modifier_index, const struct orl_hb_at *at)
{
    struct orl_hb_modifier *modifier = &w->hb->modifiers[modifier_index];
    if (modifier->written == w->file->number)
        return 0;
    if (modifier->is_being_written || w->depth == DEPTH)
        return orl_hb_fail(at, w->hb->err, ORL_ERR_INVALID,
                           modifier->is_being_written
                               ? "the modifier '%s' depends on itself"
                               : "the modifier '%s' depends on too many others",
                           modifier->identifier);
    modifier->is_being_written = true;
    w->depth++;
    int rc = 0;
    if (modifier->json)
        rc = write_own(w, modifier_index, at);
    else
        orl_hb_generic_write(modifier, w->file->stream);
    w->depth--;
    modifier =
        &w->hb
             ->modifiers[modifier_index]; /* reloaded because the array may have been reallocated */
    modifier->is_being_written = false;
    modifier->written = w->file->number;
    return rc;
}

int orl_hb_modifier_write(struct orl_hb *hb, size_t modifier_index, struct orl_hb_file *file)
{
    struct modifier_writer w = {hb, file, 0};
    const struct orl_hb_at at = {NULL, hb->modifiers[modifier_index].identifier, 0};
    return write_one(&w, modifier_index, &at);
}
