"""A daemon under siege: attacks, all at once and each alone, while a polite client does its work.

    python3 tests/torture/siege.py BUILD [--seconds N] [--only NAME,...] [--keep]

Half of the time goes to all at once, the other half to each alone. The daemon wants tokens: each
attack has one of its own, and so has the polite client, which uploads a scene, submits a job of it,
polls until it has ended, and fetches the result, over and over. Whatever fails ends with status 1:

- a POST of the polite client's takes more than 1 s, or a poll more than 50 ms, by the 99th
  percentile; one of its jobs is lost, fails, or is blamed for what others did;
- the daemon ends, or its memory does not come back to what it was;
- SIGTERM, in the midst of all attacks, is not obeyed within its limit;
- what is kept is damaged (orield scrub).

Where cgroups can be written, the daemon has one of 2 GB.
"""

import argparse
import http.client
import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import attacks
from daemon import Daemon, Failure

POST_S, POLL_S = 1.0, 0.05
CGROUP_BYTES = 2 << 30
GROWTH_BYTES = 96 << 20  # shelf and caches of jobs that have run may stay
DRAIN_S = 2  # of the daemon; and as much again for all else
ENDED = ("succeeded", "failed", "cancelled")


class Cgroup:
    """Memory bounded, where that can be had; v1 and v2."""

    def __init__(self):
        name = "oriel-siege-%d" % os.getpid()
        self.path = None
        for root, limit in (("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
                            ("/sys/fs/cgroup", "memory.max")):
            path = os.path.join(root, name)
            try:
                os.mkdir(path)
                self.path = path
                with open(os.path.join(path, limit), "w", encoding="ascii") as stream:
                    stream.write(str(CGROUP_BYTES))
                return
            except OSError:
                self.remove()

    def enter(self, pid):
        if self.path:
            with open(os.path.join(self.path, "cgroup.procs"), "w", encoding="ascii") as stream:
                stream.write(str(pid))

    def remove(self):
        if self.path:
            try:
                os.rmdir(self.path)
            except OSError:
                pass
        self.path = None


class Polite:
    """Does its work, and notes what it has to wait."""

    def __init__(self, port, token):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        self.token, self.number = token, 0
        self.posts, self.polls, self.jobs = [], [], 0

    def _ask(self, method, path, body=None, want=(200,), times=None):
        headers = dict(self.token, **({"Content-Type": "application/json"} if body else {}))
        data = json.dumps(body).encode() if body else None
        began = time.monotonic()
        self.connection.request(method, path, data, headers)
        answer = self.connection.getresponse()
        text = answer.read()
        if times is not None:
            times.append(time.monotonic() - began)
        if answer.status not in want:
            raise Failure("%s %s: %d %r" % (method, path, answer.status, text[:300]))
        return json.loads(text)

    def once(self):
        """One round."""
        self.number += 1
        text = attacks.ROOM + "# %d\n" % self.number
        scene = self._ask("POST", "/v1/scenes", {"files": [{"name": "room.rad", "text": text}]},
                          (200, 201), self.posts)["id"]
        job = self._ask("POST", "/v1/jobs", {
            "scene": scene, "seed": self.number, "technique": "backward", "gather_samples": 64,
            "sensors": [[1, 1, 1, 0, 0, 1]]}, (202,), self.posts)
        path = "/v1/jobs/" + job["id"]
        until = time.monotonic() + 120
        while job["state"] not in ENDED:
            if time.monotonic() > until:
                raise Failure("%s waits for ever: %s" % (path, job))
            time.sleep(0.02)
            job = self._ask("GET", path, times=self.polls)
        if job["state"] != "succeeded":
            raise Failure("%s %s: %s" % (path, job["state"], job.get("error")))
        self._ask("GET", path + "/result")
        self.jobs += 1

    def longest_turn(self):
        """Seconds, of the loop."""
        self.connection.request("GET", "/metrics", headers=self.token)
        text = self.connection.getresponse().read().decode()
        return next(float(line.split()[1]) for line in text.split("\n")
                    if line.startswith("oriel_loop_longest_turn_seconds "))


def percentile(times, share=0.99):
    return sorted(times)[int(share * (len(times) - 1))] if times else 0.0


def resident(pid):
    """Bytes of the process and its children, files left aside."""
    total = 0
    children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True,
                              text=True, check=False).stdout.split()
    for one in [str(pid)] + children:
        try:
            with open("/proc/%s/status" % one, encoding="ascii") as stream:
                total += next(int(line.split()[1]) << 10 for line in stream
                              if line.startswith("RssAnon:"))
        except (OSError, StopIteration):
            pass
    return total


class Siege:
    def __init__(self, build, names):
        self.build, self.root = build, tempfile.mkdtemp(prefix="oriel-siege-")
        self.attacks = [one for one in attacks.ATTACKS if not names or one.__name__ in names]
        self.tokens = {name: self._token(name)
                       for name in ["polite"] + [one.__name__ for one in self.attacks]}
        self.cgroup = Cgroup()
        self.daemon = Daemon(build, self.root, (
            "--tokens", "always", "--storage-budget", "2G", "--drain-timeout", str(DRAIN_S),
            "--idle-timeout", "10", "--log-level", os.environ.get("SIEGE_LOG", "warn")))
        self.cgroup.enter(self.daemon.process.pid)
        if not self.daemon.wait_listening():
            raise Failure("the daemon did not start: %s.log" % self.root)
        self.polite = Polite(self.daemon.port, self.tokens["polite"])
        self.failures = []

    def _token(self, name):
        text = subprocess.check_output([
            os.path.join(self.build, "orield"), "token", "add", name.replace("_", "-"), "--data",
            self.root], text=True)
        return {"Authorization": "Bearer " + text.strip()}

    def attack(self, which):
        """Processes that do."""
        begun = []
        os.environ["SIEGE_DAEMON"] = str(self.daemon.process.pid)
        for one in which:
            process = multiprocessing.Process(target=attacks.run, daemon=True, args=(
                one, self.daemon.port, self.tokens[one.__name__]))
            process.start()
            begun.append(process)
        return begun

    def phase(self, name, which, seconds):
        """The polite client beside these."""
        polite, until = self.polite, time.monotonic() + seconds
        polite.posts, polite.polls, polite.jobs = [], [], 0
        begun = self.attack(which)
        peak = 0
        try:
            while time.monotonic() < until:
                polite.once()
                peak = max(peak, resident(self.daemon.process.pid))
        finally:
            for process in begun:
                process.terminate()
                process.join()
        post_s, poll_s = percentile(polite.posts), percentile(polite.polls)
        good = post_s <= POST_S and poll_s <= POLL_S
        if not good:
            self.failures.append("%s: POST p99 %.2f s, poll p99 %.1f ms" % (
                name, post_s, 1000 * poll_s))
        print("%-16s %5d jobs  POST p99 %6.3f s  poll p99 %7.2f ms (%d)  longest turn %6.1f ms  "
              "peak %5d MB%s" % (name, polite.jobs, post_s, 1000 * poll_s, len(polite.polls),
                                 1000 * polite.longest_turn(), peak >> 20,
                                 "" if good else "  TOO SLOW"), flush=True)

    def check_memory(self, before):
        """Comes back once the attacks are over."""
        until = time.monotonic() + 30
        after = resident(self.daemon.process.pid)
        while after > before + GROWTH_BYTES and time.monotonic() < until:
            time.sleep(1)
            after = resident(self.daemon.process.pid)
        print("memory           %d MB before, %d MB after" % (before >> 20, after >> 20))
        if after > before + GROWTH_BYTES:
            self.failures.append("memory does not come back")

    def stop(self):
        """SIGTERM beside all attacks."""
        begun = self.attack(self.attacks)
        time.sleep(3)
        began = time.monotonic()
        self.daemon.process.send_signal(signal.SIGTERM)
        try:
            status = self.daemon.process.wait(60)
        except subprocess.TimeoutExpired:
            self.daemon.kill()
            status = self.daemon.process.wait()
        took = time.monotonic() - began
        for process in begun:
            process.terminate()
            process.join()
        print("SIGTERM          status %d after %.1f s" % (status, took))
        if status != 0 or took > 2 * DRAIN_S + 4:
            self.failures.append("SIGTERM: status %d after %.1f s" % (status, took))

    def run(self, seconds):
        for _ in range(3):
            self.polite.once()
        before = resident(self.daemon.process.pid)
        alone = seconds / 2 / max(1, len(self.attacks))
        self.phase("nobody", [], min(5, alone))
        for one in self.attacks:
            self.phase(one.__name__, [one], alone)
        self.phase("all at once", self.attacks, seconds / 2)
        self.check_memory(before)
        self.stop()
        scrub = subprocess.run([os.path.join(self.build, "orield"), "scrub", "--data", self.root],
                               capture_output=True, text=True, check=False)
        print("scrub            " + scrub.stdout.strip().split("\n")[-1])
        if scrub.returncode != 0:
            self.failures.append("scrub: " + scrub.stdout)

    def end(self, keep):
        if self.daemon.process.poll() is None:
            self.daemon.kill()
        self.daemon.process.wait()
        self.cgroup.remove()
        if not keep:
            shutil.rmtree(self.root)
            os.unlink(self.root + ".log")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("build")
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--only", default="", help="names of attacks, with commas")
    parser.add_argument("--keep", action="store_true", help="leave the data folder")
    arguments = parser.parse_args()
    siege = Siege(arguments.build, [one for one in arguments.only.split(",") if one])
    print("siege: %d attacks, %g s, %s" % (
        len(siege.attacks), arguments.seconds,
        "in a cgroup of 2 GB" if siege.cgroup.path else "without a cgroup"), flush=True)
    try:
        siege.run(arguments.seconds)
    except (Failure, OSError, http.client.HTTPException) as failure:
        siege.failures.append("%s (daemon: %s)" % (failure, siege.daemon.process.poll()))
    siege.end(arguments.keep or bool(siege.failures))
    for failure in siege.failures:
        print("FAILED: %s; see %s.log" % (failure, siege.root))
    return 1 if siege.failures else 0


if __name__ == "__main__":
    sys.exit(main())
