#include "scene/generate/solid/solids.h"

#include <string.h>

int orl_words_name(struct orl_words *words, const char *option, const char **ret_name,
                   struct orl_error *err)
{
    const char *name = words->left > 0 ? words->at[0] : "";
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: a name is missing for %.40s", words->program,
                             option);
    if (*name == '\0' || strchr(name, '\''))
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' is no name for %.40s",
                             words->program, name, option);
    words->at++, words->left--;
    *ret_name = name;
    return 0;
}

void orl_text_add_head(struct orl_text *text, const char *material, const char *type,
                       const char *name, const char *part, size_t n_reals)
{
    orl_text_add(text, "'%s' %s '%s.%s'\n0\n0\n%zu", material, type, name, part, n_reals);
}

void orl_text_add_point(struct orl_text *text, struct orl_vec3 point)
{
    orl_text_add(text, "\n %.12g %.12g %.12g", point.x, point.y, point.z);
}

void orl_text_add_sphere(struct orl_text *text, const char *material, const char *name,
                         const char *part, struct orl_vec3 center, double radius)
{
    orl_text_add_head(text, material, "sphere", name, part, 4);
    orl_text_add_point(text, center);
    orl_text_add(text, " %.12g\n", radius);
}

void orl_text_add_cylinder(struct orl_text *text, const char *material, const char *name,
                           const char *part, struct orl_vec3 from, struct orl_vec3 to,
                           double radius)
{
    orl_text_add_head(text, material, "cylinder", name, part, 7);
    orl_text_add_point(text, from);
    orl_text_add_point(text, to);
    orl_text_add(text, " %.12g\n", radius);
}
