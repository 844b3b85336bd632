/*
 * Smaller limits for the fuzz builds, included before anything else: inputs of a few hundred bytes
 * then reach the limits within milliseconds, without gigabytes of memory.
 */
#ifndef ORL_TESTS_FUZZ_LIMITS_H
#define ORL_TESTS_FUZZ_LIMITS_H

#include <oriel/base/limits.h>

#include "../../server/process/limits.h"

#undef ORL_LIMIT_SCENE_TEXT
#undef ORL_LIMIT_SURFACES
#undef ORL_LIMIT_POLYGON_VERTICES
#undef ORL_LIMIT_POLYGON_CROSSINGS
#undef ORL_LIMIT_ARGUMENTS
#undef ORL_LIMIT_WORD_BYTES
#undef ORL_LIMIT_XFORM_ARRAY
#undef ORL_LIMIT_BSDF_VALUES
#undef ORL_LIMIT_SENSORS
#undef ORL_LIMIT_MATRIX_CELLS
#undef ORL_LIMIT_MEASURED_ROWS
#undef ORL_LIMIT_MEASURED_SCANS
#define ORL_LIMIT_SCENE_TEXT (2UL << 20)
#define ORL_LIMIT_SURFACES 2000UL
#define ORL_LIMIT_POLYGON_VERTICES 60U
#define ORL_LIMIT_POLYGON_CROSSINGS 100U
#define ORL_LIMIT_ARGUMENTS 240U
#define ORL_LIMIT_WORD_BYTES 128U
#define ORL_LIMIT_XFORM_ARRAY 500U
#define ORL_LIMIT_BSDF_VALUES (1UL << 14)
#define ORL_LIMIT_SENSORS 200UL
#define ORL_LIMIT_MEASURED_ROWS 300UL
#define ORL_LIMIT_MEASURED_SCANS 4U
#define ORL_LIMIT_MATRIX_CELLS (1UL << 12)

#undef ORL_SERVER_ZIP_ENTRIES
#undef ORL_SERVER_ZIP_FREE
#undef ORL_SERVER_ZIP_RATIO
#define ORL_SERVER_ZIP_ENTRIES 16U
#define ORL_SERVER_ZIP_FREE (64UL << 10)
#define ORL_SERVER_ZIP_RATIO 20UL

#endif
