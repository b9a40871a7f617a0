"""One's own estimator in a study: `kind = "my_module:Estimator"`, every further key an option of it.

The module lies beside the study file or is installed. The class, or a function that returns an estimator, is called as
`Estimator(scene, **options)`, where `scene` is a `StudyScene`: `scene.matter` is the medium, `scene.ray`, `scene.light`,
`scene.ambient`, … the rest. What it makes has

    draw       (rng, n) -> (n,) independent realisations of the scene's quantity, or `Draws` with their cost; all chance comes
               from rng, the workers' threads may call it at the same time
    variance   the exact variance of a realisation, a number or a `Reference`; may be missing

and the class itself may have

    title       how it is called in words; "my_module:Estimator" without one
    dimensions  uniforms a realisation, if `draw` is a pure function of rng.random((n, dimensions)): Sobol points are tried then
    expected    "rejected" for one that is biased by construction, and `reason` says why

The sources of the module, and of what it imports from the same place, belong to what identifies the study's batches.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fogproof.contracts import Draws, Reference
from fogproof.errors import FogproofError, InvalidInputError, SubjectError
from fogproof.study.own_code import digest_of, loaded

if TYPE_CHECKING:
    from fogproof.study.files import StudyScene


@dataclass(frozen=True)
class Own:
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
    quantity: ClassVar[None] = None
    axis: ClassVar[str] = "samples"

    def make(self, scene: StudyScene, count: int) -> Any:
        """Return the estimator, which answers for what it draws."""
        return _Answering(self.source, self._made(scene))

    def variance(self, scene: StudyScene) -> Reference | None:
        """Return what it says its variance is, if anything."""
        said = getattr(self._made(scene), "variance", None)
        return None if said is None else Reference.of("variance", said)

    @property
    def title(self) -> str:
        """Its own, or its name."""
        return str(getattr(self._maker(), "title", self.source))

    @property
    def dimensions(self) -> int | None:
        """Uniforms a realisation, None if it does not say."""
        return self._declared("dimensions", None, lambda d: isinstance(d, int) and d > 0, "a whole number > 0, or None")

    @property
    def expected(self) -> str:
        """Whether it is known to be biased."""
        outcomes = ("not rejected", "rejected")
        said: str = self._declared("expected", outcomes[0], outcomes.__contains__, " or ".join(map(repr, outcomes)))
        return said

    @property
    def reason(self) -> str:
        """Why it is biased."""
        return str(getattr(self._maker(), "reason", ""))

    def _declared(self, name: str, default: Any, good: Any, rule: str) -> Any:
        said = getattr(self._maker(), name, default)
        if said is not default and not good(said):
            raise InvalidInputError(f"{self.source}: {name} must be {rule}, got {said!r}", name)
        return said

    def _maker(self) -> Any:
        module, _, name = self.source.partition(":")
        if digest_of(module, self.folder) != self.sha256:
            raise InvalidInputError(f"the sources of {self.source} have changed since the study was started", module)
        maker = getattr(loaded(module, self.folder), name, None)
        if not callable(maker):
            what = "is no class" if maker is not None else "is not there"
            raise InvalidInputError(f"{self.source}: {name} {what} in the module {module}", self.source)
        return maker

    def _made(self, scene: StudyScene) -> Any:
        try:
            made = self._maker()(scene, **self.options)
        except FogproofError:
            raise
        except Exception as error:
            raise SubjectError(f"{self.source}: {type(error).__name__}: {error}", self.source) from None
        if not callable(getattr(made, "draw", None)):
            raise SubjectError(f"{self.source} made {type(made).__name__}, which has no draw(rng, n)", "draw")
        return made


@dataclass(frozen=True, eq=False)
class _Answering:
    """Holds an estimator to its contract; whatever it raises is told with its name."""

    source: str
    made: Any

    def draw(self, rng: np.random.Generator, n: int) -> Any:
        try:
            drawn = self.made.draw(rng, n)
            shape = np.asarray(drawn.value if isinstance(drawn, Draws) else drawn, dtype=np.float64).shape
        except FogproofError:
            raise
        except Exception as error:
            raise SubjectError(f"{self.source}: draw: {type(error).__name__}: {error}", "draw") from None
        if shape not in ((n,), (n, 1)):
            raise SubjectError(f"{self.source}: draw(rng, {n}) must return {n} numbers, got shape {shape}", "draw")
        return drawn
