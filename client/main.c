/* oriel: the command line. A static table lists the commands and their help. */
#include <stdio.h>
#include <string.h>

#include <curl/curl.h>
#include <oriel/base/version.h>

#include "options/command.h"

static const struct orl_subcommand commands[] = {
    {"run",
     "JOB.json|PROJECT -o DIR [--sky SKY] [--states GROUP=STATE,...] [--threads N]\n"
     "  [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Render a job here, without a daemon",
     "JOB.json lists the scene's files as {\"files\": [...]}, relative to the document.\n"
     "Images and result.json are written to DIR, photon maps to DIR/maps, where later runs\n"
     "reuse them. For a project (a Honeybee model, or a folder exported by Honeybee), all\n"
     "grids and views are rendered under their names, with the project's own sky or the\n"
     "one given by --sky.",
     orl_cmd_run},
    {"plan", "JOB.json|PROJECT [--json] [--threads N]",
     "Show the technique and effects that a job would use, and the time for accuracies",
     "Prints a row for each effect of light: whether it is simulated, the largest error at\n"
     "any sensor or pixel without it (lux, or a fraction), the estimated time saved\n"
     "(seconds of one thread), and the reason. The job's \"effects\" can force or skip each\n"
     "effect. Then two small rounds of path tracing predict the seconds that jobs with\n"
     "given accuracies take here.",
     orl_cmd_plan},
    {"project", "MODEL.hbjson|FOLDER|FILE.rif|FILE.cfg [-o DIR]",
     "List the contents of a Honeybee model or folder: scene, grids, views, skies, states",
     "Prints JSON: the scene's files in reading order; the names of grids, views and\n"
     "skies; the states of dynamic parts; and the files that are left out, with reasons.\n"
     "With -o, a model's Radiance files are written to DIR, with a job.json that names\n"
     "them.",
     orl_cmd_project},
    {"annual",
     "JOB.json|PROJECT -o DIR [--weather FILE [--year YEAR]] [--rules NAME,...] [--cache DIR]\n"
     "  [--honeybee] [--ill] [--phases] [--threads N] [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Compute a year of daylight: metrics and verdicts with their intervals",
     "JOB.json names a scene without a sky, a weather file (EPW or WEA) and grids of\n"
     "sensors. Optional members are hours of use, metrics, targets (\"sDA300/50 >= 55 %\")\n"
     "and rules (\"LEED\", \"EN 17037\"). Writes result.json, sensors.csv, hours.csv, maps of\n"
     "every grid over the plan and over the year, and a one-page summary of every grid\n"
     "(PDF). --honeybee writes all hours to DIR/results in Honeybee's format, --ill as\n"
     "Radiance matrices; --phases adds the matrices of the three- and five-phase methods.\n"
     "A project (a Honeybee model or folder) can be given in place of the document. Then\n"
     "all its grids and the states of its windows are used, and --weather is required.",
     orl_cmd_annual},
    {"recipe", "NAME [MODEL] [--inputs FILE.json] [--INPUT VALUE ...] -o DIR [--threads N]",
     "Run a recipe of Ladybug Tools: the same inputs, the same folders of results",
     "NAME is one of: point-in-time-grid, point-in-time-view, daylight-factor,\n"
     "annual-daylight, annual-daylight-enhanced, annual-daylight-en17037, direct-sun-hours,\n"
     "imageless-annual-glare, leed-daylight-option-one, leed-daylight-option-two,\n"
     "breeam-daylight-4b, well-daylight, sky-view. Inputs have the recipe's names, as options\n"
     "or in the file that lbt-recipes writes; `oriel recipe NAME --help` lists them. DIR gets\n"
     "the recipe's results, and DIR/oriel the files of Oriel's own job.",
     orl_cmd_recipe},
    {"verify", "RESULT [--files DIR] [--threads N]",
     "Repeat a year from the provenance in its result, and compare the bytes",
     "RESULT is a year's result.json, or the folder that contains it and the year's other\n"
     "files. Inputs are searched by name below --files and must have the digests that the\n"
     "result names. Exit codes: 0 if all bytes are equal; 1 if some differ, with each such\n"
     "file named; 2 if the year cannot be repeated, because an input has changed or is\n"
     "missing.",
     orl_cmd_verify},
    {"part", "FILE", "Compute one part of a job that is divided into parts",
     "FILE is written by run, annual, study or bsdf make with --parts or --slurm. These\n"
     "commands start this one themselves, or through Slurm. The results are written beside\n"
     "FILE.",
     orl_cmd_part},
    {"study", "STUDY.json -o DIR [--threads N] [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Measure accuracy against time, for techniques and settings",
     "Runs every technique with every number of photons and samples that STUDY.json lists,\n"
     "each with several seeds, and compares the results with a long unbiased run. Writes\n"
     "study.json, study.csv, study.svg and study.png to DIR. Times are for one thread\n"
     "unless --threads gives another number.",
     orl_cmd_study},
    {"submit",
     "JOB.json|PROJECT [--name NAME] [--tags TAG,...] [--server URL] [--wait]\n"
     "  [--sky SKY] [--states GROUP=STATE,...] [--weather FILE [--year YEAR] [--rules NAME,...]]",
     "Send a job, study or year, and the files it needs, to a daemon",
     "Uploads the scene's files and all files that they refer to, then prints the job's\n"
     "id. A project is rendered as by `oriel run`. With --weather, its year is computed as\n"
     "by `oriel annual`.",
     orl_cmd_submit},
    {"status",
     "[ID] [--state STATE] [--tag TAG] [--scene ID] [--since TIME] [--limit N] [--server URL]",
     "Show one job, or the latest jobs",
     "Without an id, prints one line per job: name (or else tags), state, progress, time\n"
     "left or place in the queue, and for jobs with a goal the relative error so far. An\n"
     "id can be shortened to its first digits, here and in the other commands.",
     orl_cmd_status},
    {"watch", "[--tag TAG] [--server URL]", "Show all jobs as they change, one line per change",
     "First lists the existing jobs. Then prints a line, in the format of status, for each\n"
     "new job or state, for the error after each round, and for each 10 % of progress. If\n"
     "the daemon restarts, the command waits for it. Ends with Ctrl-C.",
     orl_cmd_watch},
    {"wait", "ID [--server URL]", "Follow a job to its end, with progress",
     "Exit codes: 0 if the job succeeded, 1 if it failed or was cancelled. If the daemon\n"
     "restarts, the command waits for it.",
     orl_cmd_wait},
    {"fetch", "ID -o DIR [--server URL]", "Download a finished job's results",
     "Downloads result.json and the job's other files: the images of a render job;\n"
     "study.csv, study.svg and study.png of a study; tables, maps, temporal maps and pages\n"
     "of a year, in subfolders where the result has them.",
     orl_cmd_fetch},
    {"cancel", "ID [--server URL]", "Stop a job, and wait until it has stopped", NULL,
     orl_cmd_cancel},
    {"remove", "job|scene|bsdf ID... [--server URL]", "Remove jobs, scenes or BSDFs from a daemon",
     "A job must have ended; its results are removed with it. A scene can be removed if no\n"
     "waiting or running job needs it, a BSDF if no scene contains it. Photon maps: oriel\n"
     "maps --remove.",
     orl_cmd_remove},
    {"list", "scenes|bsdfs [--server URL]",
     "List the scenes or BSDFs that a daemon stores, the latest first",
     "For a scene: its size, the numbers of all its jobs and of unfinished ones, and the\n"
     "time of last use. For a BSDF: its size, the number of scenes that contain it, and\n"
     "its name.",
     orl_cmd_list},
    {"link", "ID FILE... [--seconds N] [--server URL]",
     "Print temporary addresses of results that need no token",
     "Anyone who has an address can read that file, with any program, until the address\n"
     "expires or the token that requested it is revoked.",
     orl_cmd_link},
    {"maps", "[--remove KEY] [--server URL]",
     "List the photon maps and BSDFs that a daemon stores, and the time they saved",
     "With --remove, removes the one whose key begins with KEY. A job that needs it builds\n"
     "it again.",
     orl_cmd_maps},
    {"upload",
     "scene FILE... | scene FOLDER|ZIP|MODEL.hbjson [FILE...] | bsdf FILE  [--server URL]",
     "Upload a scene or a BSDF, and print its id",
     "A scene's files are named relative to the working directory, or to the folder, as\n"
     "the scene's texts refer to them. The main files of a folder are those named after\n"
     "it. By default they are the folder's .rad files that no command in another file\n"
     "names, in the order of their names. All files that these refer to are included. A\n"
     "zip of a folder is sent as it is, and the daemon unpacks it. A Honeybee model is\n"
     "sent as it is, too, and the daemon translates it.",
     orl_cmd_upload},
    {"bsdf",
     "check FILE [--json] | fit DATA... -o FILE.xml [...]\n"
     "  | make PANEL.rad... -o FILE.xml [...]\n"
     "  | convert FILE -o FILE.xml [...] | compare FILE FILE [--report FILE]\n"
     "  | plot FILE [FILE] -o PICTURE [...]",
     "Check a BSDF file, or make one from measurements or geometry",
     "make computes the BSDF of a panel on a virtual goniophotometer. The panel is given\n"
     "by scene files of any geometry and materials in the xy plane, y up, z towards the\n"
     "inside; it is repeated without end. Files can be replaced by a document (FILE.json,\n"
     "\"kind\": \"bsdf_make\"). `oriel bsdf make --help` lists its options.\n"
     "convert changes the basis, resolution or cull of a BSDF, and prints the loss.\n"
     "compare prints the differences of two BSDFs: in total, in cones of two degrees, and\n"
     "light that is sent elsewhere.\n"
     "plot draws the scattering of light from one direction, and for two files also their\n"
     "difference. `oriel bsdf plot --help` lists its options.\n"
     "fit fits a BSDF to goniophotometer measurements: pab-opto's text files, with an\n"
     "incident direction each, or CSV with columns theta_in, phi_in, theta_out, phi_out\n"
     "and bsdf or dsf (degrees, theta from the inside's normal). Files can be replaced by\n"
     "a document (\"kind\": \"bsdf_fit\"). fit reports how well each direction is predicted by\n"
     "the others. `oriel bsdf fit --help` lists its options.\n"
     "check prints type and resolution, reflectance and transmittance by direction, and\n"
     "problems: gain of energy, violated reciprocity, wrong sides or up direction, and\n"
     "blurring of the sun. Exit code 1 if the file is refused or faulty.",
     orl_cmd_bsdf},
    {"glare", "PICTURE.hdr [-d] [--json] [--task X,Y,ANGLE] ...",
     "Find the glare sources of an HDR picture, and compute glare metrics",
     "Computes DGP and other indices of any Radiance picture with a VIEW line, with\n"
     "evalglare's definitions and defaults; core/metrics/evalglare.md lists the\n"
     "differences. Options -b -T -r -s -x -Y -A -i -d are evalglare's.",
     orl_cmd_glare},
    {"version", "", "Print the version", NULL, orl_cmd_version},
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
        fprintf(to, "  %-8s %s\n", commands[i].name, commands[i].summary);
    fprintf(
        to,
        "\n`oriel COMMAND --help` shows details. Daemon: --server URL, or $ORIEL_URL, or\n"
        "http://127.0.0.1:8423; access token: $ORIEL_TOKEN; own CA certificate: $ORIEL_CA.\n"
        "The daemon's queue alternates between clients. Without tokens, a client is identified\n"
        "by $ORIEL_CLIENT or the user's name.\n"
        "Exit codes: 0 done, 1 failed, 2 wrong command line.\n");
}

/* Handles common spellings: --help, -h, help [COMMAND], --version. Returns -1 for any other. */
static int run_synonym(int argc, char **argv)
{
    if (strcmp(argv[1], "--version") == 0)
        return orl_cmd_version(find_command("version"), 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0 && strcmp(argv[1], "-h") != 0 &&
        strcmp(argv[1], "help") != 0)
        return -1;
    if (argc > 2 && find_command(argv[2])) {
        char help[] = "--help";
        char *line[] = {argv[2], help, NULL};
        return find_command(argv[2])->run(find_command(argv[2]), 2, line);
    }
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
    if (!command) {
        fprintf(stderr, "oriel: there is no command \"%s\". Try `oriel --help`.\n", argv[1]);
        return ORL_EXIT_USAGE;
    }
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

int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_operands operands;
    int code;
    if (!orl_options_parse(self, argc, argv, NULL, 0, 0, 0, &operands, &code))
        return code;
    printf("oriel %s\n", ORL_VERSION);
    return ORL_EXIT_OK;
}
