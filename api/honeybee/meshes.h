/* Writes shade meshes, one polygon per mesh face. */
#ifndef ORL_API_HONEYBEE_MESHES_H
#define ORL_API_HONEYBEE_MESHES_H

#include "honeybee/hb_writer.h"

int orl_hb_meshes_write(struct orl_hb *hb);

/* Reads a mesh's corners (Mesh3D), which the caller owns. at: place of the mesh in the document. */
int orl_hb_mesh_corners(struct orl_hb *hb, const json_t *mesh, const struct orl_hb_at *at,
                        struct orl_vec3 **ret_corners, size_t *ret_count);
/* Reads the three or four corners of one mesh face. */
int orl_hb_mesh_face(struct orl_hb *hb, const json_t *face, const struct orl_hb_at *at,
                     const struct orl_vec3 *corners, size_t count, struct orl_vec3 ret_face[4],
                     size_t *ret_n);

#endif
