/*
 * The generators of solids and curved surfaces that scene files call. Each reads the words of its
 * command (words[0] is its name) and writes the scene text of Radiance's program of that name. The
 * printed digits and the names of surfaces are equal. genbox -o and -s are refused.
 *
 * Units are the scene's. Errors: as in generate.h, and ORL_ERR_LIMIT for solids with too many
 * surfaces. References: genbox(1), genprism(1), genblinds(1), genclock(1), genrev(1), genworm(1)
 * and gensurf(1) of Radiance, and the output of these programs.
 */
#ifndef ORL_SCENE_GENERATE_SOLID_SOLIDS_H
#define ORL_SCENE_GENERATE_SOLID_SOLIDS_H

#include "function/function.h"
#include "scene/generate/generate.h"

/* Access to the files that the words of generators name. */
struct orl_generator_files {
    void *ctx;
    /* Reads a text into an owned string. */
    int (*read)(void *ctx, const char *name, char **ret_text, struct orl_error *err);
};

/* A box with sharp, bevelled (-b) or round (-r) edges, inverted (-i), in segments (-n). */
int orl_genbox(const char *const *words, size_t count, struct orl_text *text,
               struct orl_error *err);

/* An outline from the words or a file, extruded (-l), open (-c), without ends (-e), round (-r). */
int orl_genprism(const char *const *words, size_t count, const struct orl_generator_files *files,
                 struct orl_text *text, struct orl_error *err);

/* Slats, flat or bent up (+r) or down (-r). */
int orl_genblinds(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err);

/* A clock and its materials. */
int orl_genclock(const char *const *words, size_t count, struct orl_text *text,
                 struct orl_error *err);

/* A branch of a fir tree, of cones and spheres. */
int orl_genbranch(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err);

/* A surface of revolution about the z axis: "z(t)" "r(t)" segments; smooth (-s). */
int orl_genrev(const char *const *words, size_t count, const struct orl_generator_files *files,
               struct orl_text *text, struct orl_error *err);

/* A tube along a curve: "x(t)" "y(t)" "z(t)" "r(t)" segments. */
int orl_genworm(const char *const *words, size_t count, const struct orl_generator_files *files,
                struct orl_text *text, struct orl_error *err);

/* A surface: "x(s,t)" "y(s,t)" "z(s,t)", or files of numbers, and the number of cells along s and
 * t; smooth (-s), inverted (-i), as an OBJ file (-o). If valid(s,t) is defined, it selects the
 * vertices. */
int orl_gensurf(const char *const *words, size_t count, const struct orl_generator_files *files,
                struct orl_text *text, struct orl_error *err);

/* ---- Shared ---------------------------------------------------------------------------------- */

/* Reads a word that becomes a name in the text: of a material, or a prefix of surface names. */
int orl_words_name(struct orl_words *words, const char *option, const char **ret_name,
                   struct orl_error *err);
/* Reads the names of the material and of the thing that a command makes, such as "the box". */
int orl_words_names(struct orl_words *words, const char *thing, const char **ret_material,
                    const char **ret_name, struct orl_error *err);

/* Adds "'material' type 'name.part'", and the counts; n_reals numbers must follow. */
void orl_text_add_head(struct orl_text *text, const char *material, const char *type,
                       const char *name, const char *part, size_t n_reals);
/* Adds a point with the digits that Radiance's generators print. */
void orl_text_add_point(struct orl_text *text, struct orl_vec3 point);
void orl_text_add_polygon(struct orl_text *text, const char *material, const char *name,
                          const char *part, const struct orl_vec3 *corners, size_t n);
void orl_text_add_sphere(struct orl_text *text, const char *material, const char *name,
                         const char *part, struct orl_vec3 center, double radius);
void orl_text_add_cylinder(struct orl_text *text, const char *material, const char *name,
                           const char *part, struct orl_vec3 from, struct orl_vec3 to,
                           double radius);

/*
 * Shared by genrev, genworm and gensurf: definitions in the command (-e) and in files (-f), in
 * Radiance's function language (function/function.h), and expressions that use them.
 */

struct orl_generator_expressions {
    struct orl_functions *functions;
    struct orl_function *function; /* all expressions, once compiled; owned */
    struct orl_function_scratch *scratch;
    size_t n;
};

/* Starts with named inputs. Requires orl_expressions_done in every case. */
int orl_expressions_begin(struct orl_generator_expressions *expressions, const char *const *inputs,
                          size_t n_inputs, struct orl_error *err);
void orl_expressions_done(struct orl_generator_expressions *expressions);

/* Handles an option -e or -f, which is the last word read; fails for other options. */
int orl_expressions_define(struct orl_generator_expressions *expressions, const char *option,
                           struct orl_words *words, const struct orl_generator_files *files,
                           struct orl_error *err);

/* Reads a word that is a number or an expression, rounded, 1 to most. what: the counted thing, for
 * messages. */
int orl_expressions_count(struct orl_generator_expressions *expressions, const char *word,
                          const char *what, const char *program, int most, int *ret_count,
                          struct orl_error *err);

/* Compiles expressions for evaluation at up to `places` places, which share the limit of steps of a
 * command. */
int orl_expressions_compile(struct orl_generator_expressions *expressions, const char *const *texts,
                            size_t n, size_t places, struct orl_error *err);

/* Returns the values at one place; ORL_ERR_RANGE unless all are finite. */
int orl_expressions_at(const struct orl_generator_expressions *expressions, const double *inputs,
                       double *ret_values, struct orl_error *err);

#endif
