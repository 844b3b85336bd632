#include "scene/parse/luminaire/luminaires.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/text/words.h"
#include "scene/grid/ies.h"
#include "scene/parse/command/commands.h"

/* Luminaires: the shape of the luminous opening, then the scene text of the whole. */

static const double tiny = 1e-6;

/* ---- Shape of the luminous opening, from the sizes in the IES file --------------------------- */

/* Lower bound of sizes. */
#define MIN_M 1e-3

enum luminaire_body { BODY_BOX, BODY_DISC, BODY_BALL };

/* In metres: along x, along y, height. For round shapes length and width are the diameter. */
struct luminaire_shape {
    enum luminaire_body body;
    double length, width, height;
};

static struct luminaire_shape box(double length, double width, double height)
{
    return (struct luminaire_shape){BODY_BOX, fmax(length, MIN_M), fmax(width, MIN_M),
                                    fmax(height, MIN_M / 2)};
}

static struct luminaire_shape disc(double width, double height)
{
    return (struct luminaire_shape){BODY_DISC, width, width, fmax(height, MIN_M / 2)};
}

/* Replaces an ellipse by a disc if it is nearly round, else by its bounding box. */
static struct luminaire_shape ellipse(double length, double width, double height,
                                      struct orl_text *text)
{
    const double mean = (length + width) / 2;
    const bool round = fabs(length - mean) < mean / 2;
    orl_text_warn(text, "its opening is an ellipse: it is simulated as a %s",
                  round ? "circle" : "box");
    return round ? disc(width, height) : box(width, length, height);
}

static int sign_of(double size)
{
    return size < 0 ? 0 : size == 0 ? 1 : 2;
}

/* Signs of length, width and height, - 0 +, as one number. */
#define SIGNS(l, w, h) (100 * ((l) + 1) + 10 * ((w) + 1) + (h) + 1)

/* Interprets the signs of the sizes by the edition of LM-63: before 1995, of 1995, since 2002.
 * Returns false if they mean no shape. Adds a warning to text if a shape is approximated. */
static bool read_shape(const struct orl_ies *ies, struct orl_text *text,
                       struct luminaire_shape *ret)
{
    const double l = fabs(ies->length), w = fabs(ies->width), h = fabs(ies->height);
    const int signs = 100 * sign_of(ies->length) + 10 * sign_of(ies->width) + sign_of(ies->height);
    const bool is_1986 = ies->year == 1986, is_1995 = ies->year == 1995;
    switch (signs) {
    case SIGNS(0, 0, 0):
        *ret = (struct luminaire_shape){BODY_BALL, MIN_M, MIN_M, MIN_M};
        return true;
    case SIGNS(1, 1, 0):
    case SIGNS(1, 1, 1):
    case SIGNS(0, 1, 1):
    case SIGNS(1, 0, 1):
        *ret = box(l, w, h);
        return true;
    case SIGNS(0, -1, 0):
        *ret = disc(w, h);
        return true;
    case SIGNS(0, -1, 1):
        *ret = disc(w, h);
        return is_1986 || is_1995;
    case SIGNS(0, -1, -1):
        *ret = (struct luminaire_shape){BODY_BALL, w, w, w};
        return is_1995;
    case SIGNS(-1, -1, 0):
    case SIGNS(-1, -1, 1):
        *ret = fabs(l - w) < tiny ? disc(w, h) : ellipse(w, l, h, text);
        return !is_1986 && !is_1995;
    case SIGNS(1, -1, 0):
        *ret = ellipse(l, w, 0, text);
        return is_1986;
    case SIGNS(-1, -1, -1):
        *ret = (struct luminaire_shape){BODY_BALL, w, w, w};
        if (fabs(l - w) < tiny && fabs(l - h) < tiny)
            return true;
        break;
    case SIGNS(-1, 1, 1):
    case SIGNS(1, -1, 1):
        *ret = ellipse(l, w, h, text);
        if (is_1995)
            return true;
        break;
    default:
        break;
    }
    orl_text_warn(text,
                  "its opening is a horizontal cylinder or an ellipsoid: it is simulated as a box");
    *ret = box(l, w, h);
    return l > 0 || w > 0;
}

struct luminaire {
    const char *file; /* name usable in scene text */
    char name[128];
    double factor, color[3], illum_radius;
    double unit; /* the scene's units in a metre */
    /* table of lamps; the lamp to use always; the lamp to use if the file names no known one; or
     * NULL */
    const char *table, *type, *otherwise;
};

/* ---- Scene text ------------------------------------------------------------------------------ */

static void add_rectangle(const struct luminaire *lamp, const struct luminaire_shape *s,
                          const char *suffix, const int corners[4], struct orl_text *text)
{
    orl_text_add(text, "'%s_light' polygon '%s.%s'\n0\n0\n12\n", lamp->name, lamp->name, suffix);
    for (int i = 0; i < 4; i++)
        orl_text_add(text, "\t%g\t%g\t%g\n", (corners[i] & 1 ? .5 : -.5) * s->length * lamp->unit,
                     (corners[i] & 2 ? .5 : -.5) * s->width * lamp->unit,
                     (corners[i] & 4 ? .5 : -.5) * s->height * lamp->unit);
}

static void add_disc(const struct luminaire *lamp, const struct luminaire_shape *s, int side,
                     struct orl_text *text)
{
    orl_text_add(text, "'%s_light' ring '%s.%s'\n0\n0\n8 0 0 %g 0 0 %d 0 %g\n", lamp->name,
                 lamp->name, side > 0 ? "u" : "d", side * .5 * s->height * lamp->unit, side,
                 .5 * s->width * lamp->unit);
}

struct faces {
    bool lower, upper, sides;
};

static void add_body(const struct luminaire *lamp, const struct luminaire_shape *s,
                     const struct faces *faces, struct orl_text *text)
{
    static const int down[4] = {0, 2, 3, 1}, up[4] = {4, 5, 7, 6},
                     sides[4][4] = {{0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
    static const char *const names[4] = {"1", "2", "3", "4"};
    if (s->body == BODY_BALL) {
        orl_text_add(text, "'%s_light' sphere '%s.s'\n0\n0\n4 0 0 0 %g\n", lamp->name, lamp->name,
                     .5 * s->width * lamp->unit);
        return;
    }
    if (faces->lower && s->body == BODY_BOX)
        add_rectangle(lamp, s, "d", down, text);
    if (faces->upper && s->body == BODY_BOX)
        add_rectangle(lamp, s, "u", up, text);
    for (int i = 0; i < 4 && faces->sides && s->body == BODY_BOX; i++)
        add_rectangle(lamp, s, names[i], sides[i], text);
    if (faces->lower && s->body == BODY_DISC)
        add_disc(lamp, s, -1, text);
    if (faces->upper && s->body == BODY_DISC)
        add_disc(lamp, s, 1, text);
    if (faces->sides && s->body == BODY_DISC)
        orl_text_add(text, "'%s_light' cylinder '%s.c'\n0\n0\n7 0 0 %g 0 0 %g %g\n", lamp->name,
                     lamp->name, .5 * s->height * lamp->unit, -.5 * s->height * lamp->unit,
                     .5 * s->width * lamp->unit);
}

/* Returns the functions of angle for looking up the file's data, and the rotation applied
 * before. */
static void name_angles(const struct orl_ies *ies, const char **ret_angles, const char **ret_turn)
{
    const double first = ies->horizontal[0], last = ies->horizontal[ies->n_horizontal - 1];
    const bool half_turn =
        ies->n_horizontal > 1 && !ies->type_b && fabs(first - 90) < tiny && fabs(last - 270) < tiny;
    *ret_turn = half_turn ? " -rz -90" : "";
    if (ies->type_b)
        *ret_angles = fabs(first) < tiny ? "srcB_horiz2 srcB_vert" : "srcB_horiz srcB_vert";
    else if (ies->n_horizontal < 2)
        *ret_angles = "src_theta";
    else if (last - first <= 90 + tiny)
        *ret_angles = "src_phi4 src_theta";
    else if (last - first <= 180 + tiny)
        *ret_angles = fabs(first - 90) < tiny ? "src_phi2+90 src_theta" : "src_phi2 src_theta";
    else
        *ret_angles = "src_phi src_theta";
}

/* Adds the tilt factor by the luminaire's angle, piecewise linear. */
static void add_tilt(const struct luminaire *lamp, const struct orl_ies_tilt *tilt,
                     struct orl_text *text)
{
    const bool all_round = tilt->angles[tilt->n - 1] > 90 + tiny;
    const char *const angle = all_round ? "Acos(Kz)/DEGREE" : "tri(Acos(Kz)/DEGREE,90)";
    orl_text_add(text, "void brightfunc '%s_tilt'\n2 %g", lamp->name, tilt->factors[0]);
    for (uint32_t i = 0; i + 1 < tilt->n; i++)
        orl_text_add(text, "+(%g)*bound(0,(%s-(%g))/%g,1)", tilt->factors[i + 1] - tilt->factors[i],
                     angle, tilt->angles[i], tilt->angles[i + 1] - tilt->angles[i]);
    orl_text_add(text, " .\n0\n0\n");
}

static void add_distribution(const struct luminaire *lamp, const struct orl_ies *ies,
                             const struct luminaire_shape *s, bool sides, struct orl_text *text)
{
    const double factor = lamp->factor * ies->factor;
    const double area = s->body == BODY_BOX ? s->width * s->length : M_PI / 4 * s->width * s->width;
    const char *angles, *turn;
    name_angles(ies, &angles, &turn);
    const bool flat = s->body == BODY_BALL || !sides;
    const int n = 3 + (strchr(angles, ' ') ? 2 : 1) + (*turn ? 2 : 0);
    if (ies->tilt.n > 0)
        orl_text_add(text, "'%s_tilt'", lamp->name);
    else
        orl_text_add(text, "void");
    orl_text_add(text, " brightdata '%s_dist'\n%d %s '%s' source.cal %s%s\n0\n", lamp->name, n,
                 s->body == BODY_BALL   ? "corr"
                 : !sides               ? "flatcorr"
                 : s->body == BODY_DISC ? "cylcorr"
                                        : "boxcorr",
                 lamp->file, angles, turn);
    if (flat)
        orl_text_add(text, "1 %g\n", factor / area);
    else if (s->body == BODY_DISC)
        orl_text_add(text, "3 %g %g %g\n", factor, s->width, s->height);
    else
        orl_text_add(text, "4 %g %g %g %g\n", factor, s->length, s->width, s->height);
}

/* Warns if the angles cover less than LM-63 requires. */
static void warn_of_angles(const struct orl_ies *ies, struct orl_text *text)
{
    const double first = ies->horizontal[0], last = ies->horizontal[ies->n_horizontal - 1];
    if (!orl_ies_is_complete(ies))
        orl_text_warn(
            text, "its vertical angles are from %g to %g degrees: it emits no light beyond these",
            ies->vertical[0], ies->vertical[ies->n_vertical - 1]);
    if (!orl_ies_has_all_planes(ies))
        orl_text_warn(text, "its horizontal angles are from %g to %g degrees: beyond these %s",
                      first, last,
                      ies->type_b          ? "it emits no light"
                      : last - first > 180 ? "it is interpolated towards the first angle"
                                           : "it emits as at the last angle");
}

/* Writes the whole luminaire except its geometry, around which it is an illum. */
static int add_luminaire(const struct luminaire *lamp, const struct orl_ies *ies, bool geometry,
                         struct orl_text *text, struct luminaire_shape *ret_shape,
                         struct orl_error *err)
{
    const double size = 2 * lamp->illum_radius / lamp->unit;
    struct luminaire_shape shape = {BODY_BALL, size, size, size};
    if (!(lamp->illum_radius > 0) && !read_shape(ies, text, &shape))
        return orl_error_set(err, ORL_ERR_RANGE, "its sizes do not define a shape of LM-63");
    if (lamp->illum_radius > 0 && size < MIN_M)
        return orl_error_set(err, ORL_ERR_RANGE, "ies2rad: the radius of -i is too small");
    struct faces faces = {
        .lower =
            ies->vertical[0]<90 - tiny, .upper = ies->vertical[ies->n_vertical - 1]> 90 + tiny};
    faces.sides = faces.lower && faces.upper && shape.height > MIN_M;
    warn_of_angles(ies, text);
    if (ies->tilt.n > 0)
        add_tilt(lamp, &ies->tilt, text);
    add_distribution(lamp, ies, &shape, faces.sides, text);
    orl_text_add(text, "'%s_dist' %s '%s_light'\n0\n0\n3 %g %g %g\n", lamp->name,
                 geometry || lamp->illum_radius > 0 ? "illum" : "light", lamp->name, lamp->color[0],
                 lamp->color[1], lamp->color[2]);
    add_body(lamp, &shape, &faces, text);
    *ret_shape = shape;
    return 0;
}

/* Adds the luminaire's geometry from its MGF file, in metres. Its lamps glow only within the size
 * of the opening: the emitted light is the measured one. scope: of the IES file. */
static int add_geometry(const struct luminaire *lamp, const struct orl_ies *ies,
                        const struct luminaire_shape *shape, struct orl_parser *parser,
                        const struct orl_scope *scope, struct orl_text *text, struct orl_error *err)
{
    const double size = sqrt(shape->width * shape->width + shape->height * shape->height +
                             shape->length * shape->length);
    const struct orl_mgf mgf = {.unit_m = lamp->unit,
                                .glow_radius = size * lamp->unit,
                                .emission = lamp->factor * ies->factor};
    return orl_parser_mgf(parser, scope, ies->geometry, &mgf, text, err);
}

/* ---- Lamps ----------------------------------------------------------------------------------- */

static const char usual_table[] = "lamp.tab", no_lamp[] = "default";

static void take_lamp(struct luminaire *lamp, const struct orl_lamp_entry *known,
                      struct orl_text *text)
{
    lamp->color[0] = known->color.r;
    lamp->color[1] = known->color.g;
    lamp->color[2] = known->color.b;
    orl_text_warn(text, "by %.80s its lamp gives %g of its initial light, with CIE x %g y %g",
                  lamp->table, known->share, known->x, known->y);
}

/* Looks up the lamp that a command names. Returns 1 if known. */
static int find_named(struct luminaire *lamp, struct orl_lamp_table *table, const char *words,
                      struct orl_text *text, struct orl_error *err)
{
    struct orl_lamp_entry known;
    const int code = orl_lamp_find(table, words, strlen(words), &known, err);
    if (code > 0)
        take_lamp(lamp, &known, text);
    else if (code == 0)
        orl_text_warn(text, "%.80s has no lamp '%.80s'", lamp->table, words);
    return code;
}

/* Looks up the lamp that the file names. Returns 1 if known. */
static int find_in_file(struct luminaire *lamp, struct orl_lamp_table *table,
                        const struct orl_file *file, struct orl_text *text, struct orl_error *err)
{
    struct orl_lamp_entry known;
    const char *at = file->data, *words;
    size_t length;
    int code = 0;
    while (code == 0 && orl_ies_next_lamp(&at, file->data, file->size, &words, &length))
        code = orl_lamp_find(table, words, length, &known, err);
    if (code > 0)
        take_lamp(lamp, &known, text);
    return code;
}

/* Sets the colour of its lamp from the table, as ies2rad does; without a table the given colour
 * stays. */
static int apply_lamp_table(struct luminaire *lamp, struct orl_parser *parser, const char *folder,
                            const struct orl_file *file, struct orl_text *text,
                            struct orl_error *err)
{
    const bool is_default = lamp->type && strcmp(lamp->type, no_lamp) == 0;
    struct orl_error missing = {0};
    size_t index = 0;
    int found = 0;
    if (is_default && !lamp->otherwise)
        return 0;
    const int code = orl_sources_find(&parser->sources, folder, lamp->table, &index, &missing);
    if (code == ORL_ERR_NOT_FOUND && strcmp(lamp->table, usual_table) == 0) {
        if (lamp->type || lamp->otherwise)
            orl_text_warn(text, "its lamp cannot be looked up: there is no %s", usual_table);
        return 0;
    }
    if (code < 0) {
        *err = missing;
        return code;
    }
    const struct orl_source *const source = &parser->sources.items[index];
    struct orl_lamp_table table = {source->name, source->file.data, source->file.size,
                                   ORL_LAMP_STEPS};
    parser->text_bytes += source->file.size;
    if (!is_default)
        found = lamp->type ? find_named(lamp, &table, lamp->type, text, err)
                           : find_in_file(lamp, &table, file, text, err);
    if (found == 0 && lamp->otherwise)
        found = find_named(lamp, &table, lamp->otherwise, text, err);
    return found < 0 ? found : 0;
}

/* ---- A file ---------------------------------------------------------------------------------- */

/* Reads the file that TILT= names, next to the IES file. */
static int read_tilt_file(struct orl_parser *parser, const char *folder, struct orl_ies *ies,
                          struct orl_error *err)
{
    size_t index = 0;
    if (ies->tilt_file[0] == '\0')
        return 0;
    const int code = orl_sources_find(&parser->sources, folder, ies->tilt_file, &index, err);
    if (code < 0)
        return code;
    const struct orl_source *const source = &parser->sources.items[index];
    return orl_ies_read_tilt(source->name, source->file.data, source->file.size, ies, err);
}

/* Tests whether its geometry file exists; without it the luminaire still emits. */
static int find_geometry(struct orl_parser *parser, const char *folder, const struct orl_ies *ies,
                         struct orl_text *text, bool *ret_found, struct orl_error *err)
{
    struct orl_error missing = {0};
    size_t index = 0;
    *ret_found = false;
    if (ies->geometry[0] == '\0')
        return 0;
    const int code = orl_sources_find(&parser->sources, folder, ies->geometry, &index, &missing);
    *ret_found = code == 0;
    if (code == ORL_ERR_NOT_FOUND)
        orl_text_warn(text, "its geometry, %.80s, is missing: it is simulated without",
                      ies->geometry);
    else if (code < 0)
        *err = missing;
    return code == ORL_ERR_NOT_FOUND ? 0 : code;
}

/* folder: of the text that names the file. */
static int write_luminaire(struct luminaire *lamp, struct orl_parser *parser, const char *folder,
                           const char *resolved, const struct orl_file *file, struct orl_text *text,
                           struct orl_error *err)
{
    const char *const slash = strrchr(resolved, '/');
    char beside[512];
    const struct orl_scope scope = {.file = resolved, .folder = beside};
    struct orl_ies ies;
    struct luminaire_shape shape = {.body = BODY_BALL};
    bool geometry = false;
    if (snprintf(beside, sizeof beside, "%.*s", slash ? (int)(slash - resolved) : 0, resolved) >=
        (int)sizeof beside)
        return orl_error_set(err, ORL_ERR_LIMIT, "its folder's name is too long");
    int code = orl_ies_read(resolved, file->data, file->size, &ies, err);
    if (code < 0)
        return code;
    code = apply_lamp_table(lamp, parser, folder, file, text, err);
    if (code == 0)
        code = read_tilt_file(parser, beside, &ies, err);
    if (code == 0)
        code = find_geometry(parser, beside, &ies, text, &geometry, err);
    if (code == 0)
        code = add_luminaire(lamp, &ies, geometry, text, &shape, err);
    if (code == 0 && geometry)
        code = add_geometry(lamp, &ies, &shape, parser, &scope, text, err);
    orl_ies_done(&ies);
    if (code < 0 && err->file[0] == '\0')
        orl_error_at(err, resolved, 0, NULL);
    return code;
}

/* ---- Words ----------------------------------------------------------------------------------- */

static int name_lamp(struct luminaire *lamp, const char *file, struct orl_error *err)
{
    const char *const base = basename(file), *const dot = strrchr(base, '.');
    if (strchr(file, '\''))
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "the name of a luminaire's file must not contain '");
    snprintf(lamp->name, sizeof lamp->name, "%.*s", dot && dot > base ? (int)(dot - base) : 100,
             base);
    lamp->file = file;
    return 0;
}

/* "-dUNIT[/N]". */
static int read_unit(const char *option, double *ret_unit, struct orl_error *err)
{
    static const struct {
        char letter;
        double a_metre;
    } units[] = {{'m', 1}, {'c', 100}, {'i', 1 / .0254}, {'f', 1 / .3048}};
    double by = 1;
    const bool plain = option[2] && option[3] == '\0';
    const bool divided = option[2] && option[3] == '/' &&
                         orl_number_read(option + 4, strlen(option + 4), &by) == ORL_NUMBER_OK &&
                         by > 0 && by < 1e6;
    for (size_t i = 0; i < 4 && (plain || divided); i++)
        if (units[i].letter == option[2]) {
            *ret_unit = units[i].a_metre * by;
            return 0;
        }
    return orl_error_set(err, ORL_ERR_SYNTAX,
                         "ies2rad: '%.40s' is not a unit: use -dm, -dc, -di or -df, optionally "
                         "divided as in -dm/1000",
                         option);
}

/* Reads options with one word; -o, -p and -l name output files, which are not written. */
static bool read_word(const char *option, const char *word, struct luminaire *lamp)
{
    const char **const place = strcmp(option, "-f") == 0   ? &lamp->table
                               : strcmp(option, "-t") == 0 ? &lamp->type
                               : strcmp(option, "-u") == 0 ? &lamp->otherwise
                                                           : NULL;
    if (place)
        *place = word;
    return place || strcmp(option, "-o") == 0 || strcmp(option, "-p") == 0 ||
           strcmp(option, "-l") == 0;
}

static int read_option(struct orl_words *words, struct luminaire *lamp, struct orl_error *err)
{
    const char *const option = orl_words_take(words);
    int code = 0;
    if (strncmp(option, "-d", 2) == 0)
        return read_unit(option, &lamp->unit, err);
    if (strcmp(option, "-s") == 0)
        return 0;
    if (strcmp(option, "-m") == 0)
        code = orl_words_number(words, option, &lamp->factor, err);
    else if (strcmp(option, "-i") == 0)
        code = orl_words_number(words, option, &lamp->illum_radius, err);
    else if (strcmp(option, "-c") == 0)
        for (int i = 0; i < 3 && code == 0; i++)
            code = orl_words_number(words, option, &lamp->color[i], err);
    else if (words->left > 0 && read_word(option, words->at[0], lamp))
        orl_words_take(words);
    else
        code = orl_error_set(err, ORL_ERR_UNSUPPORTED, "ies2rad: '%.40s' is not supported", option);
    if (code == 0 && !(lamp->factor >= 0 && lamp->illum_radius >= 0 && lamp->color[0] >= 0 &&
                       lamp->color[1] >= 0 && lamp->color[2] >= 0))
        code = orl_error_set(err, ORL_ERR_RANGE, "ies2rad: numbers must not be negative");
    return code;
}

static const struct luminaire usual = {
    .factor = 1, .color = {1, 1, 1}, .unit = 1, .table = usual_table};

int orl_parser_ies2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err)
{
    struct orl_words left = {.program = "ies2rad", .at = words + 1, .left = count - 1};
    struct luminaire lamp = usual;
    size_t index = 0;
    int code = 0;
    while (code == 0 && left.left > 0 && left.at[0][0] == '-')
        code = read_option(&left, &lamp, err);
    if (code == 0 && left.left != 1)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "ies2rad takes exactly one file");
    if (code == 0)
        code = name_lamp(&lamp, left.at[0], err);
    if (code == 0)
        code = orl_sources_find(&parser->sources, scope->folder, lamp.file, &index, err);
    if (code < 0)
        return code;
    const struct orl_source source = parser->sources.items[index];
    return write_luminaire(&lamp, parser, scope->folder, source.name, &source.file, text, err);
}

int orl_luminaire_write(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_file *file, struct orl_text *text, struct orl_error *err)
{
    struct luminaire lamp = usual;
    int code = name_lamp(&lamp, basename(scope->file), err);
    if (code == 0)
        code = write_luminaire(&lamp, parser, scope->folder, scope->file, file, text, err);
    if (code == 0 && text->failed)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return code;
}
