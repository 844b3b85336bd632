/* The daemon's version, as --version and GET / show it. */
#ifndef ORL_SERVER_VERSION_H
#define ORL_SERVER_VERSION_H

#define ORL_VERSION "0.1.0"

#endif
