#include "metrics/worst_direction.h"

static const double enough = 0.98;

/* Evaluates one line of sight; *ret_held is true if the picture covers enough of the field of view
 * there. */
static int evaluate_direction(const struct orl_glare_picture *p,
                              const struct orl_glare_settings *settings, double turned_deg,
                              double least_sr, struct orl_glare *ret_glare, bool *ret_covered,
                              struct orl_error *err)
{
    struct orl_view_field field;
    int code = orl_view_field_init(&field, p->view, p->width, p->height, turned_deg, err);
    const struct orl_luminances luminances = {&field, p->cd_m2, p->cancel};
    *ret_covered = field.all_sr >= least_sr;
    if (code == 0 && *ret_covered)
        code = orl_glare_evaluate(&luminances, p->mask, settings, ret_glare, err);
    ret_glare->turned_deg = turned_deg;
    orl_view_field_done(&field);
    return code;
}

int orl_glare_worst_direction(const struct orl_glare_picture *glare_picture,
                              const struct orl_glare_settings *settings,
                              struct orl_glare *ret_glare, struct orl_error *err)
{
    struct orl_glare worst = {0};
    bool covered;
    int code = evaluate_direction(glare_picture, settings, 0, 0, &worst, &covered, err);
    const double least_sr = enough * worst.field_sr;
    for (uint32_t i = 0; i < settings->directions && code == 0; i++) {
        const double turned = orl_glare_rotation_deg(settings, i);
        struct orl_glare glare = {0};
        code = evaluate_direction(glare_picture, settings, turned, least_sr, &glare, &covered, err);
        if (code == 0 && covered &&
            glare.values[ORL_GLARE_DGP].value > worst.values[ORL_GLARE_DGP].value) {
            orl_glare_done(&worst);
            worst = glare;
        } else {
            orl_glare_done(&glare);
        }
    }
    if (code == 0)
        *ret_glare = worst;
    else
        orl_glare_done(&worst);
    return code;
}
