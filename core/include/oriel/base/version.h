/* Version of the programs, in one place; the OpenAPI document and the guide take it from here. */
#ifndef ORIEL_BASE_VERSION_H
#define ORIEL_BASE_VERSION_H

#define ORL_VERSION "0.1.0"

#endif
