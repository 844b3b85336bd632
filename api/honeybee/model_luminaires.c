#include "honeybee/model_objects.h"

#include <string.h>

/* State for writing luminaires: the current one, and the file that places all of them. */
struct luminaire_writer {
    struct orl_hb *hb;
    struct orl_hb_file *rad;
    const json_t *json;
    const struct orl_hb_at *at;
    char name[160]; /* name of the luminaire's own files, without ending */
};

/* Reads a factor above 0; 1 if absent. */
static int read_factor(struct luminaire_writer *w, const json_t *of, const struct orl_hb_at *at,
                       const char *member, double *ret_factor)
{
    const struct orl_hb_at here = {at, member, 0};
    const json_t *value = orl_hb_get(of, member);
    *ret_factor = 1;
    const int rc = value ? orl_hb_number(w->hb, value, &here, ret_factor) : 0;
    if (rc == 0 && !(*ret_factor > 0))
        return orl_hb_fail(&here, w->hb->err, ORL_ERR_RANGE, "it must be above 0");
    return rc;
}

/* Reads n numbers from 0 to 1. *ret_given is true if the member is present. */
static int read_shares(struct luminaire_writer *w, const json_t *lamp, const struct orl_hb_at *at,
                       const char *member, double *ret_shares, size_t n, bool *ret_given)
{
    const struct orl_hb_at here = {at, member, 0};
    const json_t *values = orl_hb_get(lamp, member);
    int rc = 0;
    *ret_given = values;
    if (values && json_array_size(values) != n)
        return orl_hb_fail(&here, w->hb->err, ORL_ERR_INVALID, "%zu numbers are expected here", n);
    for (size_t i = 0; values && i < n && rc == 0; i++) {
        const struct orl_hb_at in = {&here, NULL, i};
        rc = orl_hb_number(w->hb, json_array_get(values, i), &in, &ret_shares[i]);
        if (rc == 0 && !(ret_shares[i] >= 0 && ret_shares[i] <= 1))
            rc = orl_hb_fail(&in, w->hb->err, ORL_ERR_RANGE, "it must be from 0 to 1");
    }
    return rc;
}

static int write_file(struct luminaire_writer *w, const char *ending, const char *text, size_t size)
{
    struct orl_hb_file file;
    const int rc = orl_hb_begin(w->hb, &file);
    if (rc)
        return rc;
    fwrite(text, 1, size, file.stream);
    return orl_hb_end(w->hb, &file, "%s.%s", w->name, ending);
}

/* Makes ies2rad's options for a lamp with its own colour. As in Honeybee, the depreciation of a
 * white lamp counts twice: as a factor and in its table. */
static int read_lamp(struct luminaire_writer *w, char *ret_options, size_t size, double *ret_factor)
{
    const struct orl_hb_at at = {w->at, "custom_lamp", 0};
    const json_t *lamp = orl_hb_get(w->json, "custom_lamp");
    double rgb[3] = {0}, white[2] = {0};
    bool is_rgb = false, is_white = false;
    char table[200];
    *ret_factor = 1;
    *ret_options = '\0';
    if (!lamp)
        return 0;
    int rc = read_factor(w, lamp, &at, "depreciation_factor", ret_factor);
    if (rc == 0)
        rc = read_shares(w, lamp, &at, "rgb", rgb, 3, &is_rgb);
    if (rc == 0)
        rc = read_shares(w, lamp, &at, "white_xy", white, 2, &is_white);
    if (rc == 0 && is_rgb == is_white)
        rc = orl_hb_fail(&at, w->hb->err, ORL_ERR_INVALID,
                         "either rgb or white_xy is expected here");
    if (rc)
        return rc;
    if (is_rgb) {
        snprintf(ret_options, size, " -t default -c %.9g %.9g %.9g", rgb[0], rgb[1], rgb[2]);
        return 0;
    }
    snprintf(table, sizeof table, "/own/ %.9g %.9g %.9g\n", white[0], white[1], *ret_factor);
    snprintf(ret_options, size, " -t own -f %s.tab", w->name);
    return write_file(w, "tab", table, strlen(table));
}

/* Reads {"x": 1, "y": 2, "z": 3}, or three numbers. */
static int read_position(struct luminaire_writer *w, const json_t *value,
                         const struct orl_hb_at *at, struct orl_vec3 *ret_position)
{
    if (!json_is_object(value))
        return orl_hb_point(w->hb, value, at, ret_position);
    json_t *numbers = json_pack("[O?, O?, O?]", json_object_get(value, "x"),
                                json_object_get(value, "y"), json_object_get(value, "z"));
    const int rc =
        numbers ? orl_hb_point(w->hb, numbers, at, ret_position) : orl_error_no_memory(w->hb->err);
    json_decref(numbers);
    return rc;
}

static int write_placement(struct luminaire_writer *w, const json_t *instance,
                           const struct orl_hb_at *at, const char *command)
{
    static const struct {
        const char *member, *option;
    } turns[] = {{"spin", "-rz"}, {"tilt", "-ry"}, {"rotation", "-rz"}};
    const struct orl_hb_at in_point = {at, "point", 0};
    struct orl_vec3 position;
    int rc = read_position(w, json_object_get(instance, "point"), &in_point, &position);
    if (rc)
        return rc;
    fprintf(w->rad->stream, "%s | xform", command);
    for (size_t i = 0; i < sizeof turns / sizeof *turns && rc == 0; i++) {
        const struct orl_hb_at here = {at, turns[i].member, 0};
        const json_t *value = orl_hb_get(instance, turns[i].member);
        double degrees = 0;
        rc = value ? orl_hb_number(w->hb, value, &here, &degrees) : 0;
        fprintf(w->rad->stream, " %s %.17g", turns[i].option, degrees);
    }
    fprintf(w->rad->stream, " -t %.17g %.17g %.17g\n", position.x, position.y, position.z);
    return rc ? rc : orl_hb_check(w->hb, w->rad);
}

static int write_placements(struct luminaire_writer *w, const char *command)
{
    const struct orl_hb_at in_zone = {w->at, "luminaire_zone", 0},
                           list = {&in_zone, "instances", 0};
    const json_t *zone = orl_hb_get(w->json, "luminaire_zone");
    struct orl_hb_walk instances;
    int rc = orl_hb_walk(w->hb, zone, &in_zone, "instances", &instances);
    if (rc == 0 && json_array_size(instances.array) == 0)
        return orl_hb_fail(&list, w->hb->err, ORL_ERR_INVALID,
                           "the luminaire has no instances: list at least one position");
    for (const json_t *instance; rc == 0 && (instance = orl_hb_next(&instances));)
        rc = write_placement(w, instance, &instances.here, command);
    return rc;
}

static const char *unit_option(const struct orl_hb *hb)
{
    static const char *const units[][2] = {{"Millimeters", "-dm/1000"},
                                           {"Centimeters", "-dm/100"},
                                           {"Feet", "-df"},
                                           {"Inches", "-di"}};
    const char *unit = json_string_value(orl_hb_get(hb->model, "units"));
    for (size_t i = 0; unit && i < sizeof units / sizeof *units; i++)
        if (strcmp(units[i][0], unit) == 0)
            return units[i][1];
    return "-dm";
}

static int write_luminaire(struct luminaire_writer *w)
{
    const struct orl_hb_at in_text = {w->at, "ies_content", 0};
    const json_t *ies = json_object_get(w->json, "ies_content");
    double loss = 1, candela = 1, lamp = 1;
    char options[300], command[800];
    int rc = read_factor(w, w->json, w->at, "light_loss_factor", &loss);
    if (rc == 0)
        rc = read_factor(w, w->json, w->at, "candela_multiplier", &candela);
    if (rc == 0 && !json_is_string(ies))
        rc = orl_hb_fail(&in_text, w->hb->err, ORL_ERR_INVALID,
                         "the text of an IES file is expected here");
    if (rc == 0)
        rc = read_lamp(w, options, sizeof options, &lamp);
    if (rc == 0)
        rc = write_file(w, "ies", json_string_value(ies), json_string_length(ies));
    if (rc)
        return rc;
    snprintf(command, sizeof command, "!ies2rad %s -m %.17g%s %s.ies", unit_option(w->hb),
             loss * candela * lamp, options, w->name);
    return write_placements(w, command);
}

static int write_all(struct orl_hb *hb, struct orl_hb_file *rad)
{
    const struct orl_hb_at properties = {NULL, "properties", 0},
                           radiance = {&properties, "radiance", 0};
    struct orl_hb_walk luminaires;
    int rc = orl_hb_walk(hb, orl_hb_radiance(hb->model), &radiance, "luminaires", &luminaires);
    for (const json_t *json; rc == 0 && (json = orl_hb_next(&luminaires));) {
        const struct orl_hb_at named = {&luminaires.here, "identifier", 0};
        struct luminaire_writer w = {.hb = hb, .rad = rad, .json = json, .at = &luminaires.here};
        const char *identifier;
        rc = orl_hb_identifier(hb, json_object_get(json, "identifier"), &named, &identifier);
        if (rc)
            break;
        snprintf(w.name, sizeof w.name, "model/ies/%zu_%s", luminaires.here.index, identifier);
        rc = write_luminaire(&w);
    }
    return rc;
}

int orl_hb_luminaires_write(struct orl_hb *hb)
{
    struct orl_hb_file rad = {0};
    int rc = orl_hb_begin(hb, &rad);
    if (rc == 0)
        rc = write_all(hb, &rad);
    if (rc == 0)
        rc = orl_hb_end(hb, &rad, "model/ies/luminaires.rad");
    orl_hb_discard(&rad);
    return rc;
}
