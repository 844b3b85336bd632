#include "process/config.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <arpa/inet.h>

#include "process/limits.h"

/* ---- Options for large jobs ------------------------------------------------------------------ */

enum { MOST_PARTS = 1000, MOST_THREADS = 1024, MOST_SECONDS = 1000000 };
enum { USUAL_PARTS = 64, USUAL_LEAST_S = 60 };

const char *const orl_runner_named[ORL_RUNNER_NAMED] = {"partition", "account", "qos",
                                                        "constraint"};

/* Appends an option of sbatch, which gets an argument vector. It would take a word that is not an
 * option for its script. */
static int add_word(struct orl_runner_options *options, const char *value, struct orl_error *err)
{
    if (value[0] != '-' || options->n_words == ORL_RUNNER_WORDS)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "--slurm-option takes one option of sbatch, such as --time=60, at "
                             "most %d times, not '%s'",
                             ORL_RUNNER_WORDS, value);
    options->words[options->n_words++] = value;
    return 0;
}

static bool parse_named(struct orl_runner_options *options, const char *name, const char *value)
{
    static const char start[] = "--slurm-";
    for (size_t i = 0; i < ORL_RUNNER_NAMED; i++)
        if (strncmp(name, start, strlen(start)) == 0 &&
            strcmp(name + strlen(start), orl_runner_named[i]) == 0) {
            options->named[i] = value;
            return true;
        }
    return false;
}

/* Applies the options that may be repeated, or have several names. *ret_known: true if it is one.
 */
static int runner_options_apply(struct orl_runner_options *options, const char *name,
                                const char *value, bool *ret_known, struct orl_error *err)
{
    const bool word = strcmp(name, "--slurm-option") == 0;
    *ret_known = word || parse_named(options, name, value);
    options->any = options->any || *ret_known;
    return word ? add_word(options, value, err) : 0;
}

/* Checks the options against each other. */
static int runner_options_check(const struct orl_runner_options *options, struct orl_error *err)
{
    if (options->any && !options->slurm)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "--shared, --parts, --part-threads, --least and --slurm-... need --runner slurm");
    if (!options->slurm || options->shared)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "--runner slurm needs --shared DIR");
    orl_error_hint(err,
                   "DIR is a folder that this user owns and all nodes see under the same path");
    return ORL_ERR_INVALID;
}

/* ---- All settings ---------------------------------------------------------------------------- */

enum { DEFAULT_PORT = 8423 };

/* Prints the second half of the help, since ISO C limits the length of one string. */
static void print_bounds(FILE *stream)
{
    fprintf(
        stream,
        "  --idle-timeout S       seconds of silence after which a connection is closed (%u)\n"
        "  --check-timeout S      seconds that the check of one upload may take (%u)\n"
        "  --check-memory SIZE    memory that the check of one upload may use (%luM)\n"
        "  --job-timeout S        seconds that one job may run, after which it fails (%u)\n"
        "  --keep-jobs N          maximum number of ended jobs to keep, with their results;\n"
        "                         the oldest are removed (%u)\n"
        "  --keep-days N          days after which ended jobs are removed; 0: never (0);\n"
        "                         a pause of the daemon counts as one hour at most\n"
        "  --orphans refuse|set-aside\n"
        "                         if the database is lost or belongs to another folder: refuse\n"
        "                         to start; or set-aside: move files that it does not know to\n"
        "                         DIR/orphans, and create a database if none exists (refuse)\n"
        "  --keep-orphans N       days after which files in DIR/orphans are removed;\n"
        "                         0: at the next start (%u)\n"
        "  --drain-timeout S      seconds that running jobs have to finish at a stop (%u)\n"
        "  --address-connections N  maximum number of connections from one address (%u; on\n"
        "                         loopback addresses, only the total is limited)\n"
        "  --log-level debug|info|warn|error\n"
        "                         least level of the lines to log (info)\n"
        "  --log-format text|json  text: key=value pairs; json: an object a line (text)\n"
        "  --help                 print this text\n"
        "  --version              print version, commit, licence and libraries\n"
        "  --json                 with --version: print an object, for programs\n\n"
        "When ready, orield prints \"listening on http://ADDRESS:PORT\" on standard output.\n"
        "The log goes to standard error. SIGTERM stops orield: it accepts and starts no more\n"
        "jobs. Jobs that still run after --drain-timeout, or at a second SIGTERM, are queued\n"
        "again. They start over at the next start and reuse the maps that they have built.\n"
        "A stop that takes %u s longer is forced, without loss of data.\n"
        "SIGHUP reloads the certificate and key.\n",
        ORL_SERVER_TIMEOUT_S, ORL_SERVER_CHECK_S, ORL_SERVER_CHECK_BYTES >> 20, ORL_SERVER_JOB_S,
        ORL_SERVER_KEPT_JOBS, ORL_SERVER_KEEP_ORPHANS_DAYS, ORL_SERVER_DRAIN_S,
        ORL_SERVER_ADDRESS_CONNECTIONS, ORL_SERVER_STOP_S);
}

void orl_config_help(FILE *stream)
{
    fprintf(
        stream,
        "Usage: orield [OPTION]...\n"
        "       orield token add|list|remove ...   access tokens (orield token --help)\n"
        "       orield scrub | backup TO           check or copy stored data (--help)\n"
        "Serves daylight renderings over HTTP, its guide at /guide and its interface at\n"
        "/openapi.yaml.\n\n"
        "  --listen ADDRESS:PORT  where to listen (127.0.0.1:%d); addresses other than loopback\n"
        "                         need TLS and at least one token (orield token --help)\n"
        "  --port PORT            changes only the port; 0 uses a free one\n"
        "  --data DIR             the data folder ($ORIEL_DATA, else ./oriel-data)\n"
        "  --storage-budget SIZE  disk space for maps, results and uploads, such as 500M or 20G\n"
        "                         (half of what is free or used by them at the start);\n"
        "                         beyond it the least recently used maps and results are removed\n"
        "  --memory SIZE          memory limit of jobs and of checks of uploads; what does not\n"
        "                         fit waits or is refused (the control group's limit less a\n"
        "                         tenth, or the memory that is free at the start)\n"
        "  --shelf SIZE           memory for data derived from photon maps, which later jobs with\n"
        "                         the same maps reuse; 0: none (%luM)\n"
        "  --scrub-rate SIZE      bytes per second to read when stored data is compared with its\n"
        "                         digests, once a day; 0: never (%luM)\n"
        "  --tls-cert FILE        serve HTTPS: the certificate and its chain, PEM\n"
        "  --tls-key FILE         its private key, PEM\n"
        "  --tokens public|always  when tokens are required: public, on addresses other than\n"
        "                         loopback; or always, as behind a proxy (public)\n"
        "  --allow-origin ORIGIN  accept requests from web pages of exactly this origin, such as\n"
        "                         https://tool.example; repeatable (none: the daemon's own)\n"
        "  --threads N            threads that render (all processors)\n"
        "  --jobs N               jobs that render at once, sharing the threads (1)\n"
        "  --runner local|slurm   local: jobs run here; slurm: large jobs are split into parts,\n"
        "                         which run as tasks of Slurm array jobs (local)\n"
        "  --shared DIR           for slurm: a folder that only this user may access; all nodes\n"
        "                         must see it, and oriel beside orield, at the same path\n"
        "  --parts N              maximum number of parts of a job at a time (64)\n"
        "  --part-threads N       cores per part (1)\n"
        "  --least S              run jobs here if they need less than S seconds of one core, as\n"
        "                         estimated from their documents; 0: none (60)\n"
        "  --slurm-partition, --slurm-account, --slurm-qos, --slurm-constraint NAME\n"
        "                         passed to sbatch\n"
        "  --slurm-option OPTION  another option of sbatch, such as --time=60; repeatable\n",
        DEFAULT_PORT, ORL_SERVER_MEMORY_CACHE_BYTES >> 20, ORL_SERVER_SCRUB_RATE >> 20);
    print_bounds(stream);
}

static int parse_number(const char *option, const char *text, unsigned long min, unsigned long max,
                        uint32_t *ret_value, struct orl_error *err)
{
    char *end = NULL;
    errno = 0;
    const unsigned long value = strtoul(text, &end, 10);
    if (errno || !isdigit((unsigned char)text[0]) || *end || value < min || value > max)
        return orl_error_set(err, ORL_ERR_INVALID, "%s takes a number from %lu to %lu, not '%s'",
                             option, min, max, text);
    *ret_value = (uint32_t)value;
    return 0;
}

/* Parses a size such as "500000", "64K", "500M", "20G", "1T", with powers of 1024. */
static int parse_size(const char *option, const char *text, uint64_t least, uint64_t *ret_bytes,
                      struct orl_error *err)
{
    static const char units[] = "KMGT";
    char *end = NULL;
    errno = 0;
    const unsigned long long number = strtoull(text, &end, 10);
    const char *unit = end != text && *end ? strchr(units, *end) : NULL;
    const int shift = unit ? 10 * (int)(unit - units + 1) : 0;
    if (errno || end == text || text[0] == '-' || number < least || (*end && (!unit || end[1])) ||
        number > UINT64_MAX >> 1 >> shift)
        return orl_error_set(err, ORL_ERR_INVALID, "%s takes a size such as 500M or 20G, not '%s'",
                             option, text);
    *ret_bytes = (uint64_t)number << shift;
    return 0;
}

static void set_port(struct orl_config *config, uint32_t port)
{
    if (config->address.any.sa_family == AF_INET6)
        config->address.v6.sin6_port = htons((uint16_t)port);
    else
        config->address.v4.sin_port = htons((uint16_t)port);
}

static bool is_loopback(const struct orl_config *config)
{
    if (config->address.any.sa_family == AF_INET6)
        return IN6_IS_ADDR_LOOPBACK(&config->address.v6.sin6_addr);
    return ntohl(config->address.v4.sin_addr.s_addr) >> 24 == 127;
}

/* Parses an address such as "127.0.0.1:8423", "localhost:0", "[::1]:8423". */
static int parse_listen(const char *text, struct orl_config *config, struct orl_error *err)
{
    char host[64];
    const char *colon = strrchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : 0;
    if (!colon || length == 0 || length >= sizeof host)
        return orl_error_set(err, ORL_ERR_INVALID, "--listen takes ADDRESS:PORT, not '%s'", text);
    memcpy(host, text, length);
    host[length] = '\0';
    memset(&config->address, 0, sizeof config->address);
    if (strcmp(host, "localhost") == 0)
        snprintf(host, sizeof host, "127.0.0.1");
    if (host[0] == '[' && host[length - 1] == ']') {
        host[length - 1] = '\0';
        config->address.v6.sin6_family = AF_INET6;
        if (inet_pton(AF_INET6, host + 1, &config->address.v6.sin6_addr) != 1)
            return orl_error_set(err, ORL_ERR_INVALID, "'%s' is not an IP address", host + 1);
    } else {
        config->address.v4.sin_family = AF_INET;
        if (inet_pton(AF_INET, host, &config->address.v4.sin_addr) != 1)
            return orl_error_set(err, ORL_ERR_INVALID, "'%s' is not an IP address", host);
    }
    uint32_t port = 0;
    const int rc = parse_number("--listen's port", colon + 1, 0, 65535, &port, err);
    if (rc == 0)
        set_port(config, port);
    return rc;
}

/* An option that sets one field, whose type is that of the member set. */
struct setting {
    const char *name;
    const char **text;
    bool *flag; /* the value is no or yes, two words */
    const char *no, *yes;
    uint32_t *number;
    uint64_t *size;
    unsigned long least, most; /* of a number; a size has no maximum */
    bool of_runner;            /* needs --runner slurm */
};

static int apply_setting(const struct setting *setting, const char *value, struct orl_error *err)
{
    if (setting->number)
        return parse_number(setting->name, value, setting->least, setting->most, setting->number,
                            err);
    if (setting->size)
        return parse_size(setting->name, value, setting->least, setting->size, err);
    if (setting->text) {
        *setting->text = value;
        return 0;
    }
    *setting->flag = strcmp(value, setting->yes) == 0;
    return *setting->flag || strcmp(value, setting->no) == 0
               ? 0
               : orl_error_set(err, ORL_ERR_INVALID, "%s takes %s or %s, not '%s'", setting->name,
                               setting->no, setting->yes, value);
}

static int apply_settings(struct orl_config *config, const char *name, const char *value,
                          struct orl_error *err)
{
    struct orl_runner_options *runner = &config->runner;
    const struct setting settings[] = {
        {"--threads", .number = &config->threads, .least = 1, .most = ORL_SERVER_THREADS},
        {"--jobs", .number = &config->jobs, .least = 1, .most = ORL_SERVER_THREADS},
        {"--idle-timeout", .number = &config->idle_timeout_s, .least = 1, .most = 3600},
        {"--check-timeout", .number = &config->check_timeout_s, .least = 1, .most = 86400},
        {"--job-timeout", .number = &config->job_timeout_s, .least = 1, .most = 31536000},
        {"--keep-orphans", .number = &config->keep_orphans_days, .most = 36500},
        {"--keep-jobs", .number = &config->keep_jobs, .least = 1, .most = 10000000},
        {"--keep-days", .number = &config->keep_days, .most = 36500},
        {"--drain-timeout", .number = &config->drain_s, .most = 86400},
        {"--address-connections", .number = &config->address_connections, .least = 1,
         .most = ORL_SERVER_CONNECTIONS},
        {"--tokens", .flag = &config->needs_token, .no = "public", .yes = "always"},
        {"--orphans", .flag = &config->set_orphans_aside, .no = "refuse", .yes = "set-aside"},
        {"--log-format", .flag = &config->log_json, .no = "text", .yes = "json"},
        {"--tls-cert", .text = &config->tls_cert},
        {"--tls-key", .text = &config->tls_key},
        {"--data", .text = &config->data},
        {"--storage-budget", .size = &config->storage_bytes, .least = 1},
        {"--memory", .size = &config->memory_bytes, .least = 1},
        {"--check-memory", .size = &config->check_memory, .least = 1},
        {"--scrub-rate", .size = &config->scrub_bytes_per_s},
        {"--shelf", .size = &config->memory_cache_bytes},
        {"--runner", .flag = &runner->slurm, .no = "local", .yes = "slurm"},
        {"--shared", .text = &runner->shared, .of_runner = true},
        {"--parts", .number = &runner->parts, .least = 1, .most = MOST_PARTS, .of_runner = true},
        {"--part-threads", .number = &runner->part_threads, .least = 1, .most = MOST_THREADS,
         .of_runner = true},
        {"--least", .number = &runner->least_s, .most = MOST_SECONDS, .of_runner = true},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        if (strcmp(name, settings[i].name) != 0)
            continue;
        runner->any = runner->any || settings[i].of_runner;
        return apply_setting(&settings[i], value, err);
    }
    orl_error_set(err, ORL_ERR_INVALID, "there is no option '%s'", name);
    orl_error_hint(err, "orield --help lists them");
    return ORL_ERR_INVALID;
}

static int add_origin(struct orl_config *config, const char *origin, struct orl_error *err)
{
    if (orl_origin_check(origin, err))
        return ORL_ERR_INVALID;
    if (config->n_origins == ORL_SERVER_ORIGINS)
        return orl_error_set(err, ORL_ERR_INVALID, "--allow-origin may be given at most %u times",
                             ORL_SERVER_ORIGINS);
    config->origins[config->n_origins++] = origin;
    return 0;
}

static int apply_option(struct orl_config *config, const char *name, const char *value,
                        struct orl_error *err)
{
    uint32_t port = 0;
    bool of_runner;
    int rc = runner_options_apply(&config->runner, name, value, &of_runner, err);
    if (of_runner)
        return rc;
    if (strcmp(name, "--listen") == 0)
        return parse_listen(value, config, err);
    if (strcmp(name, "--allow-origin") == 0)
        return add_origin(config, value, err);
    if (strcmp(name, "--log-level") == 0)
        return orl_log_level_from_name(value, &config->log_level)
                   ? orl_error_set(err, ORL_ERR_INVALID, "there is no log level '%s'", value)
                   : 0;
    if (strcmp(name, "--port") == 0) {
        rc = parse_number(name, value, 0, 65535, &port, err);
        if (rc == 0)
            set_port(config, port);
        return rc;
    }
    rc = apply_settings(config, name, value, err);
    return rc == 0 && config->check_memory < ORL_SERVER_CHECK_LEAST
               ? orl_error_set(err, ORL_ERR_INVALID, "--check-memory takes at least %luM",
                               ORL_SERVER_CHECK_LEAST >> 20)
               : rc;
}

static void set_defaults(struct orl_config *config)
{
    memset(config, 0, sizeof *config);
    config->address.v4.sin_family = AF_INET;
    config->address.v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    config->address.v4.sin_port = htons(DEFAULT_PORT);
    const char *data = getenv("ORIEL_DATA");
    config->data = data && *data ? data : ORL_DEFAULT_DATA;
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    config->threads = processors < 1                          ? 1
                      : processors > (long)ORL_SERVER_THREADS ? ORL_SERVER_THREADS
                                                              : (uint32_t)processors;
    config->jobs = 1;
    config->runner = (struct orl_runner_options){
        .parts = USUAL_PARTS, .part_threads = 1, .least_s = USUAL_LEAST_S};
    config->idle_timeout_s = ORL_SERVER_TIMEOUT_S;
    config->check_timeout_s = ORL_SERVER_CHECK_S;
    config->check_memory = ORL_SERVER_CHECK_BYTES;
    config->memory_cache_bytes = ORL_SERVER_MEMORY_CACHE_BYTES;
    config->scrub_bytes_per_s = ORL_SERVER_SCRUB_RATE;
    config->job_timeout_s = ORL_SERVER_JOB_S;
    config->keep_jobs = ORL_SERVER_KEPT_JOBS;
    config->keep_orphans_days = ORL_SERVER_KEEP_ORPHANS_DAYS;
    config->drain_s = ORL_SERVER_DRAIN_S;
    config->log_level = ORL_LOG_INFO;
}

/* Checks options against each other, and fills in defaults that depend on others. */
static int complete_settings(struct orl_config *config, struct orl_error *err)
{
    if (config->jobs > config->threads)
        config->threads = config->jobs; /* each job needs one thread as its lead */
    if (!config->tls_cert != !config->tls_key)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "give both --tls-cert and --tls-key, or neither");
    if (runner_options_check(&config->runner, err))
        return ORL_ERR_INVALID;
    if (config->address_connections == 0)
        config->address_connections =
            is_loopback(config) ? ORL_SERVER_CONNECTIONS : ORL_SERVER_ADDRESS_CONNECTIONS;
    if (is_loopback(config))
        return 0;
    config->needs_token = true;
    if (config->tls_cert)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID,
                  "other machines can reach the address to listen on: with plain HTTP, tokens and "
                  "results could be read on the way");
    orl_error_hint(err, "Give --tls-cert and --tls-key; or listen on 127.0.0.1, behind an SSH "
                        "tunnel or a proxy with TLS");
    return ORL_ERR_INVALID;
}

int orl_config_parse(int argc, char **argv, struct orl_config *ret_config,
                     enum orl_config_action *ret_action, struct orl_error *err)
{
    struct orl_config config;
    enum orl_config_action action = ORL_CONFIG_SERVE;
    set_defaults(&config);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            action = ORL_CONFIG_HELP;
            break;
        }
        if (strcmp(argv[i], "--version") == 0) {
            action = ORL_CONFIG_VERSION;
            break;
        }
        char name[32];
        const char *equals = strchr(argv[i], '=');
        snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - argv[i]) : 31, argv[i]);
        const char *value = equals ? equals + 1 : i + 1 < argc ? argv[++i] : NULL;
        if (!value) {
            orl_error_set(err, ORL_ERR_INVALID, "%s is not an option, or needs a value", name);
            orl_error_hint(err, "orield --help lists them");
            return ORL_ERR_INVALID;
        }
        const int rc = apply_option(&config, name, value, err);
        if (rc)
            return rc;
    }
    if (action == ORL_CONFIG_SERVE) {
        const int rc = complete_settings(&config, err);
        if (rc)
            return rc;
    }
    *ret_config = config;
    *ret_action = action;
    return 0;
}

void orl_address_format(const struct sockaddr *address, char *ret_text, size_t size)
{
    char host[INET6_ADDRSTRLEN] = "?";
    if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 v6;
        memcpy(&v6, address, sizeof v6);
        inet_ntop(AF_INET6, &v6.sin6_addr, host, sizeof host);
        snprintf(ret_text, size, "[%s]:%u", host, ntohs(v6.sin6_port));
    } else {
        struct sockaddr_in v4;
        memcpy(&v4, address, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, host, sizeof host);
        snprintf(ret_text, size, "%s:%u", host, ntohs(v4.sin_port));
    }
}
