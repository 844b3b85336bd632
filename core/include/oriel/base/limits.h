/* Bounds on the cost of untrusted input, in one place. GET /v1/limits reports them. */
#ifndef ORIEL_BASE_LIMITS_H
#define ORIEL_BASE_LIMITS_H

#define ORL_LIMIT_FILE_BYTES (512UL << 20) /* one uploaded file */
#define ORL_LIMIT_SCENE_FILES 512U         /* files in one scene */
#define ORL_LIMIT_INCLUDE_DEPTH 16U        /* nesting of !xform files */
#define ORL_LIMIT_SCENE_TEXT (4UL << 30)   /* scene text read, including repeats by xform -a */
#define ORL_LIMIT_SURFACES 5000000UL       /* surfaces after all !xform -a repeats */
#define ORL_LIMIT_NAME_BYTES                                                                       \
    (256UL << 20) /* names of all surfaces, including prefixes by xform -n */
#define ORL_LIMIT_POLYGON_VERTICES 20000U /* corners of one polygon */
#define ORL_LIMIT_FUNCTION_BRDFS 64U      /* materials with functions of both directions */
#define ORL_LIMIT_ANTIMATTERS 64U         /* materials of volumes that cut surfaces */
#define ORL_LIMIT_INSTANCES (1UL << 20)   /* instances and meshes that share geometry */
#define ORL_LIMIT_INSTANCED_SURFACES                                                               \
    (1UL << 30)                            /* surfaces and triangles, counted in each placement */
#define ORL_LIMIT_CUT_FACETS (1UL << 23)   /* number of antimatters times all surfaces */
#define ORL_LIMIT_CUT 256U                 /* materials that one antimatter cuts */
#define ORL_LIMIT_POLYGON_CROSSINGS 50000U /* crossings of one polygon's outline with itself */
#define ORL_LIMIT_ARGUMENTS 400000U        /* arguments of one primitive */
#define ORL_LIMIT_WORD_BYTES 4096U         /* one word of a scene file */
#define ORL_LIMIT_XFORM_ARRAY 100000U      /* copies made by one !xform -a chain */
#define ORL_LIMIT_XML_DEPTH 64U            /* element nesting in a BSDF file */
#define ORL_LIMIT_TREE_DEPTH 8U            /* log2 of a tensor tree's resolution per axis */
#define ORL_LIMIT_BSDF_VALUES (64UL << 20) /* leaf values in one BSDF file */
#define ORL_LIMIT_WEATHER_ROWS 527040UL    /* rows of a weather file: a leap year's minutes */
#define ORL_LIMIT_YEAR_ROWS 52704   /* rows of an annual job: a leap year's 10-minute steps */
#define ORL_LIMIT_SENSORS 4000000UL /* sensors in one job */
#define ORL_LIMIT_DISTANCE 1e12     /* any given coordinate: rays are floats */
#define ORL_LIMIT_VIEWS 1024U       /* views in one job */
#define ORL_LIMIT_SKIES 1024U       /* skies in one job */
#define ORL_LIMIT_SEQUENCE 400U     /* skies in a job whose pictures are a sequence */
#define ORL_LIMIT_PICTURES 4096U    /* views in one job, times its skies */
#define ORL_LIMIT_GRIDS 4096U       /* grids of sensors in an annual job */
#define ORL_LIMIT_MATRIX_CELLS (64UL << 20) /* values of three channels in one matrix of a year */
#define ORL_LIMIT_IMAGE_SIDE 16384U         /* pixels along one side */
#define ORL_LIMIT_IMAGE_PIXELS (64UL << 20) /* pixels in one image */
#define ORL_LIMIT_PICTURE_POINTS 256U       /* named points in one view's false colours */
#define ORL_LIMIT_DIVISIONS 64U             /* divisions of a false-colour scale */
#define ORL_LIMIT_PHOTONS 100000000UL       /* target photons of one map: 5 GB while built */
#define ORL_LIMIT_GOAL_SAMPLES (1UL << 20)  /* samples a sensor, all rounds for an accuracy */
#define ORL_LIMIT_DEADLINE_S 604800UL       /* longest deadline: a week */
#define ORL_LIMIT_JOB_BYTES (64UL << 20)    /* one job document */
#define ORL_LIMIT_JSON_MEMORY (1UL << 30)   /* estimated memory of reading one JSON document */
#define ORL_LIMIT_MEASURED_ROWS 4000000UL   /* goniophotometer rows in all files of a BSDF */
#define ORL_LIMIT_MEASURED_SCANS 512U       /* incident directions and outgoing sides in them */
#define ORL_LIMIT_STUDY_RUNS 2000U          /* runs of one study: settings times seeds */
#define ORL_LIMIT_STUDY_LIST 64U            /* techniques, photons, samples or points in a study */

#endif
