/* The daemon's resources: the table of all routes with their handlers. */
#ifndef ORL_SERVER_HANDLERS_ROUTES_H
#define ORL_SERVER_HANDLERS_ROUTES_H

#include "http/router.h"

extern const struct orl_routes orl_routes;

#endif
