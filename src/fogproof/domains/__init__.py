"""Where samples live: the domain of a sampler and the measure its density refers to. A domain is one module here.

| domain                        | point                            | measure of the pdf      |
|-------------------------------|----------------------------------|-------------------------|
| `UnitSphere`                  | (n, 3) unit vectors              | solid angle [1/sr]      |
| `UnitHemisphere`              | (n, 3) unit vectors, z >= 0      | solid angle [1/sr]      |
| `SphericalTriangle(a, b, c)`  | (n, 3) unit vectors              | solid angle [1/sr]      |
| `SpherePart(inside)`          | (n, 3) unit vectors              | solid angle [1/sr]      |
| `UnitDisk`                    | (n, 2), x^2 + y^2 <= 1           | area                    |
| `UnitSquare`                  | (n, 2) in [0, 1]^2               | area                    |
| `Rectangle(low, high)`        | (n, 2)                           | area                    |
| `Triangle(a, b, c)`           | (n, 2) or (n, 3)                 | area                    |
| `Box(low, high)`              | (n, k)                           | volume in k dimensions  |
| `Ball(radius, center)`        | (n, 3)                           | volume                  |
| `Rotations`                   | (n, 4) unit quaternions, q = -q  | Haar's, total 1         |
| `Interval(a, b)`              | (n,)                             | length                  |
| `HalfLine(a)`                 | (n,) in [a, inf)                 | length                  |
| `RealLine()`                  | (n,)                             | length                  |
| `Discrete(n)`                 | (n,) integers 0 … n − 1, or on   | counting                |
| `Product(a, b, ...)`          | columns of all parts             | product                 |

Any object with the parts of `Domain` is a domain.
"""

from fogproof.domains.ball import Ball
from fogproof.domains.box import Box, Rectangle, UnitSquare
from fogproof.domains.discrete import Discrete
from fogproof.domains.disk import UnitDisk
from fogproof.domains.law import Domain, Law
from fogproof.domains.line import HalfLine, Interval, RealLine
from fogproof.domains.product import Product
from fogproof.domains.rotations import Rotations
from fogproof.domains.sphere import SpherePart, UnitHemisphere, UnitSphere
from fogproof.domains.spherical_triangle import SphericalTriangle
from fogproof.domains.triangle import Triangle

KINDS: dict[str, type] = {
    "sphere": UnitSphere,
    "hemisphere": UnitHemisphere,
    "spherical-triangle": SphericalTriangle,
    "disk": UnitDisk,
    "square": UnitSquare,
    "rectangle": Rectangle,
    "triangle": Triangle,
    "box": Box,
    "ball": Ball,
    "rotations": Rotations,
    "interval": Interval,
    "half-line": HalfLine,
    "line": RealLine,
    "discrete": Discrete,
    "product": Product,
}
"""The `kind` of each domain in files; its other keys are the arguments of the class, `parts` those of a product. A `SpherePart` is
a function, which no file holds."""

__all__ = [
    "Ball",
    "Box",
    "Discrete",
    "Domain",
    "HalfLine",
    "Interval",
    "Law",
    "Product",
    "RealLine",
    "Rectangle",
    "Rotations",
    "SpherePart",
    "SphericalTriangle",
    "Triangle",
    "UnitDisk",
    "UnitHemisphere",
    "UnitSphere",
    "UnitSquare",
]
