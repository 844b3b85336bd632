/* Version of the programs, in one place; must match api/openapi.yaml. */
#ifndef ORIEL_BASE_VERSION_H
#define ORIEL_BASE_VERSION_H

#define ORL_VERSION "0.1.0"

#endif
