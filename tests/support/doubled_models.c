/* The rows for Honeybee models. */
#include "support/doubled.h"

/* Writes a wall of 100 m with n windows in rows, in reverse order. */
static void write_model_windows(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"orphaned_faces\": [{\"identifier\": \"wall\", \"face_type\":"
          " \"Wall\", \"geometry\": {\"boundary\": [[0,0,0],[100,0,0],[100,0,100],[0,0,100]]},"
          " \"apertures\": [",
          f);
    for (size_t i = n; i-- > 0;) {
        const double x = 1 + 2.0 * (double)(i % 40), z = 1 + 0.01 * (double)(i / 40);
        fprintf(f,
                "%s{\"identifier\": \"w%zu\", \"geometry\": {\"boundary\": [[%g,0,%g],[%g,0,%g],"
                "[%g,0,%g]]}}",
                i + 1 < n ? "," : "", i, x, z, x + 1, z, x + 1, z + 0.005);
    }
    fputs("]}]}", f);
}
static void write_model_rooms(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"rooms\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(
            f,
            "%s{\"faces\": [{\"identifier\": \"a%zu\", \"face_type\": \"Wall\","
            " \"boundary_condition\": {\"type\": \"Surface\", \"boundary_condition_objects\":"
            " [\"a%zu\"]}, \"geometry\": {\"boundary\": [[0,0,0],[1,0,0],[1,0,1]]},"
            " \"outdoor_shades\": [{\"geometry\": {\"boundary\": [[0,0,0],[1,0,0],[1,0,1]]}}]}]}",
            i ? "," : "", i, i ^ 1);
    fputs("]}", f);
}
/*
 * Writes faces with their own modifiers, each of which depends on the one before, up to eight deep.
 */
static void write_model_modifiers(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"orphaned_shades\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "%s{\"geometry\": {\"boundary\": [[0,0,0],[1,0,0],[1,0,1]]}, \"properties\":"
                " {\"radiance\": {\"modifier\": \"m%zu\"}}}",
                i ? "," : "", i);
    fputs("], \"properties\": {\"radiance\": {\"modifiers\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%s{\"type\": \"Plastic\", \"identifier\": \"m%zu\"%s%zu%s}", i ? "," : "", i,
                i % 8 ? ", \"dependencies\": [\"m" : ", \"r_reflectance\": 0.", i % 8 ? i - 1 : 1,
                i % 8 ? "\"]" : "");
    fputs("]}}}", f);
}
static void write_model_states(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"orphaned_shades\": [{\"geometry\": {\"boundary\": [[0,0,0],"
          "[1,0,0],[1,0,1]]}, \"properties\": {\"radiance\": {\"dynamic_group_identifier\": \"g\","
          " \"states\": [{}",
          f);
    for (size_t i = 1; i < n; i++)
        fputs(",{}", f);
    fputs("]}}}]}", f);
}
static void write_model_mesh(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"shade_meshes\": [{\"geometry\": {\"vertices\": [[0,0,0]", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, ",[%zu,0,1],[%zu,1,1]", i, i);
    fputs("], \"faces\": [[0,1,2]", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, ",[0,%zu,%zu]", 2 * i + 1, 2 * i + 2);
    fputs("]}}]}", f);
}
static void write_model_grids(FILE *f, size_t n)
{
    fputs("{\"type\": \"Model\", \"properties\": {\"radiance\": {\"sensor_grids\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "%s{\"identifier\": \"g%zu\", \"sensors\": [{\"pos\": [0,0,%zu], \"dir\":"
                " [0,0,1]}]}",
                i ? "," : "", i, i);
    fputs("]}}}", f);
}

#define MODEL(name, n)                                                                             \
    {                                                                                              \
#name, DOUBLED_MODEL, n, write_##name, 0                                                   \
    }

const struct doubled doubled_models[] = {
    MODEL(model_windows, 250), MODEL(model_rooms, 100), MODEL(model_modifiers, 150),
    MODEL(model_states, 200),  MODEL(model_mesh, 400),  MODEL(model_grids, 200),
};
const size_t doubled_n_models = sizeof doubled_models / sizeof *doubled_models;
