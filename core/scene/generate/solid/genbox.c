#include "scene/generate/solid/genbox.h"

#include <string.h>

static const char sharp[6][5] = {"1540", "4620", "2310", "3267", "5137", "6457"};
static const char bevels[12][5] = {"NdcM", "kmOM", "cgok", "QSqo", "TjiS", "emqi",
                                   "efPO", "jrnf", "lNPn", "prTR", "hdlp", "QghR"};
static const char corners[8][4] = {"Mck", "dNl", "Ome", "ogQ", "Siq", "pRh", "fnP", "Trj"};

static void add_face(struct orl_text *text, const struct orl_genbox *box, const char *face)
{
    orl_text_add_head(text, box->material, "polygon", box->name, face, 3 * strlen(face));
    for (; *face; face++)
        orl_text_add_point(text, orl_box_corner(box, *face));
    orl_text_add(text, "\n");
}

static void add_box(struct orl_text *text, const struct orl_genbox *box)
{
    for (size_t i = 0; i < 6; i++)
        add_face(text, box, box->bevel > 0 ? orl_box_inset[i] : sharp[i]);
    for (size_t i = 0; i < 12 && box->bevel > 0; i++)
        if (box->rounded)
            orl_text_add_cylinder(text, box->material, box->name, orl_box_edges[i],
                                  orl_box_corner(box, orl_box_edges[i][0]),
                                  orl_box_corner(box, orl_box_edges[i][1]), box->bevel);
        else
            add_face(text, box, bevels[i]);
    for (size_t i = 0; i < 8 && box->bevel > 0; i++)
        if (box->rounded)
            orl_text_add_sphere(text, box->material, box->name, orl_box_ends[i],
                                orl_box_corner(box, orl_box_ends[i][0]), box->bevel);
        else
            add_face(text, box, corners[i]);
}

static int refuse_option(const char *option, const char *hint, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_UNSUPPORTED, "genbox: option '%s' is not supported", option);
    orl_error_hint(err, "%s", hint);
    return ORL_ERR_UNSUPPORTED;
}

static int read_option(struct orl_words *words, struct orl_genbox *box, int *segments,
                       struct orl_error *err)
{
    const char *option = *words->at++;
    int code = 0;
    words->left--;
    if (strcmp(option, "-i") == 0) {
        box->inverted = true;
    } else if (strcmp(option, "-b") == 0 || strcmp(option, "-r") == 0) {
        box->rounded = box->rounded || option[1] == 'r';
        code = orl_words_number(words, option, &box->bevel, err);
        if (code == 0 && box->bevel <= 0)
            code = orl_error_set(err, ORL_ERR_RANGE, "genbox: %s %g is not positive", option,
                                 box->bevel);
    } else if (strcmp(option, "-n") == 0) {
        enum { SEGMENTS_MAX = 256 };
        code = orl_words_int(words, option, 1, SEGMENTS_MAX, segments, err);
    } else if (strcmp(option, "-o") == 0) {
        code = refuse_option(option, "it writes no scene text, but an OBJ file: leave it out", err);
    } else if (strcmp(option, "-s") == 0) {
        code = refuse_option(option,
                             "leave it out: normals do not vary over a polygon, and more segments "
                             "(-n) are as smooth",
                             err);
    } else {
        code = orl_error_set(err, ORL_ERR_SYNTAX, "genbox: '%.40s' is no option", option);
    }
    return code;
}

static int read_size(struct orl_words *words, double size[3], struct orl_error *err)
{
    int code = 0;
    for (int axis = 0; axis < 3 && code == 0; axis++) {
        code = orl_words_number(words, "a size", size + axis, err);
        if (code == 0 && size[axis] <= 0)
            code = orl_error_set(err, ORL_ERR_RANGE, "genbox: size %g is not positive", size[axis]);
    }
    return code;
}

int orl_genbox(const char *const *words, size_t count, struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"genbox", words + 1, count - 1};
    struct orl_genbox box = {0};
    int segments = 1, code;
    if (count < 6)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "genbox needs a material, a name and three sizes");
    code = orl_words_name(&rest, "the material", &box.material, err);
    if (code == 0)
        code = orl_words_name(&rest, "the box", &box.name, err);
    if (code == 0)
        code = read_size(&rest, box.size, err);
    while (code == 0 && rest.left > 0)
        code = read_option(&rest, &box, &segments, err);
    if (code < 0)
        return code;
    /* Cylinders and spheres look right from outside only; from inside they would be in the way. */
    if (box.inverted && segments == 1)
        segments = 32;
    while (box.rounded && (1 << box.level) < segments)
        box.level++;
    if (box.level > 1)
        return orl_genbox_pieces(&box, text, err);
    add_box(text, &box);
    return 0;
}
