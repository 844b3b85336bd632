/*
 * Inputs for every reader that can be doubled in size: one row for each rule of the scene grammar,
 * each command and each kind of file. tests/unit/test_doubling.c counts instructions; no test
 * measures time.
 */
#ifndef ORL_TESTS_SUPPORT_DOUBLED_H
#define ORL_TESTS_SUPPORT_DOUBLED_H

#include <stddef.h>
#include <stdio.h>

enum doubled_kind {
    DOUBLED_SCENE, /* scene text, read to a parsed scene */
    DOUBLED_WORLD, /* scene text, checked like an upload: triangles, coincident polygons, Embree */
    DOUBLED_BSDF,
    DOUBLED_SENSORS,
    DOUBLED_WEATHER,
    DOUBLED_VIEWS,
    DOUBLED_JOB,
    DOUBLED_STUDY,
    DOUBLED_YEAR,      /* JSON document of an annual job */
    DOUBLED_PANEL,     /* JSON document of a BSDF job */
    DOUBLED_OCCUPANCY, /* occupancy of a year in minutes */
    DOUBLED_SCHEDULE,  /* schedule of shades */
    DOUBLED_MEASURED,  /* goniophotometer measurements */
    DOUBLED_MATRIX,    /* matrix of annual light */
    DOUBLED_FUNCTION,  /* definitions of x and its dependencies, compiled and evaluated */
    DOUBLED_ZIP,
    DOUBLED_MODEL, /* Honeybee model, translated to files */
    DOUBLED_OBJ,   /* OBJ file, read by a scene that names it */
    DOUBLED_RULES, /* obj2rad rules, read by a scene that names them */
    DOUBLED_STL,
    DOUBLED_GLTF,  /* glTF file without material names; "m 1" and so on stand for one */
    DOUBLED_LAMPS, /* lamp table of a luminaire */
};

struct doubled {
    const char *name;
    enum doubled_kind kind;
    size_t n; /* base size, large enough for the growing part of the cost to dominate */
    /* Writes the file; it may name part.rad, args.txt (n copies) and panel.xml. */
    void (*write)(FILE *file, size_t n);
    double most; /* allowed ratio of instructions if it may exceed 2.3; 0: 2.3 applies */
};

extern const struct doubled doubled_scenes[], doubled_files[], doubled_models[],
    doubled_functions[], doubled_meshes[];
extern const size_t doubled_n_scenes, doubled_n_files, doubled_n_models, doubled_n_functions,
    doubled_n_meshes;

/* An input in memory. */
struct doubled_input {
    const struct doubled *of;
    char *data;
    size_t size;
    char *copies; /* args.txt: n lines, one copy each */
    size_t copies_size;
};

struct doubled_input doubled_make(const struct doubled *of, size_t n);
void doubled_done(struct doubled_input *input);

/* Reads it as the daemon does. Returns 0 or an error, with its message in text. */
int doubled_read(const struct doubled_input *input, char text[256]);

#endif
