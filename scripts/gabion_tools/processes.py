"""The three processes of a run: started, watched, stopped. Nothing is left behind, whatever happens."""

import ctypes
import os
import secrets
import selectors
import signal
import subprocess
import time

from gabion_tools.errors import Failure
from gabion_tools.places import executable, short

LISTEN_DEADLINE = 20.0  # s, from start to the line LISTENING
STOP_GRACE = 5.0        # s, from terminate to kill
REPORT_GRACE = 10.0     # s, for the coupler to report an engine that has died
PR_SET_PDEATHSIG = 1


def die_with_parent():
    """In the child: end when the launcher is killed outright and cannot stop it any more."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def tail(path, lines=15):
    try:
        text = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    return "\n".join("  " + line for line in text[-lines:])


def stop(process):
    """Terminate, then kill."""
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(STOP_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def checkpoint_hint(folder):
    """Where a run that was broken off can be taken up again; empty when it cannot."""
    if not (folder / "checkpoint").exists():
        return ""
    return f"\nlast checkpoint: {short(folder / 'checkpoint')}; go on with gabion resume {short(folder)}"


class Engine:
    """One dem_server or continuum_server, from its start to its end; a context manager."""

    def __init__(self, name, log_path, token, threads):
        self.name, self.log_path = name, log_path
        self.log = open(log_path, "w", encoding="utf-8")
        command = [str(executable(name)), "--listen", "127.0.0.1:0", "--threads", str(threads)]
        # A session of its own: Ctrl-C reaches the launcher only, which then stops the engines in order.
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=self.log,
                                            env={"OMP_WAIT_POLICY": "passive", **os.environ, "GABION_TOKEN": token}, start_new_session=True,
                                            preexec_fn=die_with_parent)
        except OSError as error:
            self.log.close()
            raise Failure(f"{name} cannot be started: {error}") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        stop(self.process)
        self.process.stdout.close()
        self.log.close()

    def address(self):
        """HOST:PORT from the line LISTENING. Raises Failure when it does not come."""
        line, end = b"", time.monotonic() + LISTEN_DEADLINE
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            while not line.endswith(b"\n"):
                left = end - time.monotonic()
                if left <= 0 or not selector.select(left):
                    raise Failure(f"{self.name} said nothing for {LISTEN_DEADLINE:.0f} s after its start; "
                                  f"see {short(self.log_path)}")
                data = os.read(self.process.stdout.fileno(), 1024)
                if not data:
                    code = self.process.wait()
                    raise Failure(f"{self.name} ended with code {code} before it was listening. The end of "
                                  f"{short(self.log_path)}:\n{tail(self.log_path)}")
                line += data
        words = line.decode(errors="replace").split()
        if len(words) != 3 or words[0] != "LISTENING":
            raise Failure(f"{self.name} said '{line.decode(errors='replace').strip()}' where LISTENING HOST PORT "
                          "was expected")
        return f"{words[1]}:{words[2]}"


def couple(scene, overrides, out, engines, overwrite=False, quiet=False):
    """Starts the engines ({name: threads}), runs the coupler and returns its exit code."""
    token = secrets.token_hex(16)
    started = []
    try:
        for name, threads in engines.items():
            started.append(Engine(name, out / f"{name}.log", token, threads))
        command = [str(executable("coupler")), str(scene), "--out", str(out), *overrides]
        for engine in started:
            command += ["--" + engine.name.removesuffix("_server"), engine.address()]
        if overwrite:
            command.append("--overwrite")
        return watch(command, started, token, out / "coupler.log" if quiet else None)
    finally:
        for engine in reversed(started):
            engine.__exit__()


def watch(command, engines, token, log_path):
    """Runs the coupler; ends it when an engine has died and it has not noticed."""
    log = open(log_path, "w", encoding="utf-8") if log_path else None
    died = None
    coupler = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
                               env={"OMP_WAIT_POLICY": "passive", **os.environ, "GABION_TOKEN": token}, preexec_fn=die_with_parent)
    try:
        while True:
            try:
                code = coupler.wait(0.1)
                break
            except subprocess.TimeoutExpired:
                pass
            ended = [engine for engine in engines if engine.process.poll() not in (None, 0)]
            died = died or (time.monotonic() if ended else None)
            if died and time.monotonic() - died > REPORT_GRACE:
                engine = ended[0]
                raise Failure(f"{engine.name} ended with code {engine.process.returncode} and the coupler did not "
                              f"notice. The end of {short(engine.log_path)}:\n{tail(engine.log_path)}"
                              + checkpoint_hint(engine.log_path.parent))
    except KeyboardInterrupt:
        coupler.send_signal(signal.SIGINT)  # lets it close its files
        try:
            coupler.wait(STOP_GRACE)
        except subprocess.TimeoutExpired:
            pass
        raise
    finally:
        stop(coupler)
        if log:
            log.close()
    for engine in engines:
        if code not in (0, 2) and engine.process.poll() not in (None, 0):
            text = tail(engine.log_path)
            if text and not log:
                print(f"{engine.name} ended with code {engine.process.returncode}; the end of "
                      f"{short(engine.log_path)}:\n{text}", flush=True)
    return code
