"""The command `python -m oriel`: the parts of the oriel command that use a daemon, on any system."""

import argparse
import json
import sys
from typing import Any, Callable, Dict, List, Optional, Sequence

from .client import Client
from .errors import Json, OrielError
from .jobs import Job
from .version import __version__

KINDS = ("render", "annual", "study", "bsdf_make", "bsdf_fit")


def _print_json(value: Json) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=True))


def _show_progress(status: Dict[str, Any]) -> None:
    """Writes the state to stderr: on a terminal one line that changes, else a line for each change."""
    percent, eta = status.get("percent"), status.get("eta_s")
    text = status["state"] + (" %.0f %%" % percent if percent is not None else "")
    text += ", %.0f s left" % eta if eta is not None and status["state"] == "running" else ""
    if sys.stderr.isatty():
        ended = status["state"] in ("succeeded", "failed", "cancelled")
        sys.stderr.write("\r%-60s%s" % (text, "\n" if ended else ""))
    else:
        sys.stderr.write(text + "\n")
    sys.stderr.flush()


def _print_job(job: Job, as_json: bool) -> None:
    if as_json:
        _print_json(job.status())
    else:
        print(job.id)


def _wait(job: Job, options: argparse.Namespace, cancel: bool) -> None:
    job.wait(_show_progress, options.timeout, cancel_on_interrupt=cancel)


def status(client: Client, options: argparse.Namespace) -> None:
    """Prints the daemon and its jobs, or one job."""
    if options.id:
        state = client.job(options.id).status()
        if options.json:
            _print_json(state)
        else:
            print("%(id)s  %(kind)s  %(state)s" % state)
            for warning in state.get("warnings", []):
                print("warning: " + warning)
        return
    health, jobs = client.health(), client.jobs(limit=options.limit, summary=True)
    if options.json:
        _print_json({"url": client.url, "health": health, "jobs": jobs})
        return
    print("%s: orield %s, up for %.0f s" % (client.url, health["version"], health["uptime_s"]))
    for job in jobs:
        print("%(id)s  %(kind)-9s  %(state)-10s  %(created).19s  " % job + (job["name"] or ""))


def upload(client: Client, options: argparse.Namespace) -> None:
    """Uploads a scene, and prints its id."""
    what = options.path[0] if len(options.path) == 1 else options.path
    scene = client.upload(what, weather=options.weather, states=options.states, sky=options.sky)
    if options.json:
        is_bsdf = len(options.path) == 1 and options.path[0].lower().endswith(".xml")
        _print_json({"id": str(scene)} if is_bsdf else {"id": str(scene), "summary": scene.summary})
    else:
        print(scene)


def submit(client: Client, options: argparse.Namespace) -> None:
    """Submits a job, and prints its id."""
    members: Dict[str, Any] = {"weather": options.weather, "rules": options.rules, "states": options.states,
                               "sky": _sky_of(options.sky), "kind": options.kind}
    if options.weather and not options.kind:
        members["kind"] = "annual"
    members.update(options.set)
    given = {key: value for key, value in members.items() if value is not None}
    subject = options.path[0] if len(options.path) == 1 else options.path
    job = client.submit(subject, options.name, options.tag, **given)
    if options.wait or options.output:
        try:
            _wait(job, options, cancel=True)
        finally:
            _print_job(job, options.json)
        if options.output:
            job.fetch(options.output)
    else:
        _print_job(job, options.json)


def _sky_of(text: Optional[str]) -> Json:
    return json.loads(text) if text and text.startswith("{") else text


def wait(client: Client, options: argparse.Namespace) -> None:
    """Waits for a job's end. Ctrl-C leaves the job running."""
    job = client.job(options.id)
    _wait(job, options, cancel=False)
    _print_job(job, options.json)


def fetch(client: Client, options: argparse.Namespace) -> None:
    """Downloads a job's files, and prints their paths."""
    paths = client.job(options.id).fetch(options.output, options.only or ("*",))
    if options.json:
        _print_json(paths)
    else:
        print("\n".join(paths))


def cancel(client: Client, options: argparse.Namespace) -> None:
    """Cancels a job."""
    state = client.job(options.id).cancel()
    if options.json:
        _print_json(state)
    else:
        print("%(id)s  %(state)s" % state)


def _pairs(text: str) -> Dict[str, str]:
    """Parses GROUP=STATE,..."""
    pairs = dict(part.partition("=")[::2] for part in text.split(","))
    if not all(pairs) or not all(pairs.values()):
        raise argparse.ArgumentTypeError("GROUP=STATE,... is expected, not %r" % text)
    return pairs


def _rules(text: str) -> List[str]:
    return [rule.strip() for rule in text.split(",")]


class _SetMember(argparse.Action):
    """Collects MEMBER=JSON in a dict."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any,
                 option_string: Optional[str] = None) -> None:
        member, _, text = str(values).partition("=")
        try:
            namespace.set = dict(namespace.set, **{member: json.loads(text)})
        except ValueError:
            parser.error("--set takes MEMBER=JSON, such as samples=256, not %r" % values)


def _add_project_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--weather", metavar="FILE", help="weather file, EPW or WEA")
    parser.add_argument("--states", metavar="GROUP=STATE,...", type=_pairs, help="states of a model's groups")
    parser.add_argument("--sky", help="name of one of a folder's skies")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m oriel", description="Daylight simulation by an orield daemon.")
    parser.add_argument("--version", action="version", version="oriel " + __version__)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def add(run: Callable[[Client, argparse.Namespace], None], operand: str,
            **settings: Any) -> argparse.ArgumentParser:
        one = commands.add_parser(run.__name__, help=run.__doc__, description=run.__doc__)
        one.add_argument(operand, **settings)
        one.add_argument("--server", metavar="URL|NAME", help="the daemon ($ORIEL_URL, or oriel.toml)")
        one.add_argument("--json", action="store_true", help="print JSON")
        one.set_defaults(run=run)
        return one

    id_of_job: Dict[str, Any] = {"metavar": "ID", "help": "a job's id, or its first digits"}
    paths: Dict[str, Any] = {"metavar": "PATH", "nargs": "+"}
    _fill_status(add(status, "id", nargs="?", **id_of_job))
    _add_project_options(add(upload, "path", help="a Honeybee model, folder, zip, BSDF, or Radiance files", **paths))
    _fill_submit(add(submit, "path", help="a job document, or a Honeybee model, folder, zip or Radiance files",
                     **paths))
    add(wait, "id", **id_of_job).add_argument("--timeout", metavar="SECONDS", type=float, help="longest wait")
    fetching = add(fetch, "id", **id_of_job)
    fetching.add_argument("-o", "--output", metavar="FOLDER", default=".", help="where to write (default: here)")
    fetching.add_argument("--only", metavar="PATTERN", action="append", help='only such files, as "*.png"')
    add(cancel, "id", **id_of_job)
    return parser


def _fill_status(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--limit", metavar="N", type=int, default=20, help="number of jobs to list (20)")


def _fill_submit(parser: argparse.ArgumentParser) -> None:
    _add_project_options(parser)
    parser.add_argument("--kind", choices=KINDS, help="kind of the job (annual with --weather, else render)")
    parser.add_argument("--rules", metavar="NAME,...", type=_rules, help='rules of a year, as "LEED,EN 17037"')
    parser.add_argument("--set", metavar="MEMBER=JSON", action=_SetMember, default={}, help="a member of the document")
    parser.add_argument("--name", help="name of the job")
    parser.add_argument("--tag", action="append", help="a tag of the job")
    parser.add_argument("--wait", action="store_true", help="wait for the end; Ctrl-C then cancels the job")
    parser.add_argument("--timeout", metavar="SECONDS", type=float, help="longest wait")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="wait, and download the files to this folder")


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command. Returns 0 if it is done, 1 if it failed, 2 for a wrong command line, 130 after Ctrl-C."""
    options = _parser().parse_args(arguments)
    try:
        options.run(Client(options.server), options)
    except (OrielError, TimeoutError) as error:
        print("oriel: %s" % error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0
