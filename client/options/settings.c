/* Parser of the settings file. */
#include "options/settings.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/base/suggest.h>

struct settings_parser {
    const char *at, *end; /* the rest of the current line */
    const char *name;
    int line;
    struct orl_settings *settings;
    struct orl_server_settings *table; /* table that the line belongs to */
    struct orl_error *err;
};

static int fail_at_line(const struct settings_parser *p, const char *what)
{
    orl_error_set(p->err, ORL_ERR_SYNTAX, "%s", what);
    orl_error_at(p->err, p->name, p->line, NULL);
    return ORL_ERR_SYNTAX;
}

static void skip_blanks(struct settings_parser *p)
{
    while (p->at < p->end && (*p->at == ' ' || *p->at == '\t'))
        p->at++;
}

/* Returns true if only blanks and a comment are left of the line. */
static bool is_at_end(struct settings_parser *p)
{
    skip_blanks(p);
    return p->at == p->end || *p->at == '#';
}

/* Takes a bare key; returns false if there is none, or if it is too long. */
static bool take_key(struct settings_parser *p, char ret_key[ORL_SERVER_NAME_MAX])
{
    static const char bare[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    size_t length = 0;
    skip_blanks(p);
    while (p->at + length < p->end && p->at[length] && strchr(bare, p->at[length]))
        length++;
    if (length == 0 || length >= ORL_SERVER_NAME_MAX)
        return false;
    memcpy(ret_key, p->at, length);
    ret_key[length] = '\0';
    p->at += length;
    return true;
}

/* Returns the letter that an escape stands for, or NUL if it is not allowed. */
static char unescape(char c)
{
    return c == '"' || c == '\\' ? c : c == 't' ? '\t' : '\0';
}

/* Takes a string in quotes. */
static int take_string(struct settings_parser *p, char *ret_text, size_t size)
{
    size_t length = 0;
    skip_blanks(p);
    if (p->at == p->end || (*p->at != '"' && *p->at != '\''))
        return fail_at_line(p, "a string in quotes is expected after '='");
    const char quote = *p->at++;
    for (; p->at < p->end && *p->at != quote; p->at++) {
        char c = *p->at;
        if (c == '\\' && quote == '"') {
            c = ++p->at < p->end ? unescape(*p->at) : '\0';
            if (!c)
                return fail_at_line(p, "the only escapes in a string are \\\" \\\\ and \\t; write "
                                       "'...' for text without escapes");
        }
        if ((unsigned char)c < ' ' && c != '\t')
            return fail_at_line(p, "a string has a control character");
        if (length + 1 >= size)
            return fail_at_line(p, "the string is too long");
        ret_text[length++] = c;
    }
    if (p->at == p->end)
        return fail_at_line(p, "the string has no closing quote");
    p->at++;
    ret_text[length] = '\0';
    return length > 0 ? 0 : fail_at_line(p, "the string is empty");
}

/* Reads "[servers.NAME]", from behind the bracket. */
static int read_table(struct settings_parser *p)
{
    struct orl_settings *settings = p->settings;
    char first[ORL_SERVER_NAME_MAX], name[ORL_SERVER_NAME_MAX];
    bool sound = take_key(p, first) && strcmp(first, "servers") == 0;
    skip_blanks(p);
    sound = sound && p->at < p->end && *p->at++ == '.' && take_key(p, name);
    skip_blanks(p);
    sound = sound && p->at < p->end && *p->at++ == ']' && is_at_end(p);
    if (!sound)
        return fail_at_line(p, "a table is expected as [servers.NAME]; names have letters, digits, "
                               "'-' and '_'");
    for (size_t i = 1; i < settings->n_servers; i++)
        if (strcmp(settings->servers[i].name, name) == 0)
            return fail_at_line(p, "a second table has the same name");
    if (settings->n_servers > ORL_SERVERS_MAX)
        return fail_at_line(p, "there are too many tables");
    p->table = &settings->servers[settings->n_servers++];
    *p->table = (struct orl_server_settings){.url = ""};
    memcpy(p->table->name, name, sizeof name);
    return 0;
}

static int refuse_key(const struct settings_parser *p, const char *key, const char *const known[2])
{
    struct orl_suggestion suggestion = {.word = key};
    orl_suggestion_add(&suggestion, known[0]);
    orl_suggestion_add(&suggestion, known[1]);
    orl_error_set(p->err, ORL_ERR_SYNTAX, "\"%s\" is not a setting %s", key,
                  p->table->name[0] ? "of a server" : "at the top of the file");
    orl_error_at(p->err, p->name, p->line, NULL);
    orl_error_hint(p->err, "Known here: %s, %s", known[0], known[1]);
    orl_suggestion_hint(&suggestion, p->err);
    return ORL_ERR_SYNTAX;
}

/* Reads "KEY = STRING". */
static int read_member(struct settings_parser *p)
{
    const char *const known[2] = {p->table->name[0] ? "url" : "server", "token_file"};
    char key[ORL_SERVER_NAME_MAX];
    if (!take_key(p, key))
        return fail_at_line(p, "KEY = \"TEXT\" or [servers.NAME] is expected");
    skip_blanks(p);
    if (p->at == p->end || *p->at++ != '=')
        return fail_at_line(p, "'=' is expected after the key");
    const bool is_url = strcmp(key, known[0]) == 0;
    if (!is_url && strcmp(key, known[1]) != 0)
        return refuse_key(p, key, known);
    char *const into = is_url ? p->table->url : p->table->token_file;
    if (*into)
        return fail_at_line(p, "the setting is given twice");
    const int rc =
        take_string(p, into, is_url ? sizeof p->table->url : sizeof p->table->token_file);
    if (rc)
        return rc;
    return is_at_end(p) ? 0 : fail_at_line(p, "nothing may follow the string on its line");
}

static int read_line(struct settings_parser *p)
{
    if (is_at_end(p))
        return 0;
    if (*p->at != '[')
        return read_member(p);
    p->at++;
    return read_table(p);
}

/* Checks that each table has a URL. */
static int check_urls(const struct settings_parser *p)
{
    for (size_t i = 1; i < p->settings->n_servers; i++)
        if (!p->settings->servers[i].url[0]) {
            orl_error_set(p->err, ORL_ERR_SYNTAX, "the server \"%s\" has no \"url\"",
                          p->settings->servers[i].name);
            orl_error_at(p->err, p->name, 0, NULL);
            return ORL_ERR_SYNTAX;
        }
    return 0;
}

int orl_settings_parse(const char *name, const char *text, size_t size,
                       struct orl_settings *ret_settings, struct orl_error *err)
{
    struct settings_parser p = {.name = name, .settings = ret_settings, .err = err};
    const char *const end = text + size;
    int rc = 0;
    ret_settings->servers[0] = (struct orl_server_settings){.name = ""};
    ret_settings->n_servers = 1;
    p.table = &ret_settings->servers[0];
    while (text < end && rc == 0) {
        const char *next = memchr(text, '\n', (size_t)(end - text));
        p.at = text;
        p.end = next ? next : end;
        text = next ? next + 1 : end;
        if (p.end > p.at && p.end[-1] == '\r')
            p.end--;
        p.line++;
        rc = read_line(&p);
    }
    return rc ? rc : check_urls(&p);
}

/* Finds the path of the file; it is left empty if the environment names no folder. */
static void find_path(char *ret_path, size_t size)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    ret_path[0] = '\0';
    if (config && config[0] == '/')
        snprintf(ret_path, size, "%s/oriel.toml", config);
    else if (home && home[0])
        snprintf(ret_path, size, "%s/.config/oriel.toml", home);
}

int orl_settings_read(struct orl_settings *ret_settings, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder("/");
    struct orl_error absent = {0};
    struct orl_file text;
    *ret_settings = (struct orl_settings){.n_servers = 1};
    find_path(ret_settings->path, sizeof ret_settings->path);
    if (!ret_settings->path[0])
        return 0;
    int rc = files.open(files.ctx, ret_settings->path, &text, &absent);
    if (rc == ORL_ERR_NOT_FOUND)
        return 0;
    if (rc) {
        *err = absent;
        return rc;
    }
    rc = orl_settings_parse(ret_settings->path, text.data, text.size, ret_settings, err);
    files.close(files.ctx, &text);
    return rc;
}
