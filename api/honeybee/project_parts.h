/*
 * What the parts of project.c share: the files of a folder on their way to being a project. Inside
 * of api/honeybee only.
 */
#ifndef ORL_API_HONEYBEE_PROJECT_PARTS_H
#define ORL_API_HONEYBEE_PROJECT_PARTS_H

#include <stdbool.h>

#include "honeybee/project.h"

enum { ORL_PROJECT_NAME = 1024, ORL_PROJECT_INFO_BYTES = 16 << 20 };

struct orl_project_finding {
    const char **names; /* sorted */
    size_t count;
    const struct orl_files *files;
    const struct orl_project_choice *choice;
    const char *root; /* of the model, with its slash; borrowed from a name */
    size_t root_length;
    bool *used;                                                          /* told of */
    bool *is_main;                                                       /* of the scene */
    json_t *main, *grids, *views, *states, *skies, *left_out, *warnings; /* owned */
    struct orl_error *err;
};

int orl_project_no_memory(const struct orl_project_finding *f);
bool orl_project_ends_with(const char *name, const char *ending);
/* The part of a name below a folder of the model's, or NULL. */
const char *orl_project_below(const struct orl_project_finding *f, const char *name,
                              const char *folder);
int orl_project_compare_names(const void *a, const void *b); /* of names[] */
/* The file of that name, and its place; NULL: there is none. */
const char *orl_project_name(const struct orl_project_finding *f, const char *name,
                             size_t *ret_place);
/* A document of bounded size. */
int orl_project_json(const struct orl_project_finding *f, const char *name, json_t **ret_doc);
/* One more file of the scene: once, though several groups may name it. */
int orl_project_add_main(struct orl_project_finding *f, size_t place);

/* project_assets.c */
int orl_project_add_grids(struct orl_project_finding *f);
int orl_project_add_views(struct orl_project_finding *f);
int orl_project_add_skies(struct orl_project_finding *f);
int orl_project_add_warnings(struct orl_project_finding *f);

#endif
