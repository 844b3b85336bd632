/*
 * Inputs of every reader that can be made twice as long: one row for each rule of the scene
 * grammar, each command and each kind of file. Reading them is timed by nobody:
 * tests/unit/test_doubling.c counts instructions.
 */
#ifndef ORL_TESTS_SUPPORT_DOUBLED_H
#define ORL_TESTS_SUPPORT_DOUBLED_H

#include <stddef.h>
#include <stdio.h>

enum doubled_kind {
    DOUBLED_SCENE, /* scene text: read to a description */
    DOUBLED_WORLD, /* the same, checked as an upload is: triangles, coincident polygons, Embree */
    DOUBLED_BSDF,
    DOUBLED_SENSORS,
    DOUBLED_WEATHER,
    DOUBLED_VIEWS,
    DOUBLED_JOB,
    DOUBLED_STUDY,
    DOUBLED_YEAR,      /* the document of one */
    DOUBLED_PANEL,     /* a document that asks for its BSDF */
    DOUBLED_OCCUPANCY, /* of a year in minutes */
    DOUBLED_SCHEDULE,  /* of shades */
    DOUBLED_MEASURED,  /* by goniophotometers */
    DOUBLED_MATRIX,    /* of a year's light */
    DOUBLED_FUNCTION,  /* definitions of x, and what it needs, compiled and evaluated */
    DOUBLED_ZIP,
    DOUBLED_MODEL, /* Honeybee's, as files */
    DOUBLED_OBJ,   /* a scene that names it */
    DOUBLED_RULES, /* of obj2rad, the same */
    DOUBLED_STL,
    DOUBLED_GLTF,  /* without a material's name but for "m 1" and so on, which stand for one */
    DOUBLED_LAMPS, /* a table of them, of a luminaire */
};

struct doubled {
    const char *name;
    enum doubled_kind kind;
    size_t n; /* the size that is doubled: large enough for what grows to outweigh what does not */
    /* Writes the file; it may name part.rad, args.txt (n copies) and panel.xml. */
    void (*write)(FILE *file, size_t n);
    double most; /* times the instructions, where more than 2.5 is right; 0: it is not */
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
    char *copies; /* args.txt: n lines, a copy each */
    size_t copies_size;
};

struct doubled_input doubled_make(const struct doubled *of, size_t n);
void doubled_done(struct doubled_input *input);

/* Reads it as the daemon would. Returns 0 or an error, with its message in text. */
int doubled_read(const struct doubled_input *input, char text[256]);

#endif
