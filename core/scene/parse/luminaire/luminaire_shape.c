#include "scene/parse/luminaire/luminaire_shape.h"

#include <math.h>

static const double tiny = 1e-6;

static struct orl_luminaire_shape box(double length, double width, double height)
{
    return (struct orl_luminaire_shape){ORL_LUMINAIRE_BOX, fmax(length, ORL_LUMINAIRE_MIN_M),
                                        fmax(width, ORL_LUMINAIRE_MIN_M),
                                        fmax(height, ORL_LUMINAIRE_MIN_M / 2)};
}

static struct orl_luminaire_shape disc(double width, double height)
{
    return (struct orl_luminaire_shape){ORL_LUMINAIRE_DISC, width, width,
                                        fmax(height, ORL_LUMINAIRE_MIN_M / 2)};
}

/* Replaces an ellipse by a disc if it is nearly round, else by its bounding box. */
static struct orl_luminaire_shape ellipse(double length, double width, double height,
                                          struct orl_text *text)
{
    const double mean = (length + width) / 2;
    const bool round = fabs(length - mean) < mean / 2;
    orl_text_warn(text, "its opening is an ellipse: it shines as a %s",
                  round ? "circular one" : "box");
    return round ? disc(width, height) : box(width, length, height);
}

static int sign_of(double size)
{
    return size < 0 ? 0 : size == 0 ? 1 : 2;
}

/* Signs of length, width and height, - 0 +, as one number. */
#define SIGNS(l, w, h) (100 * ((l) + 1) + 10 * ((w) + 1) + (h) + 1)

bool orl_luminaire_shape_of(const struct orl_ies *ies, struct orl_text *text,
                            struct orl_luminaire_shape *ret)
{
    const double l = fabs(ies->length), w = fabs(ies->width), h = fabs(ies->height);
    const int signs = 100 * sign_of(ies->length) + 10 * sign_of(ies->width) + sign_of(ies->height);
    const bool is_1986 = ies->year == 1986, is_1995 = ies->year == 1995;
    switch (signs) {
    case SIGNS(0, 0, 0):
        *ret = (struct orl_luminaire_shape){ORL_LUMINAIRE_BALL, ORL_LUMINAIRE_MIN_M,
                                            ORL_LUMINAIRE_MIN_M, ORL_LUMINAIRE_MIN_M};
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
        *ret = (struct orl_luminaire_shape){ORL_LUMINAIRE_BALL, w, w, w};
        return is_1995;
    case SIGNS(-1, -1, 0):
    case SIGNS(-1, -1, 1):
        *ret = fabs(l - w) < tiny ? disc(w, h) : ellipse(w, l, h, text);
        return !is_1986 && !is_1995;
    case SIGNS(1, -1, 0):
        *ret = ellipse(l, w, 0, text);
        return is_1986;
    case SIGNS(-1, -1, -1):
        *ret = (struct orl_luminaire_shape){ORL_LUMINAIRE_BALL, w, w, w};
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
    orl_text_warn(text, "its opening is a lying cylinder or an ellipsoid: it shines as a box");
    *ret = box(l, w, h);
    return l > 0 || w > 0;
}
