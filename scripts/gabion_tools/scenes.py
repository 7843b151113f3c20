"""Finding a scene and reading the little of it that the launcher needs."""

import json
import re
from pathlib import Path

from gabion_tools.errors import UserError, advice
from gabion_tools.places import SCENARIOS, short

MODELS = ("dem", "continuum", "bridging", "edge")


def find(name):
    """Path of a scene given as a file, or as the name of one of scenarios/. Raises UserError with the nearest name."""
    given = Path(name)
    for candidate in (given, SCENARIOS / name, SCENARIOS / f"{name}.json"):
        if candidate.is_file():
            return Path(short(candidate.resolve()))  # as messages will name it
    known = sorted(path.stem for path in SCENARIOS.glob("*.json") if not path.stem.endswith("schema"))
    raise UserError(f"no scene '{name}': neither a file nor a name in scenarios/; {advice(given.stem, known)}")


def without_comments(text):
    """Scenes are JSON with // and /* */ comments; those inside strings stay."""
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda found: found[1] or "", text, flags=re.DOTALL)


def model(path, overrides):
    """The scene's model, overrides included; None where the coupler will complain anyway."""
    for override in reversed(overrides):
        key, _, value = override.partition("=")
        if key.strip() == "model":
            return value.strip().strip('"')
    try:
        return json.loads(without_comments(path.read_text(encoding="utf-8"))).get("model")
    except (ValueError, AttributeError, OSError):
        return None


def threads(path, overrides):
    """run.threads of the scene, overrides included: a number, a dict of those given, or None."""
    try:
        chosen = json.loads(without_comments(path.read_text(encoding="utf-8"))).get("run", {}).get("threads")
    except (ValueError, AttributeError, OSError):
        chosen = None
    for override in overrides:
        key, _, value = override.partition("=")
        key, number = key.strip(), value.strip()
        if key == "run.threads":
            try:
                chosen = json.loads(number)
            except ValueError:
                chosen = None
        elif key.startswith("run.threads.") and number.isdigit():
            chosen = {**(chosen if isinstance(chosen, dict) else {}), key.rpartition(".")[2]: int(number)}
    return chosen or None


def models(text):
    """The list behind --models."""
    if text == "all":
        return list(MODELS)
    chosen = [word.strip() for word in text.split(",") if word.strip()]
    for word in chosen:
        if word not in MODELS:
            raise UserError(f"no model '{word}'; {advice(word, MODELS)}")
    if not chosen:
        raise UserError("--models needs at least one of " + ", ".join(MODELS) + ", or all")
    return chosen


def changes(overrides):
    """A dict of overrides as a list of 'key=value'; a list stays."""
    if isinstance(overrides, dict):
        return [f"{key}={value if isinstance(value, str) else json.dumps(value)}" for key, value in overrides.items()]
    return list(overrides or [])


def override_arguments(overrides):
    """--set words for the coupler. Raises UserError where one is not key=value."""
    words = []
    for override in overrides:
        if "=" not in override or override.startswith("="):
            raise UserError(f"--set {override}: expected key=value, for example --set model=dem")
        words += ["--set", override]
    return words
