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
     "JOB.json names its scene as {\"files\": [...]}, relative to the document. Images and\n"
     "result.json go to DIR, photon maps to DIR/maps, where the next run finds them again. A "
     "project\n"
     "(a Honeybee model, or the folder that Honeybee exports of one) has its grids and views\n"
     "rendered, by their names, under a sky of its own or that of --sky.",
     orl_cmd_run},
    {"plan", "JOB.json|PROJECT [--json] [--threads N]",
     "Show which technique and effects a job would get, and what accuracies take",
     "Prints a row for each effect of light: is it simulated, what does leaving it out cost any\n"
     "sensor or pixel at most (lux, or a share), what does it save (estimated seconds of one\n"
     "thread), and why. The job's \"effects\" can force or skip each. Then, from two small rounds\n"
     "by paths, the seconds that jobs for an accuracy would take here.",
     orl_cmd_plan},
    {"project", "MODEL.hbjson|FOLDER|FILE.rif|FILE.cfg [-o DIR]",
     "Show what a Honeybee model or folder holds: scene, grids, views, skies, states",
     "Prints, as JSON, which files make the scene, in their order; the names of its grids, views "
     "and\n"
     "skies, and the states of its moving parts; and what was left out, and why. With -o, a "
     "model's\n"
     "Radiance files go to DIR, with job.json that names them.",
     orl_cmd_project},
    {"annual",
     "JOB.json|PROJECT -o DIR [--weather FILE [--year YEAR]] [--rules NAME,...] [--cache DIR]\n"
     "  [--honeybee] [--ill] [--phases] [--threads N] [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Daylight over a year: metrics and verdicts with their intervals",
     "JOB.json names a scene without a sky, a weather file (EPW or WEA) and grids of sensors; and, "
     "if\n"
     "it likes, hours of use, metrics, targets (\"sDA300/50 >= 55 %\") and rules (\"LEED\",\n"
     "\"EN 17037\"). Leaves result.json, sensors.csv, hours.csv, maps of every grid over the plan "
     "and\n"
     "over the year, and a page of each to show (PDF). With --honeybee all hours go to DIR/results "
     "as\n"
     "Honeybee keeps them, with --ill to Radiance matrices; --phases adds those of the three- and\n"
     "five-phase methods. A project (a Honeybee model or folder) takes the document's place, with "
     "all\n"
     "of its grids and the states of its windows: then --weather is wanted.",
     orl_cmd_annual},
    {"verify", "RESULT [--files DIR] [--threads N]",
     "Repeat a year from its result's provenance, and compare bytes",
     "RESULT is a year's result.json, or the folder that it is in with its files. Inputs are "
     "looked\n"
     "for by their names below --files, and are to have the digests that the result names. Ends "
     "with\n"
     "0 when all bytes are the same, 1 when some are not, each file named, and 2 when the year\n"
     "cannot be repeated: an input is another by now, or absent.",
     orl_cmd_verify},
    {"part", "FILE", "Do one part of a job that is done in parts",
     "FILE is one that run, annual, study or bsdf make with --parts or --slurm has written; they\n"
     "start this themselves, or have Slurm start it. What comes of it lies beside FILE.",
     orl_cmd_part},
    {"study", "STUDY.json -o DIR [--threads N] [--parts N] [--slurm [--sbatch OPTIONS]]",
     "Show what accuracy costs in time, by techniques and settings",
     "Runs every technique at every number of photons and samples that STUDY.json lists, with\n"
     "several seeds, and compares them with a long unbiased one. Leaves study.json, study.csv,\n"
     "study.svg and study.png in DIR. Times are of one thread unless --threads says more.",
     orl_cmd_study},
    {"submit",
     "JOB.json|PROJECT [--name NAME] [--tags TAG,...] [--server URL] [--wait]\n"
     "  [--sky SKY] [--states GROUP=STATE,...] [--weather FILE [--year YEAR] [--rules NAME,...]]",
     "Send a job, study or year, and the files it needs, to a daemon",
     "Uploads the scene's files and everything they refer to, then prints the job's id. A project\n"
     "is rendered as by `oriel run`, and with --weather its year told as by `oriel annual`.",
     orl_cmd_submit},
    {"status",
     "[ID] [--state STATE] [--tag TAG] [--scene ID] [--since TIME] [--limit N] [--server URL]",
     "Show one job, or the latest ones",
     "Without an id a line each: name (else tags), state, progress, time left or place in the "
     "queue,\n"
     "and the relative error so far of jobs with a goal. The first digits of an id do for an id, "
     "here\n"
     "as for the other commands.",
     orl_cmd_status},
    {"watch", "[--tag TAG] [--server URL]", "Show all jobs as they change, a line each",
     "First those that are there, then what becomes of them and what is new: a line, as status "
     "has\n"
     "it, for each new state, each round's error and each tenth of the way. A daemon that "
     "restarts\n"
     "in between is waited for. Ends with Ctrl-C.",
     orl_cmd_watch},
    {"wait", "ID [--server URL]", "Follow a job to its end, with progress",
     "Ends with 0 when the job succeeded, 1 when it failed or was cancelled. A daemon that\n"
     "restarts in between is waited for.",
     orl_cmd_wait},
    {"fetch", "ID -o DIR [--server URL]", "Download a finished job's results",
     "result.json and the files that belong to it: a job's images; a study's study.csv, study.svg\n"
     "and study.png; a year's tables, maps, carpets and pages, in folders where it has such.",
     orl_cmd_fetch},
    {"cancel", "ID [--server URL]", "Stop a job, and wait until it has stopped", NULL,
     orl_cmd_cancel},
    {"remove", "job|scene|bsdf ID... [--server URL]", "Have a daemon forget what it keeps",
     "A job that has ended goes with its results; a scene when no job waits for it or runs, and a\n"
     "BSDF when no scene has it. Photon maps: oriel maps --remove.",
     orl_cmd_remove},
    {"list", "scenes|bsdfs [--server URL]", "List the uploads a daemon keeps, the latest first",
     "A scene's size, the jobs that had it and those under way, and when it was last used; a "
     "BSDF's\n"
     "size, how many scenes have it, and its name.",
     orl_cmd_list},
    {"link", "ID FILE... [--seconds N] [--server URL]",
     "Print addresses of results that need no token, for a while",
     "Whoever has one may read that file, from any program, until its time is over or the token "
     "that\nasked for it is revoked.",
     orl_cmd_link},
    {"maps", "[--remove KEY] [--server URL]",
     "List photon maps and BSDFs a daemon keeps, and what they saved",
     "With --remove it removes the one whose key begins so. A job that needs it makes it anew.",
     orl_cmd_maps},
    {"upload",
     "scene FILE... | scene FOLDER|ZIP|MODEL.hbjson [FILE...] | bsdf FILE  [--server URL]",
     "Send a scene or a BSDF; prints its id",
     "A scene's files are named relative to the working directory, or to the folder, as its texts\n"
     "refer to them. A folder's scene is made of the files named behind it, else of the .rad "
     "files\n"
     "in it that no command of another names, in the order of their names; what these refer to\n"
     "goes along. A zip of a folder is sent whole, and unpacked by the daemon; and so is a "
     "Honeybee\n"
     "model, which it translates.",
     orl_cmd_upload},
    {"bsdf",
     "check FILE [--json] | fit DATA... -o FILE.xml [...]\n"
     "  | make PANEL.rad... -o FILE.xml [...]\n"
     "  | convert FILE -o FILE.xml [...] | compare FILE FILE [--report FILE]\n"
     "  | plot FILE [FILE] -o PICTURE [...]",
     "Look a BSDF file over, or make one of measurements or geometry",
     "make measures a panel on a virtual goniophotometer: scene files of any geometry and "
     "materials\n"
     "in the xy plane, y up, z towards the inside, repeated without end; `oriel bsdf make --help`\n"
     "has its options. In place of files it takes a document (FILE.json, \"kind\": "
     "\"bsdf_make\").\n"
     "convert brings one into another basis, resolution or cull, and prints what is lost, as "
     "compare\n"
     "does of two: in all, in cones of two degrees, and what goes elsewhere.\n"
     "plot draws where light from a direction goes, of two files with their differences; "
     "`oriel bsdf\nplot --help` has its options.\n"
     "fit takes what a goniophotometer measured: pab-opto's text files, an incident direction "
     "each, "
     "or\n"
     "CSV with columns theta_in, phi_in, theta_out, phi_out and bsdf or dsf (degrees, theta from "
     "the\n"
     "inside's normal); or a document (\"kind\": \"bsdf_fit\"). It says how well each direction is "
     "told\nby the others; `oriel bsdf fit --help` has its options.\n"
     "check prints type and resolution, reflectance and transmittance by direction, and what is "
     "wrong "
     "or\n"
     "worth knowing: energy gained, reciprocity, sides and up, the sun's smear. Ends with 1 when\n"
     "the file is refused or at fault.",
     orl_cmd_bsdf},
    {"glare", "PICTURE.hdr [-d] [--json] [--task X,Y,ANGLE] ...",
     "Find the glare sources of an HDR picture, and rate them",
     "DGP and other indices of any Radiance picture with a VIEW line, as evalglare has them and\n"
     "with its defaults; core/metrics/evalglare.md says where the two differ. Options -b -T -r -s "
     "-x\n"
     "-Y -A -i -d are evalglare's.",
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
    fprintf(to,
            "\n`oriel COMMAND --help` says more. Daemon: --server URL, or $ORIEL_URL, or\n"
            "http://127.0.0.1:8423; its access token: $ORIEL_TOKEN; a CA of your own: $ORIEL_CA.\n"
            "Clients take turns, by $ORIEL_CLIENT or the user's name where there are no tokens.\n"
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
    int code;

    setvbuf(stdout, NULL, _IOLBF, 0); /* line-buffered, as command.h says */
    if (argc < 2) {
        print_overview(stderr);
        return ORL_EXIT_USAGE;
    }
    code = run_synonym(argc, argv);
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

/* oriel version: prints the version. */

int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_operands operands;
    int code;

    if (!orl_options_parse(self, argc, argv, NULL, 0, 0, 0, &operands, &code))
        return code;
    printf("oriel %s\n", ORL_VERSION);
    return ORL_EXIT_OK;
}
