#include "render/film/film.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

/* Copies the next word of the options to word, NUL-terminated. Returns the position after it, or
 * NULL at the end. */
static const char *next_word(const char *text, char *word, size_t size)
{
    size_t length;
    text += strspn(text, " \t\r\n");
    length = strcspn(text, " \t\r\n");
    if (length == 0)
        return NULL;
    if (length >= size)
        length = size - 1;
    memcpy(word, text, length);
    word[length] = '\0';
    return text + length;
}

static const char *parse_numbers(const char *text, const char *option, double *values, int count,
                                 struct orl_error *err)
{
    char word[64], *end;
    for (int i = 0; i < count; i++) {
        text = next_word(text, word, sizeof word);
        if (!text) {
            orl_error_set(err, ORL_ERR_SYNTAX, "view option %s needs %d number%s", option, count,
                          count > 1 ? "s" : "");
            return NULL;
        }
        values[i] = strtod(word, &end);
        /* A word that fills the buffer was cut, and its number may be another. */
        if (strlen(word) == sizeof word - 1 || *end != '\0' || !isfinite(values[i])) {
            orl_error_set(err, ORL_ERR_SYNTAX, "view option %s: '%s' is not a finite number",
                          option, word);
            if (orl_slice_is_decimal_comma((struct orl_slice){word, strlen(word)}))
                orl_error_hint(err, "this is a decimal comma: write a decimal point");
            return NULL;
        }
    }
    return text;
}

static int set_type(struct orl_view *view, const char *word, struct orl_error *err)
{
    const char type = word[3];
    if (type == '\0' || word[4] != '\0' || !strchr("vlahsc", type)) {
        orl_error_set(err, ORL_ERR_SYNTAX, "view type '%s' is not supported", word);
        orl_error_hint(err, "use -vtv, -vtl, -vta, -vth, -vts or -vtc");
        return err ? err->code : ORL_ERR_SYNTAX;
    }
    view->type = type;
    return 0;
}

/* Rejects sizes that no picture needs and for which rays cannot be computed. */
static int check_sizes(const struct orl_view *view, struct orl_error *err)
{
    /* Tolerance that includes 180 and 360 degrees, for types that allow them. */
    const double closed = 1.0001;
    const double widest = view->type == 'v'   ? 180.0
                          : view->type == 'h' ? 180.0 * closed
                          : view->type == 's' ? 359.9999
                          : view->type == 'l' ? 1e9
                                              : 360.0 * closed;
    const double highest = view->type == 'c' ? 180.0 : widest;
    const double narrowest = 1e-9, most_shift = 1e6;
    const double h = view->horizontal, v = view->vertical;
    if (!(h > narrowest && h < widest && v > narrowest && v < highest))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "view size -vh %g -vv %g is out of range for type %c", h, v,
                             view->type);
    if (fabs(view->shift) > most_shift || fabs(view->lift) > most_shift)
        return orl_error_set(err, ORL_ERR_RANGE, "view shift -vs %g or lift -vl %g is too large",
                             view->shift, view->lift);
    if (!(view->fore <= ORL_LIMIT_DISTANCE))
        return orl_error_set(err, ORL_ERR_RANGE, "the view clipping -vo is too far");
    return 0;
}

/* Sets the image axes from direction, up and the angles, with the checks that Radiance makes
 * too. */
static int set_image_axes(struct orl_view *view, struct orl_error *err)
{
    double h = view->horizontal, v = view->vertical;
    struct orl_vec3 right, above;
    int code = orl_check_point(view->point, "view point -vp", err);
    if (code == 0)
        code = orl_check_direction(view->direction, "view direction -vd", err);
    if (code == 0)
        code = orl_check_direction(view->up, "up vector -vu", err);
    if (code < 0)
        return code;
    view->direction = orl_normalize(view->direction);
    right = orl_cross(view->direction, orl_normalize(view->up));
    if (!(orl_length(right) > 1e-9))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "the view direction -vd and the up vector -vu are parallel");
    code = check_sizes(view, err);
    if (code < 0)
        return code;
    if (view->fore < 0 || (view->aft > 0 && view->aft <= view->fore))
        return orl_error_set(err, ORL_ERR_RANGE, "view clipping -vo and -va are invalid");
    right = orl_normalize(right);
    above = orl_cross(right, view->direction);
    if (view->type == 'v') {
        h = 2.0 * tan(0.5 * h * ORL_DEG_TO_RAD);
        v = 2.0 * tan(0.5 * v * ORL_DEG_TO_RAD);
    } else if (view->type == 'h') {
        h = 2.0 * sin(0.5 * h * ORL_DEG_TO_RAD);
        v = 2.0 * sin(0.5 * v * ORL_DEG_TO_RAD);
    } else if (view->type == 's') {
        h = 2.0 * tan(0.25 * h * ORL_DEG_TO_RAD);
        v = 2.0 * tan(0.25 * v * ORL_DEG_TO_RAD);
    } else if (view->type == 'c') {
        h = 1.0;
        v = 2.0 * tan(0.5 * v * ORL_DEG_TO_RAD);
    } else if (view->type == 'a') {
        h = v = 1.0;
    }
    view->h = orl_scale(right, h);
    view->v = orl_scale(above, v);
    return 0;
}

static const char *parse_option(const char *word, const char *text, struct orl_view *view,
                                struct orl_error *err)
{
    double n[3] = {0, 0, 0};
    static const char options[] = "pduhvslao";
    const char option = word[0] == '-' && word[1] == 'v' && word[2] && !word[3] ? word[2] : '?';
    if (!strchr(options, option)) {
        orl_error_set(err, ORL_ERR_SYNTAX, "'%s' is not a view option", word);
        return NULL;
    }
    text = parse_numbers(text, word, n, strchr("pdu", option) ? 3 : 1, err);
    switch (text ? option : 0) {
    case 'p':
        view->point = orl_v3(n[0], n[1], n[2]);
        break;
    case 'd':
        view->direction = orl_v3(n[0], n[1], n[2]);
        break;
    case 'u':
        view->up = orl_v3(n[0], n[1], n[2]);
        break;
    case 'h':
        view->horizontal = n[0];
        break;
    case 'v':
        view->vertical = n[0];
        break;
    case 's':
        view->shift = n[0];
        break;
    case 'l':
        view->lift = n[0];
        break;
    case 'o':
        view->fore = n[0];
        break;
    case 'a':
        view->aft = n[0];
        break;
    default:
        break;
    }
    return text;
}

/* Parses rpict's -bv, which toggles, -bv+ and -bv-. Returns false for other words. */
static bool parse_backs(const char *word, struct orl_view *view)
{
    if (strncmp(word, "-bv", 3) != 0 || strlen(word) > 4)
        return false;
    if (word[3] == '\0')
        view->backs_unseen = !view->backs_unseen;
    else if (strchr("+1yt", word[3]))
        view->backs_unseen = false;
    else if (strchr("-0nf", word[3]))
        view->backs_unseen = true;
    else
        return false;
    return true;
}

/* Parses rpict's -x -y -pa. */
static const char *parse_size(const char *word, const char *text, struct orl_view *view,
                              struct orl_error *err)
{
    double n = 0;
    text = parse_numbers(text, word, &n, 1, err);
    if (!text)
        return NULL;
    if (word[1] == 'p' && n >= 0 && n <= 1e3) {
        view->pixel_aspect = n;
    } else if (word[1] != 'p' && n >= 1 && n <= ORL_LIMIT_IMAGE_SIDE && n == floor(n)) {
        *(word[1] == 'x' ? &view->x : &view->y) = (uint32_t)n;
    } else {
        orl_error_set(err, ORL_ERR_RANGE, "%s %g is out of range", word, n);
        return NULL;
    }
    return text;
}

int orl_view_parse(const char *text, struct orl_view *ret_view, struct orl_error *err)
{
    struct orl_error local;
    struct orl_view view = {
        .type = 'v', .direction = {0, 1, 0}, .up = {0, 0, 1}, .horizontal = 45, .vertical = 45};
    char word[64];
    int code;
    if (!err)
        err = &local;
    if (strncmp(text, "VIEW=", 5) == 0)
        text += 5;
    for (bool first = true; (text = next_word(text, word, sizeof word)) != NULL; first = false) {
        if (first && (strcmp(word, "rpict") == 0 || strcmp(word, "rvu") == 0 ||
                      strcmp(word, "rview") == 0 || strcmp(word, "VIEW=") == 0))
            continue;
        if (strncmp(word, "-vt", 3) == 0) {
            code = set_type(&view, word, err);
            if (code < 0)
                return code;
            continue;
        }
        if (parse_backs(word, &view))
            continue;
        text = strcmp(word, "-x") == 0 || strcmp(word, "-y") == 0 || strcmp(word, "-pa") == 0
                   ? parse_size(word, text, &view, err)
                   : parse_option(word, text, &view, err);
        if (!text)
            return err->code;
    }
    code = set_image_axes(&view, err);
    if (code == 0)
        *ret_view = view;
    return code;
}

bool orl_view_ray(const struct orl_view *view, double x, double y, struct orl_vec3 *ret_origin,
                  struct orl_vec3 *ret_direction)
{
    struct orl_vec3 d = view->direction, o = view->point;
    double along = 1.0;
    x += view->shift - 0.5;
    y += view->lift - 0.5;
    if (view->type == 'l') {
        o = orl_madd(orl_madd(o, view->h, x), view->v, y);
        *ret_origin = orl_madd(o, d, view->fore);
        *ret_direction = d;
        return true;
    }
    if (view->type == 'h') {
        const double z2 =
            1.0 - x * x * orl_dot(view->h, view->h) - y * y * orl_dot(view->v, view->v);
        if (z2 < 0)
            return false;
        along = sqrt(z2);
    } else if (view->type == 'a') {
        x *= view->horizontal / 180.0;
        y *= view->vertical / 180.0;
        const double radius = sqrt(x * x + y * y);
        if (radius > 1.0)
            return false;
        along = cos(ORL_PI * radius);
        const double s = radius > 1e-12 ? sin(ORL_PI * radius) / radius : ORL_PI;
        x *= s;
        y *= s;
    } else if (view->type == 's') {
        const double square = x * x * orl_dot(view->h, view->h) + y * y * orl_dot(view->v, view->v);
        along = (1.0 - square) / (1.0 + square);
        x *= 1.0 + along;
        y *= 1.0 + along;
    } else if (view->type == 'c') {
        const double angle = x * view->horizontal * ORL_DEG_TO_RAD;
        along = cos(angle);
        x = sin(angle);
    }
    const struct orl_vec3 way = orl_madd(orl_madd(orl_scale(d, along), view->h, x), view->v, y);
    d = orl_normalize(way);
    /* -vo is a plane's distance in perspective, a cylinder's radius in a panorama, a sphere's
     * otherwise. */
    *ret_origin = orl_madd(o, view->type == 'v' || view->type == 'c' ? way : d, view->fore);
    *ret_direction = d;
    return true;
}

double orl_view_clip_distance(const struct orl_view *view, double x, double y)
{
    if (!(view->aft > 0))
        return INFINITY;
    const double depth = view->aft - view->fore;
    x += view->shift - 0.5;
    y += view->lift - 0.5;
    const double upright = y * y * orl_dot(view->v, view->v);
    if (view->type == 'v')
        return depth * sqrt(1 + x * x * orl_dot(view->h, view->h) + upright);
    return view->type == 'c' ? depth * sqrt(1 + upright) : depth;
}

bool orl_view_project(const struct orl_view *view, struct orl_vec3 direction, double *ret_x,
                      double *ret_y)
{
    const double z = orl_dot(direction, view->direction);
    double x = orl_dot(direction, view->h), y = orl_dot(direction, view->v), scale = 1;
    if (!strchr("vha", view->type))
        return false;
    if (view->type == 'a') {
        const double radius = acos(fmax(fmin(z, 1), -1)) / ORL_PI;
        scale = radius > 1e-12 ? radius / sin(ORL_PI * radius) : 1 / ORL_PI;
        x *= 180 / view->horizontal;
        y *= 180 / view->vertical;
    } else {
        if (!(z > 0))
            return false;
        scale = view->type == 'v' ? 1 / z : 1;
        x /= orl_dot(view->h, view->h);
        y /= orl_dot(view->v, view->v);
    }
    if (!isfinite(scale))
        return false;
    *ret_x = x * scale + 0.5 - view->shift;
    *ret_y = y * scale + 0.5 - view->lift;
    return true;
}

double orl_view_solid_angle(const struct orl_view *view, double x, double y, double width,
                            double height)
{
    const double corners[4][2] = {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
    struct orl_vec3 origin, d[4];
    for (int i = 0; i < 4; i++)
        if (!orl_view_ray(view, corners[i][0], corners[i][1], &origin, &d[i]))
            return 0;
    return orl_triangle_sr(d[0], d[1], d[2]) + orl_triangle_sr(d[2], d[3], d[0]);
}

void orl_view_format(const struct orl_view *view, char *ret_text, unsigned long size)
{
    snprintf(ret_text, size,
             "-vt%c -vp %.9g %.9g %.9g -vd %.9g %.9g %.9g -vu %.9g %.9g %.9g -vh %.9g -vv %.9g "
             "-vo %.9g -va %.9g -vs %.9g -vl %.9g",
             view->type, view->point.x, view->point.y, view->point.z, view->direction.x,
             view->direction.y, view->direction.z, view->up.x, view->up.y, view->up.z,
             view->horizontal, view->vertical, view->fore, view->aft, view->shift, view->lift);
}

double orl_view_pixel_aspect(const struct orl_view *view, unsigned width, unsigned height)
{
    const bool by_angle = view->type == 'a';
    const double h = by_angle            ? view->horizontal
                     : view->type == 'c' ? view->horizontal * ORL_DEG_TO_RAD
                                         : orl_length(view->h);
    const double v = by_angle ? view->vertical : orl_length(view->v);
    return (v / height) / (h / width);
}

void orl_view_fit(const struct orl_view *view, double pixel_aspect, uint32_t *width,
                  uint32_t *height)
{
    /* Height over width of the view, which is the aspect of a 1 x 1 image's pixel. */
    const double aspect = orl_view_pixel_aspect(view, 1, 1);
    if (!(pixel_aspect > 0))
        return;
    if (aspect * *width > pixel_aspect * *height)
        *width = (uint32_t)fmax(floor(*height / aspect * pixel_aspect + 0.5), 1);
    else
        *height = (uint32_t)fmax(floor(*width * aspect / pixel_aspect + 0.5), 1);
}
