/*
 * The user's settings: the daemons that `oriel` may talk to, and their access tokens.
 *
 * The file is $XDG_CONFIG_HOME/oriel.toml, or else ~/.config/oriel.toml. It may be absent.
 *
 *     server = "https://oriel.example.org"      # or the name of a table below
 *     token_file = "~/.config/oriel.token"
 *
 *     [servers.office]
 *     url = "http://office:8423"
 *     token_file = "office.token"               # relative to the folder of oriel.toml
 *
 * The syntax is a subset of TOML 1.0: comments, tables with bare keys, and strings of one line,
 * basic ("...") with the escapes \" \\ \t, or literal ('...'). All else is refused, with its line.
 *
 * Precedence: --server, then $ORIEL_URL, then the file's "server", then the loopback default.
 * $ORIEL_TOKEN overrides every token_file. A token is sent only to the server beside which the
 * file names it.
 */
#ifndef ORL_CLIENT_OPTIONS_SETTINGS_H
#define ORL_CLIENT_OPTIONS_SETTINGS_H

#include <stddef.h>

#include <oriel/base/error.h>

enum {
    ORL_SERVERS_MAX = 32, /* tables of the file */
    ORL_SERVER_NAME_MAX = 64,
    ORL_SERVER_URL_MAX = 1024,
    ORL_TOKEN_MAX = 1024
};

struct orl_server_settings {
    char name[ORL_SERVER_NAME_MAX]; /* empty: members at the top of the file */
    char url[ORL_SERVER_URL_MAX];   /* empty: not given */
    char token_file[1024];          /* empty: not given */
};

struct orl_settings {
    char path[4096]; /* the file; empty: there is no place for one */
    struct orl_server_settings servers[ORL_SERVERS_MAX + 1]; /* the first is the top of the file */
    size_t n_servers;
};

/* Reads text as settings. ORL_ERR_SYNTAX: with line. */
int orl_settings_parse(const char *name, const char *text, size_t size,
                       struct orl_settings *ret_settings, struct orl_error *err);
/* Reads the user's file; settings are empty if there is none. */
int orl_settings_read(struct orl_settings *ret_settings, struct orl_error *err);

/* A daemon to talk to. */
struct orl_server_choice {
    char url[ORL_SERVER_URL_MAX];
    char token[ORL_TOKEN_MAX]; /* empty: none */
};
/*
 * Chooses the daemon. given: value of --server, a URL or the name of a table; NULL: absent. Reads
 * the token's file, and warns on stderr if others can read it. ORL_ERR_INVALID: there is no such
 * server.
 */
int orl_server_choose(const char *given, struct orl_server_choice *ret_server,
                      struct orl_error *err);

#endif
