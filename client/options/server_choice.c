/* Choice of the daemon, and its token. */
#include "options/settings.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/base/files.h>
#include <oriel/base/suggest.h>

static const char default_url[] = "http://127.0.0.1:8423";

static bool is_url(const char *text)
{
    return strstr(text, "://") != NULL;
}

static const struct orl_server_settings *find_named(const struct orl_settings *settings,
                                                    const char *name)
{
    for (size_t i = 1; i < settings->n_servers; i++)
        if (strcmp(settings->servers[i].name, name) == 0)
            return &settings->servers[i];
    return NULL;
}

/* Compares URLs without the slashes at their ends. */
static bool is_same_url(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    while (n > 0 && a[n - 1] == '/')
        n--;
    while (m > 0 && b[m - 1] == '/')
        m--;
    return n == m && strncmp(a, b, n) == 0;
}

/* Returns the settings with that URL, or NULL. */
static const struct orl_server_settings *find_url(const struct orl_settings *settings,
                                                  const char *url)
{
    for (size_t i = 0; i < settings->n_servers; i++)
        if (settings->servers[i].url[0] && is_same_url(settings->servers[i].url, url))
            return &settings->servers[i];
    return NULL;
}

static int refuse_name(const struct orl_settings *settings, const char *given,
                       struct orl_error *err)
{
    struct orl_suggestion suggestion = {.word = given};
    for (size_t i = 1; i < settings->n_servers; i++)
        orl_suggestion_add(&suggestion, settings->servers[i].name);
    orl_error_set(err, ORL_ERR_INVALID,
                  "\"%.200s\" is neither a URL nor a server that the settings name", given);
    orl_error_hint(err, "write http://HOST:PORT, or add [servers.%.60s] to %.300s", given,
                   settings->path[0] ? settings->path : "~/.config/oriel.toml");
    orl_suggestion_hint(&suggestion, err);
    return ORL_ERR_INVALID;
}

/* Finds the daemon: *ret_url, and the settings with its token, or NULL. */
static int find_server(const struct orl_settings *settings, const char *given, const char **ret_url,
                       const struct orl_server_settings **ret_found, struct orl_error *err)
{
    const char *const environment = getenv("ORIEL_URL");
    const struct orl_server_settings *const top = &settings->servers[0];
    const char *chosen = given                         ? given
                         : environment && *environment ? environment
                         : top->url[0]                 ? top->url
                                                       : default_url;
    *ret_found = is_url(chosen) ? find_url(settings, chosen) : find_named(settings, chosen);
    *ret_url = chosen;
    if (is_url(chosen))
        return 0;
    if (!*ret_found)
        return refuse_name(settings, chosen, err);
    *ret_url = (*ret_found)->url;
    return 0;
}

/* Makes the path of a token's file. A relative one starts at the settings' folder. */
static void resolve_path(const struct orl_settings *settings, const char *name, char *ret_path,
                         size_t size)
{
    const char *const home = getenv("HOME"), *const slash = strrchr(settings->path, '/');
    if (strncmp(name, "~/", 2) == 0 && home)
        snprintf(ret_path, size, "%s/%s", home, name + 2);
    else if (name[0] == '/')
        snprintf(ret_path, size, "%s", name);
    else
        snprintf(ret_path, size, "%.*s%s", slash ? (int)(slash + 1 - settings->path) : 0,
                 settings->path, name);
}

/* Warns if other users of this machine can read the file. */
static void warn_of_access(const char *path)
{
    struct stat info;
    if (stat(path, &info) == 0 && (info.st_mode & (S_IRGRP | S_IROTH)))
        fprintf(stderr, "warning: %s: other users can read this access token; run `chmod 600 %s`\n",
                path, path);
}

/* Reads the token: the file's text without blanks and line ends around it. */
static int read_token(const char *path, char ret_token[ORL_TOKEN_MAX], struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder("/");
    struct orl_file text;
    int rc = files.open(files.ctx, path, &text, err);
    if (rc)
        return rc;
    const char *from = text.data, *to = from + text.size;
    while (from < to && strchr(" \t\r\n", *from))
        from++;
    while (to > from && strchr(" \t\r\n", to[-1]))
        to--;
    const size_t length = (size_t)(to - from);
    bool sound = length > 0 && length < ORL_TOKEN_MAX;
    for (size_t i = 0; sound && i < length; i++)
        sound = from[i] > ' ' && from[i] <= '~';
    if (sound) {
        memcpy(ret_token, from, length);
        ret_token[length] = '\0';
    } else {
        rc =
            orl_error_set(err, ORL_ERR_INVALID, "the file must have one access token, and no more");
        orl_error_at(err, path, 0, NULL);
    }
    files.close(files.ctx, &text);
    return rc;
}

static int find_token(const struct orl_settings *settings, const struct orl_server_settings *server,
                      char ret_token[ORL_TOKEN_MAX], struct orl_error *err)
{
    const char *const environment = getenv("ORIEL_TOKEN");
    char path[8192];
    if (environment && *environment) {
        snprintf(ret_token, ORL_TOKEN_MAX, "%s", environment);
        return 0;
    }
    if (!server || !server->token_file[0])
        return 0;
    resolve_path(settings, server->token_file, path, sizeof path);
    warn_of_access(path);
    return read_token(path, ret_token, err);
}

int orl_server_choose(const char *given, struct orl_server_choice *ret_server,
                      struct orl_error *err)
{
    struct orl_settings settings;
    const struct orl_server_settings *found = NULL;
    const char *url = "";
    *ret_server = (struct orl_server_choice){.url = ""};
    int rc = orl_settings_read(&settings, err);
    if (rc == 0)
        rc = find_server(&settings, given, &url, &found, err);
    if (rc)
        return rc;
    if (strlen(url) >= sizeof ret_server->url)
        return orl_error_set(err, ORL_ERR_LIMIT, "the daemon's URL is too long");
    snprintf(ret_server->url, sizeof ret_server->url, "%s", url);
    return find_token(&settings, found, ret_server->token, err);
}
