/*
 * Ray properties that functions of patterns and materials may use: the inputs of their programs,
 * with Radiance's names (reference manual, section on function files). Frame: the function's own,
 * in which the file's transform has been undone.
 */
#ifndef ORL_FUNCTION_RAY_NAMES_H
#define ORL_FUNCTION_RAY_NAMES_H

enum orl_ray_input {
    ORL_RAY_DX, /* direction of the ray */
    ORL_RAY_DY,
    ORL_RAY_DZ,
    ORL_RAY_NX, /* normal of the surface, on its front */
    ORL_RAY_NY,
    ORL_RAY_NZ,
    ORL_RAY_PX, /* hit point */
    ORL_RAY_PY,
    ORL_RAY_PZ,
    ORL_RAY_T,    /* distance from the start of the path */
    ORL_RAY_TS,   /* distance along this ray */
    ORL_RAY_RDOT, /* cosine between ray and normal, below 0 on the back */
    ORL_RAY_S,    /* length of the world's unit in the function's units */
    ORL_RAY_TX,   /* the world's origin and unit vectors in the function's frame */
    ORL_RAY_TY,
    ORL_RAY_TZ,
    ORL_RAY_IX,
    ORL_RAY_IY,
    ORL_RAY_IZ,
    ORL_RAY_JX,
    ORL_RAY_JY,
    ORL_RAY_JZ,
    ORL_RAY_KX,
    ORL_RAY_KY,
    ORL_RAY_KZ,
    ORL_RAY_LU, /* coordinates on a mesh */
    ORL_RAY_LV,
    ORL_RAY_NXP, /* normal after textures */
    ORL_RAY_NYP,
    ORL_RAY_NZP,
    ORL_RAY_RDOTP,
    ORL_RAY_CRP, /* colour after patterns */
    ORL_RAY_CGP,
    ORL_RAY_CBP,
    ORL_RAY_DXA, /* direction to the light source of a prism */
    ORL_RAY_DYA,
    ORL_RAY_DZA,
    ORL_RAY_LIGHT_X, /* direction to the light for a lobe; set by the evaluator */
    ORL_RAY_LIGHT_Y,
    ORL_RAY_LIGHT_Z,
    ORL_RAY_DATA, /* up to three values from a data file or a picture; set by the evaluator */
    ORL_RAY_DATA_2,
    ORL_RAY_DATA_3,
    ORL_RAY_INPUTS
};

extern const char *const orl_function_ray_names[ORL_RAY_INPUTS];

#endif
