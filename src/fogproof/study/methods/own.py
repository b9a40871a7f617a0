"""One's own estimator in a study: `kind = "my_module:Estimator"`, every further key an option of it.

The module lies beside the study file or is installed. The class, or a function that returns an estimator, is called as
`Estimator(scene, **options)`; the scene is a `Question`, with `built_medium`, `ray`, `light`, `ambient`, …. What it makes has

    draw       (rng, n) -> (n,) independent realisations of the scene's quantity, or `Draws` with their cost; all chance comes
               from rng, the workers' threads may call it at the same time. A call may stratify them, or pair them antithetically
    variance   the exact variance of a realisation, a number or a `Reference`; may be missing
    bounds     two numbers between which every realisation lies; may be missing. With both, even skewed ones are judged

and the class itself may have

    title       how it is called in words, 200 characters at most; "my_module:Estimator" without one
    dimensions  uniforms a realisation, if `draw` is a pure function of rng.random((n, dimensions)): Sobol points are tried then
    bias        why its mean is not the quantity, in words, if it is biased by construction

The sources of the module, and of what it imports from the same place, belong to what identifies the study's batches.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError, SubjectError, is_stop, shorten
from fogproof.study.methods.method import Method
from fogproof.study.own_code import digest_of, loaded
from fogproof.study.question import Question
from fogproof.validate import number

LONGEST_TITLE = 200
"""Characters of a title: it stands in tables and figures."""


@dataclass(frozen=True)
class Own(Method):
    """An estimator of somebody else's.

    source   "module:Estimator"
    options  what it is called with besides the scene
    sha256   of its sources, filled in when the study is read: other sources make other batches
    folder   where the study file lies; filled in as well, and no part of what identifies the study
    """

    source: str
    sha256: str
    options: dict[str, Any] = field(default_factory=dict)
    folder: str = ""
    quantity: ClassVar[Any] = None

    def make(self, scene: Question, count: int) -> Any:
        """Return the estimator, which answers for what it draws; what it declares is held to its contract here, before a run."""
        made = self._made(scene)
        _ = self._variance_of(made), self._bounds_of(made), self.title, self.bias
        return _Answering(self.source, made)

    def variance(self, scene: Question) -> Reference | None:
        """Return what it says its variance is, if anything."""
        return self._variance_of(self._made(scene))

    def _variance_of(self, made: Any) -> Reference | None:
        said = getattr(made, "variance", None)
        if said is None:
            return None
        fix = "give the exact variance of one realisation, or None"
        name = f"{self.source}: variance"
        if not isinstance(said, Reference):
            return Reference(np.asarray(number(name, said, "must be finite and >= 0", 0, fix=fix)))
        error = number(f"{name}: error", np.max(said.error), "must be finite and >= 0", 0)
        # A right variance of 0 may be known as a little less.
        number(f"{name}: value", float(said), "must be finite and not below 0 by more than its error", -error, fix=fix)
        return said

    def bounds(self, scene: Question) -> tuple[float, float] | None:
        """Return between what it says its realisations lie, if anything."""
        return self._bounds_of(self._made(scene))

    def _bounds_of(self, made: Any) -> tuple[float, float] | None:
        said = getattr(made, "bounds", None)
        if said is None:
            return None
        try:
            low, high = (float(end) for end in said)
        except (TypeError, ValueError):
            low = high = np.nan
        if not (np.isfinite(high - low) and low < high):
            what = f"{self.source}: bounds must be two finite numbers, the lower first, or None, got {shorten(said)}"
            raise InvalidInputError(what, "bounds")
        return low, high

    @property
    def title(self) -> str:
        """Its own, or its name."""
        fix = "give its name in words, or None"
        said = self._words("title", fix)
        if len(said) > LONGEST_TITLE:
            raise InvalidValueError(f"{self.source}: title", f"must have at most {LONGEST_TITLE} characters", said, fix)
        return said or self.source

    @property
    def dimensions(self) -> int | None:
        """Uniforms a realisation, None if it does not say."""
        said = getattr(self._maker(), "dimensions", None)
        if said is not None and not (isinstance(said, int) and said > 0):
            what = f"{self.source}: dimensions must be a whole number > 0, or None, got {said!r}"
            raise InvalidInputError(what, "dimensions")
        return said

    @property
    def bias(self) -> str:
        """Why it is biased, "" if it should not be."""
        return self._words("bias", "say in words why its mean is not the quantity, or None where it is")

    def _words(self, name: str, fix: str) -> str:
        """Return a text that the class declares, "" if it is None or not there."""
        said = getattr(self._maker(), name, None)
        if said is not None and not isinstance(said, str):
            raise InvalidValueError(f"{self.source}: {name}", "must be a text", said, fix)
        if said and any(0xD800 <= ord(letter) <= 0xDFFF for letter in said):
            raise InvalidValueError(f"{self.source}: {name}", "must be free of lone surrogates", said, fix)
        return said or ""

    def _maker(self) -> Any:
        module, _, name = self.source.partition(":")
        if digest_of(module, self.folder) != self.sha256:
            raise InvalidInputError(f"the sources of {self.source} have changed since the study was started", module)
        maker = getattr(loaded(module, self.folder), name, None)
        if not callable(maker):
            what = "is no class" if maker is not None else "is not there"
            raise InvalidInputError(f"{self.source}: {name} {what} in the module {module}", self.source)
        return maker

    def _made(self, scene: Question) -> Any:
        try:
            made = self._maker()(scene, **self.options)
        except FogproofError:
            raise
        except BaseException as error:
            if is_stop(error):
                raise
            raise SubjectError(f"{self.source}: {type(error).__name__}: {error}", self.source) from None
        if not callable(getattr(made, "draw", None)):
            raise SubjectError(f"{self.source} made {type(made).__name__}, which has no draw(rng, n)", "draw")
        return made


@dataclass(frozen=True, eq=False)
class _Answering:
    """Tells whatever an estimator raises with its name; what it returns is looked at where its time is not taken."""

    source: str
    made: Any

    def draw(self, rng: np.random.Generator, n: int) -> Any:
        try:
            return self.made.draw(rng, n)
        except FogproofError:
            raise
        except BaseException as error:  # what ends a program must not end a study
            if is_stop(error):
                raise
            raise SubjectError(f"{self.source}: draw: {type(error).__name__}: {error}", "draw") from None
