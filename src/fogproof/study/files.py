"""Study files: what is measured, read from TOML with one sentence for every fault.

A study is its text: the normalised JSON of the file, from which every process that runs batches builds the same scenes. Comments,
blanks and the order of keys do not belong to it.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.checks.arguments import alpha_of
from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError, shorten
from fogproof.input_files import read_toml
from fogproof.scene.files import read_fields
from fogproof.study.media import sha256_of
from fogproof.study.methods.table import OWN, MethodField
from fogproof.study.own_code import NAME, digest_of
from fogproof.study.question import Question

LARGEST_COUNT = 1 << 40
LARGEST_REPLICATES = 1 << 24


@dataclass(frozen=True, eq=False, kw_only=True)
class StudyScene(Question):
    """A question, and the methods that are measured by it.

    estimators  see `methods`
    question    what the scene helps to find out, in words; "" for nothing
    """

    estimators: tuple[MethodField, ...]
    question: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.name.strip():
            raise InvalidValueError("name", "must not be blank", self.name, "give the scene a name")
        if not self.estimators:
            raise InvalidValueError("estimators", "must name at least one", [])


@dataclass(frozen=True, eq=False)
class Study:
    """What is measured: scenes x estimators x sample counts x replicates.

    samples     sample counts, rising; decades are usual
    replicates  independent estimates at each count: how sure a measured RMSE is
    batch       most samples that are drawn, and lost by an interruption, at once
    sobol       whether scrambled Sobol points are tried beside random ones where the estimator is a pure function of uniforms
    alpha       false-alarm probability of the whole study
    text        the normalised JSON of the file
    folder      where the study file lies: relative paths start there
    origin      what the file is called in messages
    """

    samples: tuple[int, ...]
    scenes: tuple[StudyScene, ...]
    title: str = ""
    replicates: int = 32
    batch: int = 1 << 16
    sobol: bool = True
    seed: int = 1
    alpha: float = 1e-6
    text: str = ""
    folder: str = ""
    origin: str = "study"

    def __post_init__(self) -> None:
        counts = np.array(self.samples, dtype=object)
        if not (len(counts) > 0 and all(n >= 1 for n in counts) and all(np.diff(counts) > 0)):
            raise InvalidValueError("samples", "must be rising whole numbers >= 1", list(self.samples))
        if counts[-1] > LARGEST_COUNT:
            raise InvalidValueError("samples", f"must be at most {LARGEST_COUNT}", list(self.samples))
        if self.replicates > LARGEST_REPLICATES:
            raise InvalidValueError("replicates", f"must be at most {LARGEST_REPLICATES}", self.replicates)
        for name, least in (("replicates", 4), ("batch", 64), ("seed", 0)):
            if not least <= getattr(self, name) < 1 << 63:
                raise InvalidValueError(name, f"must be a whole number >= {least} and below 2^63", getattr(self, name))
        alpha_of(self.alpha)
        names = [scene.name for scene in self.scenes]
        if not names:
            raise InvalidValueError("scenes", "must not be empty", [], "add a [[scenes]] table")
        for name in names:
            if names.count(name) > 1:
                raise InvalidValueError("scenes", "must have different names", name)

    @property
    def fingerprint(self) -> str:
        """What identifies the study: batches of another one do not belong to it."""
        return hashlib.sha256(self.text.encode()).hexdigest()[:32]


def read_study(path: str | Path) -> Study:
    """Read a study file; every fault is a `FogproofError` that names the file and the key."""
    path = Path(path)
    table = read_toml(path, "the study file")
    if "scenes" not in table and "ray" in table:
        raise InvalidInputError(
            f"{path} is a scene, not a study: scenes is missing; put it into a [[scenes]] table", "scenes"
        )
    folder = str(path.resolve().parent)
    try:
        text = json.dumps(_normalised(table, folder), sort_keys=True)
    except FogproofError as error:
        raise InvalidInputError(f"{path}: {error}", error.path) from None
    return study_of(text, folder, str(path))


def study_of(text: str, folder: str, origin: str = "study") -> Study:
    """Return the study that a text describes."""
    table = json.loads(text)
    types = {
        "samples": tuple[int, ...],
        "scenes": tuple[StudyScene, ...],
        "title": (str, ""),
        "replicates": (int, 32),
        "batch": (int, 1 << 16),
        "sobol": (bool, True),
        "seed": (int, 1),
        "alpha": (float, 1e-6),
    }
    fields = read_fields(types, _with_paths(table, folder), origin)
    try:
        return Study(**fields, text=text, folder=folder, origin=origin)
    except InvalidValueError as error:
        raise error.inside("the study", origin) from None


def differences(before: str, after: str) -> list[str]:
    """Return in words, one line a key, how the text of one study differs from that of another."""
    old, new = _flat(json.loads(before)), _flat(json.loads(after))
    lines = []
    for key in sorted({*old, *new}):
        if key not in new:
            lines.append(f"{key} = {shorten(old[key])} is gone")
        elif key not in old:
            lines.append(f"{key} = {shorten(new[key])} is new")
        elif old[key] != new[key] and key.endswith(".sha256"):
            table = key.removesuffix(".sha256")
            whose = new.get(f"{table}.source") or new.get(f"{table}.path") or table
            lines.append(f"{table}: the contents of {whose} have changed")
        elif old[key] != new[key]:
            lines.append(f"{key}: {shorten(old[key])} has become {shorten(new[key])}")
    return lines


def _flat(value: Any, place: str = "") -> dict[str, Any]:
    if isinstance(value, dict) and value:
        return {k: v for key, item in value.items() for k, v in _flat(item, f"{place}.{key}" if place else key).items()}
    if isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        return {k: v for i, item in enumerate(value) for k, v in _flat(item, f"{place}[{i}]").items()}
    return {place: value}


def _scene_tables(table: Any) -> list[dict[str, Any]]:
    scenes = table.get("scenes", []) if isinstance(table, dict) else []
    return [scene for scene in scenes if isinstance(scene, dict)] if isinstance(scenes, list) else []


def _normalised(table: dict[str, Any], folder: str) -> dict[str, Any]:
    """Return the table with estimators that are mere names spelt out, and files of voxels and others' estimators signed."""
    for scene in _scene_tables(table):
        names = scene.get("estimators")
        if isinstance(names, list):
            tables = [{"kind": name} if isinstance(name, str) else name for name in names]
            scene["estimators"] = [_signed(each, folder) for each in tables]
        medium = scene.get("medium")
        if isinstance(medium, dict) and medium.get("kind") == "grid-file" and isinstance(medium.get("path"), str):
            medium["sha256"] = sha256_of(Path(folder) / medium["path"])
    return table


def _signed(estimator: Any, folder: str) -> Any:
    """Return the table of an estimator; of one's own, "module:Estimator", with the digest of its sources."""
    kind = estimator.get("kind") if isinstance(estimator, dict) else None
    named = NAME.fullmatch(kind) if isinstance(kind, str) and kind != OWN else None
    if named is None:
        return estimator
    options = {key: value for key, value in estimator.items() if key != "kind"}
    return {"kind": OWN, "source": kind, "options": options, "sha256": digest_of(named[1], folder)}


def _with_paths(table: dict[str, Any], folder: str) -> dict[str, Any]:
    """Return the table with absolute paths, which are not part of what identifies the study."""
    for scene in _scene_tables(table):
        medium = scene.get("medium")
        if isinstance(medium, dict) and medium.get("kind") == "grid-file" and isinstance(medium.get("path"), str):
            medium["path"] = str(Path(folder) / medium["path"])
        estimators = scene.get("estimators")
        for estimator in estimators if isinstance(estimators, list) else ():
            if isinstance(estimator, dict) and estimator.get("kind") == OWN:
                estimator["folder"] = folder
    return table
