#include "scene/parse/material/material_sums.h"

#include "scene/material/patterns/pattern.h"

struct orl_material orl_material_sum_part(enum orl_material_kind kind, struct orl_rgb color)
{
    return (struct orl_material){
        .kind = kind, .color = color, .seen_as = ORL_SEEN_AS_ITSELF, .sky = -1};
}

static int refuse_directed(struct orl_material_sum *sum)
{
    orl_parser_fail(sum->parser, sum->scope, sum->err, ORL_ERR_UNSUPPORTED,
                    "a pattern of one of its parts depends on the ray's direction (Dx Dy Dz, "
                    "Rdot), which is simulated on what shines only");
    orl_error_hint(sum->err, "write void in its place");
    return ORL_ERR_UNSUPPORTED;
}

int orl_material_sum_add(struct orl_material_sum *sum, const struct orl_material *part)
{
    struct orl_material *const two = orl_arena_alloc(sum->parser->out->arena, 2 * sizeof *two);
    if (part->pattern && part->pattern->directed)
        return refuse_directed(sum);
    if (!two)
        return orl_error_set(sum->err, ORL_ERR_NOMEM, "out of memory");
    if (!sum->any) {
        sum->sum = *part;
        sum->any = true;
        return 0;
    }
    two[0] = sum->sum;
    two[1] = *part;
    sum->sum = (struct orl_material){
        .kind = ORL_MATERIAL_MIXTURE, .seen_as = ORL_SEEN_AS_ITSELF, .sky = -1, .mixed = two};
    return 0;
}

static int add_reflected(struct orl_material_sum *sum, struct orl_rgb color,
                         enum orl_diffuse_side diffuse_side)
{
    struct orl_material part = orl_material_sum_part(ORL_MATERIAL_PLASTIC, color);
    const int code =
        orl_material_check_range(sum->parser, sum->scope, color, true, "diffuse share", sum->err);
    part.pattern = sum->own.pattern;
    part.texture = sum->own.texture;
    part.diffuse_side = diffuse_side;
    return code < 0 || !(orl_rgb_max(color) > 0) ? code : orl_material_sum_add(sum, &part);
}

int orl_material_sum_add_reflected(struct orl_material_sum *sum, struct orl_rgb front,
                                   struct orl_rgb back)
{
    const bool even = front.r == back.r && front.g == back.g && front.b == back.b;
    const int code =
        add_reflected(sum, front, even ? ORL_DIFFUSE_SIDE_BOTH : ORL_DIFFUSE_SIDE_FRONT);
    return code < 0 || even ? code : add_reflected(sum, back, ORL_DIFFUSE_SIDE_BACK);
}

int orl_material_sum_add_through(struct orl_material_sum *sum, struct orl_rgb color,
                                 struct orl_pattern *pattern)
{
    struct orl_material part = orl_material_sum_part(ORL_MATERIAL_TRANS, color);
    const int code =
        orl_material_check_range(sum->parser, sum->scope, color, true, "diffuse share", sum->err);
    part.transmitted = 1;
    part.pattern = pattern;
    return code < 0 || !(orl_rgb_max(color) > 0) ? code : orl_material_sum_add(sum, &part);
}

struct orl_material orl_material_sum_result(const struct orl_material_sum *sum)
{
    return sum->any ? sum->sum : orl_material_sum_part(ORL_MATERIAL_PLASTIC, orl_gray(0));
}
