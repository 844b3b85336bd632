/* A torus of MGF, as mgf2rad approximates it: ten cones outside, ten cups inside. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/generate/mgf/mgf_context.h"

/* A number printed as a word. */
struct word {
    char text[24];
};

static struct word word_of(double value)
{
    struct word word;
    snprintf(word.text, sizeof word.text, "%.12g", value);
    return word;
}

/* Executes "v name [= template]". */
static int name_vertex(struct orl_mgf_reader *r, const char *name, const char *from)
{
    const char *const words[4] = {"v", name, "=", from};
    memcpy(r->words, words, sizeof words);
    r->n_words = from ? 4 : 2;
    return orl_mgf_context(r, ORL_MGF_VERTEX);
}

/* Moves the current vertex along the centre's normal. */
static void place_vertex(struct orl_mgf_reader *r, const struct orl_mgf_vertex *center,
                         double along)
{
    const struct orl_vec3 n = orl_normalize(center->normal);
    const struct orl_vec3 at = orl_add(center->point, orl_scale(n, along));
    r->current[ORL_MGF_VERTEX]->is.vertex.point =
        orl_v3(strtod(word_of(at.x).text, NULL), strtod(word_of(at.y).text, NULL),
               strtod(word_of(at.z).text, NULL));
}

static int add_cone(struct orl_mgf_reader *r, const struct word *first, const struct word *second)
{
    const char *const words[5] = {"cone", "_tv1", first->text, "_tv2", second->text};
    memcpy(r->words, words, sizeof words);
    r->n_words = 5;
    return orl_mgf_cone(r);
}

/* radii: of the hole and of the whole; both negative if the front is inside. */
static int write_torus(struct orl_mgf_reader *r, const char *name, const double radii[2])
{
    enum { QUARTER = 5 };
    const struct orl_mgf_item *const item = orl_mgf_find(r, ORL_MGF_VERTEX, name);
    if (!item)
        return r->err->code;
    const struct orl_mgf_vertex center = item->is.vertex;
    const double mean = .5 * (radii[0] + radii[1]), half = .5 * (radii[1] - radii[0]);
    if (!(orl_length(center.normal) > 0))
        return orl_mgf_fail(r, ORL_ERR_RANGE, "a torus needs a normal");
    int code = name_vertex(r, "_tv2", name);
    if (code == 0)
        place_vertex(r, &center, fabs(half));
    for (int i = 1; i <= 4 * QUARTER && code == 0; i++) {
        const double before = (i - 1) * M_PI_2 / QUARTER, angle = i * M_PI_2 / QUARTER;
        const double side = i <= 2 * QUARTER ? 1 : -1;
        const struct word radius[2] = {word_of(side * (mean + half * sin(before))),
                                       word_of(side * (mean + half * sin(angle)))};
        code = name_vertex(r, "_tv1", "_tv2");
        if (code == 0)
            code = name_vertex(r, "_tv2", NULL);
        if (code < 0)
            return code;
        place_vertex(r, &center, fabs(half) * cos(angle));
        code = add_cone(r, &radius[0], &radius[1]);
    }
    return code;
}

int orl_mgf_torus(struct orl_mgf_reader *r)
{
    static const double tiny = 1e-6;
    const char *const name = r->words[1];
    double radii[2] = {0, 0};
    int code = orl_mgf_expect_words(r, 3, 3);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = orl_mgf_number(r, 2 + i, &radii[i]);
    if (fabs(radii[0]) <= tiny)
        radii[0] = 0;
    const bool within = radii[0] < 0 || (radii[0] == 0 && radii[1] < 0);
    if (code == 0 && !(within ? radii[1] < radii[0] : radii[1] > radii[0]))
        code =
            orl_mgf_fail(r, ORL_ERR_RANGE, "radii of %g and %g make no torus", radii[0], radii[1]);
    return code == 0 ? write_torus(r, name, radii) : code;
}
