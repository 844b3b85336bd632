/* oriel: the command line. A static table lists the commands and their help. */
#include <stdio.h>
#include <string.h>

#include <curl/curl.h>
#include <oriel/base/suggest.h>

#include "options/command.h"
#include "output/style.h"

static const struct orl_subcommand commands[] = {
    {"run",
     "JOB.json|PROJECT -o DIR [--sky SKY] [--states GROUP=STATE,...]\n"
     "  [--weather FILE [--year YEAR] [--rules NAME,...]] [--threads N]\n"
     "  [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Render a job here, without a daemon",
     "JOB.json lists the scene's files as {\"files\": [...]}, relative to the document.\n"
     "A project is a Honeybee model, or a folder exported by Honeybee: all its grids and\n"
     "views are rendered, with its own sky or the one of --sky, fisheye views with DGP.\n"
     "Prints a table of each grid. DIR gets a map of each grid (results/GRID.png), all\n"
     "sensors (sensors.csv), images, result.json, and photon maps for later runs.\n"
     "With --weather, the year of a project is computed, as by `oriel annual`.",
     orl_cmd_run,
     "oriel run office.hbjson -o out --sky \\\n  '{\"cie\": {\"type\": \"overcast\", "
     "\"diffuse_horizontal_lx\": 10000}}'"},
    {"plan", "JOB.json|PROJECT [--json] [--threads N]",
     "Show the technique and effects of a job, and the time for accuracies",
     "Prints a row for each effect of light: whether it is simulated, the largest error at\n"
     "any sensor or pixel without it (lux, or a fraction), the estimated time saved\n"
     "(seconds of one thread), and the reason. The job's \"effects\" can force or skip each\n"
     "effect. Then two small rounds of path tracing predict the seconds that jobs with\n"
     "given accuracies take here.",
     orl_cmd_plan, "oriel plan job.json"},
    {"project", "MODEL.hbjson|FOLDER|FILE.rif|FILE.cfg [--json] [-o DIR]",
     "List the contents of a Honeybee model or folder, and missing files",
     "Prints tables: units, skies, grids with their sensors, views, window groups with\n"
     "their states, files left out, and files that are referred to but missing.\n"
     "With -o, a model's Radiance files are written to DIR, with a job.json that names\n"
     "them. Exit codes: 0; 1 if files are missing or the scene cannot be read.",
     orl_cmd_project, "oriel project office.hbjson"},
    {"annual",
     "JOB.json|PROJECT -o DIR [--weather FILE [--year YEAR]]\n"
     "  [--rules NAME,...] [--states GROUP=STATE,...] [--cache DIR] [--honeybee]\n"
     "  [--ill] [--phases] [--threads N] [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Compute a year of daylight: metrics and verdicts with their intervals",
     "JOB.json names a scene without a sky, a weather file (EPW or WEA) and grids of\n"
     "sensors. Optional members are hours of use, metrics, targets (\"sDA300/50 >= 55 %\")\n"
     "and rules (\"LEED\", \"EN 17037\"). Writes result.json, sensors.csv, hours.csv, maps of\n"
     "every grid over the plan and over the year, and a one-page summary of every grid\n"
     "(PDF). --honeybee writes all hours to DIR/results in Honeybee's format, --ill as\n"
     "Radiance matrices; --phases adds the matrices of the three- and five-phase methods.\n"
     "A project (a Honeybee model or folder) can be given in place of the document. Then\n"
     "all its grids and the states of its windows are used, and --weather is required.",
     orl_cmd_annual, "oriel annual office.hbjson --weather place.epw --rules LEED -o year"},
    {"recipe", "NAME [MODEL] [--inputs FILE.json] [--INPUT VALUE ...] -o DIR [--threads N]",
     "Run a recipe of Ladybug Tools, with its inputs and result folders",
     "NAME is one of: point-in-time-grid, point-in-time-view, daylight-factor,\n"
     "annual-daylight, annual-daylight-enhanced, annual-daylight-en17037, direct-sun-hours,\n"
     "imageless-annual-glare, leed-daylight-option-one, leed-daylight-option-two,\n"
     "breeam-daylight-4b, well-daylight, sky-view. Inputs have the recipe's names, as options\n"
     "or in the file that lbt-recipes writes; `oriel recipe NAME --help` lists them. DIR gets\n"
     "the recipe's results, and DIR/oriel the files of Oriel's own job.",
     orl_cmd_recipe, "oriel recipe daylight-factor office.hbjson -o factor"},
    {"verify", "RESULT [--files DIR] [--threads N]",
     "Repeat a year from the provenance in its result, and compare the bytes",
     "RESULT is a year's result.json, or the folder that contains it and the year's other\n"
     "files. Inputs are searched by name below --files and must have the digests that the\n"
     "result names. Exit codes: 0 if all bytes are equal; 1 if some differ, with each such\n"
     "file named; 2 if the year cannot be repeated, because an input has changed or is\n"
     "missing.",
     orl_cmd_verify, "oriel verify year --files ."},
    {"part", "FILE", "Compute one part of a job that is divided into parts",
     "FILE is written by run, annual, study or bsdf make with --parts or --slurm. These\n"
     "commands start this one themselves, or through Slurm. The results are written beside\n"
     "FILE.",
     orl_cmd_part, "oriel part out/parts/0123abcd.task"},
    {"study",
     "STUDY.json -o DIR [--threads N] [--parts N]\n"
     "  [--slurm [--sbatch OPTIONS]]",
     "Measure accuracy against time, for techniques and settings",
     "Runs every technique with every number of photons and samples that STUDY.json lists,\n"
     "each with several seeds, and compares the results with a long unbiased run. Writes\n"
     "study.json, study.csv, study.svg and study.png to DIR. Times are for one thread\n"
     "unless --threads gives another number.",
     orl_cmd_study, "oriel study study.json -o study"},
    {"submit",
     "JOB.json|PROJECT [--name NAME] [--tags TAG,...]\n"
     "  [--server SERVER] [--wait] [--sky SKY] [--states GROUP=STATE,...]\n"
     "  [--weather FILE [--year YEAR] [--rules NAME,...]]",
     "Send a job, study or year, and the files it needs, to a daemon",
     "Uploads the scene's files and all files that they refer to, then prints the job's\n"
     "id. A project is rendered as by `oriel run`. With --weather, its year is computed as\n"
     "by `oriel annual`.",
     orl_cmd_submit, "oriel submit office.hbjson --weather place.epw --rules LEED --wait"},
    {"status",
     "[ID] [--state STATE] [--tag TAG] [--scene ID] [--since TIME]\n"
     "  [--limit N] [--server SERVER]",
     "Show one job, or the latest jobs",
     "Without an id, prints one line per job: name (or else tags), state, progress, time\n"
     "left or place in the queue, and for jobs with a goal the relative error so far. An\n"
     "id can be shortened to its first digits, here and in the other commands.",
     orl_cmd_status, "oriel status --state running"},
    {"watch", "[--tag TAG] [--server SERVER]", "Show all jobs as they change, one line per change",
     "First lists the existing jobs. Then prints a line, in the format of status, for each\n"
     "new job or state, for the error after each round, and for each 10 % of progress. If\n"
     "the daemon restarts, the command waits for it. Ends with Ctrl-C.",
     orl_cmd_watch, "oriel watch --tag office"},
    {"wait", "ID [--server SERVER]", "Follow a job to its end, with progress",
     "Exit codes: 0 if the job succeeded, 1 if it failed or was cancelled. If the daemon\n"
     "restarts, the command waits for it.",
     orl_cmd_wait, "oriel wait 0123abcd"},
    {"fetch", "ID -o DIR [--server SERVER]", "Download a finished job's results",
     "Downloads result.json and the job's other files: the images of a render job;\n"
     "study.csv, study.svg and study.png of a study; tables, maps, temporal maps and pages\n"
     "of a year, in subfolders where the result has them.",
     orl_cmd_fetch, "oriel fetch 0123abcd -o out"},
    {"cancel", "ID [--server SERVER]", "Stop a job, and wait until it has stopped", NULL,
     orl_cmd_cancel, "oriel cancel 0123abcd"},
    {"remove", "job|scene|bsdf ID... [--server SERVER]",
     "Remove jobs, scenes or BSDFs from a daemon",
     "A job must have ended; its results are removed with it. A scene can be removed if no\n"
     "waiting or running job needs it, a BSDF if no scene contains it. Photon maps: oriel\n"
     "maps --remove.",
     orl_cmd_remove, "oriel remove job 0123abcd"},
    {"list", "scenes|bsdfs [--server SERVER]",
     "List the scenes or BSDFs that a daemon stores, the latest first",
     "For a scene: its size, the numbers of all its jobs and of unfinished ones, and the\n"
     "time of last use. For a BSDF: its size, the number of scenes that contain it, and\n"
     "its name.",
     orl_cmd_list, "oriel list scenes"},
    {"link", "ID FILE... [--seconds N] [--server SERVER]",
     "Print temporary addresses of results that need no token",
     "Anyone who has an address can read that file, with any program, until the address\n"
     "expires or the token that requested it is revoked.",
     orl_cmd_link, "oriel link 0123abcd desk.png --seconds 3600"},
    {"maps", "[--remove KEY] [--server SERVER]",
     "List the photon maps and BSDFs that a daemon stores, and the time they saved",
     "With --remove, removes the one whose key begins with KEY. A job that needs it builds\n"
     "it again.",
     orl_cmd_maps, "oriel maps"},
    {"upload",
     "scene FILE... | scene FOLDER|ZIP|MODEL.hbjson [FILE...]\n"
     "  | bsdf FILE [--server SERVER]",
     "Upload a scene or a BSDF, and print its id",
     "A scene's files are named relative to the working directory, or to the folder, as\n"
     "the scene's texts refer to them. The main files of a folder are those named after\n"
     "it. By default they are the folder's .rad files that no command in another file\n"
     "names, in the order of their names. All files that these refer to are included. A\n"
     "zip of a folder is sent as it is, and the daemon unpacks it. A Honeybee model is\n"
     "sent as it is, too, and the daemon translates it.",
     orl_cmd_upload, "oriel upload scene office.zip"},
    {"bsdf",
     "check FILE [--json] | fit DATA... -o FILE.xml [...]\n"
     "  | make PANEL.rad... -o FILE.xml [...]\n"
     "  | convert FILE -o FILE.xml [...] | compare FILE FILE [--report FILE]\n"
     "  | plot FILE [FILE] -o PICTURE [...]",
     "Check a BSDF file, or make one from measurements or geometry",
     "fit makes one from goniophotometer measurements, make from a panel's geometry;\n"
     "convert changes basis and resolution, compare prints differences, plot draws light.\n"
     "`oriel bsdf make --help` lists the options of make, and so on.\n"
     "check prints type and resolution, reflectance and transmittance by direction, and\n"
     "problems: gain of energy, violated reciprocity, wrong sides or up direction, and\n"
     "blurring of the sun. Exit code 1 if the file is refused or faulty.",
     orl_cmd_bsdf, "oriel bsdf check blinds.xml"},
    {"glare", "PICTURE.hdr [-d] [--json] [--task X,Y,ANGLE] ...",
     "Find the glare sources of an HDR picture, and compute glare metrics",
     "Computes DGP and other indices of any Radiance picture with a VIEW line, with\n"
     "evalglare's definitions and defaults; core/metrics/evalglare.md lists the\n"
     "differences. Options -b -T -r -s -x -Y -A -i -d are evalglare's.",
     orl_cmd_glare, "oriel glare desk.hdr"},
    {"health", "[--local] [--server URL]", "Ask a daemon whether it is alive",
     "Prints its version, the time since its start, and whether its disk is full. Exit code\n"
     "1 if no daemon answers. No token is needed. With --local, as in the health check of a\n"
     "container, the daemon of this machine is asked by HTTP, and by HTTPS with any\n"
     "certificate if it does not answer.",
     orl_cmd_health, "oriel health --server http://127.0.0.1:8423"},
    {"version", "[--json]", "Print the version, the commit, and the versions of libraries", NULL,
     orl_cmd_version, "oriel version"},
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static const struct orl_subcommand *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    return NULL;
}

static void print_overview(FILE *to)
{
    fprintf(to, "oriel: daylight rendering, here or through an orield daemon\n\n"
                "usage: oriel COMMAND ...\n\n");
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        fprintf(to, "  %s%-8s%s %s\n", orl_style_begin(to, ORL_STYLE_HEADING), commands[i].name,
                orl_style_end(to), commands[i].summary);
    fprintf(to,
            "\n`oriel help COMMAND` shows details. Daemon: --server URL, or $ORIEL_URL, or\n"
            "http://127.0.0.1:8423; access token: $ORIEL_TOKEN; own CA certificate: $ORIEL_CA.\n"
            "~/.config/oriel.toml can name servers and files of tokens.\n"
            "The daemon's queue alternates between clients. Without tokens, a client is\n"
            "identified by $ORIEL_CLIENT or the user's name.\n"
            "Exit codes: 0 done, 1 failed, 2 wrong command line.\n" ORL_GUIDE_LINE "\n");
}

/* Reports an unknown command, and suggests one. */
static int refuse_command(const char *name)
{
    struct orl_suggestion suggestion = {.word = name};
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        orl_suggestion_add(&suggestion, commands[i].name);
    orl_suggestion_add(&suggestion, "help");
    fprintf(stderr, "oriel: there is no command \"%s\"", name);
    if (suggestion.best)
        fprintf(stderr, "; did you mean \"%s\"", suggestion.best);
    fprintf(stderr, "%s Try `oriel --help`.\n", suggestion.best ? "?" : ".");
    return ORL_EXIT_USAGE;
}

/* Handles `oriel help COMMAND [VERB]`, as --help of that command. */
static int run_help(int argc, char **argv)
{
    char option[] = "--help";
    const struct orl_subcommand *const command = find_command(argv[2]);
    char *line[] = {argv[2], argc > 3 ? argv[3] : option, argc > 3 ? option : NULL, NULL};
    return command ? command->run(command, argc > 3 ? 3 : 2, line) : refuse_command(argv[2]);
}

/* Handles common spellings: --help, -h, help [COMMAND], --version. Returns -1 for any other. */
static int run_synonym(int argc, char **argv)
{
    if (strcmp(argv[1], "--version") == 0)
        return orl_cmd_version(find_command("version"), argc - 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0 && strcmp(argv[1], "-h") != 0 &&
        strcmp(argv[1], "help") != 0)
        return -1;
    if (argc > 2)
        return run_help(argc, argv);
    print_overview(stdout);
    return ORL_EXIT_OK;
}

int main(int argc, char **argv)
{
    const struct orl_subcommand *command;
    setvbuf(stdout, NULL, _IOLBF, 0); /* line-buffered, as command.h says */
    if (argc < 2) {
        print_overview(stderr);
        return ORL_EXIT_USAGE;
    }
    int code = run_synonym(argc, argv);
    if (code >= 0)
        return code;
    command = find_command(argv[1]);
    if (!command)
        return refuse_command(argv[1]);
    if (curl_global_init(CURL_GLOBAL_DEFAULT) != 0) {
        fprintf(stderr, "oriel: libcurl does not start\n");
        return ORL_EXIT_FAILED;
    }
    code = command->run(command, argc - 1, argv + 1);
    curl_global_cleanup();
    /* Report a full disk or a closed pipe as a failure. */
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "oriel: standard output cannot be written\n");
        code = code ? code : ORL_EXIT_FAILED;
    }
    return code;
}
