/* The version of the programs, in one place; api/openapi.yaml says the same. */
#ifndef ORIEL_VERSION_H
#define ORIEL_VERSION_H

#define ORL_VERSION "0.1.0"

#endif
