"""Single scattering of lights with cones, shadows and shapes, literally: is this point lit, and how far is the way?

Independent of the package: whether a point is lit is asked of the point (the distance of the occluder from the way of the
light, the angle from the axis), the edges are found by bisection, and what lies between is integrated by mpmath.
"""

from __future__ import annotations

from itertools import pairwise

import mpmath as mp
import numpy as np
from airlight_truth import phase_factor
from flint import acb, arb, ctx

from fogproof.scene.lights import SpotLight
from fogproof.scene.occluders import Sphere
from fogproof.scene.shapes import Ball, Box, HalfSpace, Slab, Unbounded


def vector(x):
    return [mp.mpf(float(v)) for v in x]


def dot(x, y):
    return mp.fdot(x, y)


def along(o, d, t):
    return [a + t * b for a, b in zip(o, d, strict=True)]


def minus(x, y):
    return [a - b for a, b in zip(x, y, strict=True)]


def factor(phase, mu):
    """4 pi f_p(mu) as an mpf."""
    ctx.prec = 130
    return mp.mpf(acb(phase_factor(phase, arb(mp.nstr(mu, 35)))).real.mid().str(30, radius=False))


def hidden(occluder, x, source):
    """Whether the occluder meets the segment from x to the point `source`."""
    c, v = vector(occluder.center), minus(source, x)
    if isinstance(occluder, Sphere):
        s = min(1, max(0, dot(minus(c, x), v) / dot(v, v)))
        y = minus(along(x, v, s), c)
        return dot(y, y) <= mp.mpf(occluder.radius) ** 2
    n = vector(occluder.normal)
    ahead, total = dot(minus(c, x), n), dot(v, n)
    if total == 0 or not 0 <= ahead / total <= 1:
        return False
    y = minus(along(x, v, ahead / total), c)
    return dot(y, y) <= mp.mpf(occluder.radius) ** 2


def from_axis(light, x):
    v = minus(x, vector(light.position))
    return mp.acos(min(1, max(-1, dot(v, vector(light.direction)) / mp.sqrt(dot(v, v)))))


def aimed(light, x):
    """Intensity of a spot light towards x, relative to its axis; 1 for others."""
    if not isinstance(light, SpotLight):
        return mp.mpf(1)
    angle = from_axis(light, x)
    cosine = mp.cos(angle)
    if angle > light.half_angle:
        return mp.mpf(0)
    value = cosine**light.exponent
    start = light.half_angle if light.falloff_start is None else light.falloff_start
    if angle > start:
        if light.profile == "linear":
            return value * (light.half_angle - angle) / (mp.mpf(light.half_angle) - start)
        edge, full = mp.cos(light.half_angle), mp.cos(start)
        s = (cosine - edge) / (full - edge)
        value *= s * s * (3 - 2 * s)
    return value


def way_out(shape, x, d):
    """Distance from x along the unit vector d to the boundary of a shape that holds x, and the face met there."""
    match shape:
        case Unbounded():
            return mp.inf, 0
        case Ball(center, radius):
            q = minus(x, vector(center))
            return mp.sqrt(max(0, dot(q, d) ** 2 + mp.mpf(radius) ** 2 - dot(q, q))) - dot(q, d), 0
        case HalfSpace(point, normal):
            faces = [(normal, point)]
        case Slab(point, normal, thickness):
            faces = [(normal, point), (-np.array(normal), np.array(point) - thickness * np.array(normal))]
        case Box(lower, upper):
            faces = [(e, upper) for e in np.eye(3)] + [(-e, lower) for e in np.eye(3)]
    ways = [(mp.inf, -1)]
    for face, (normal, point) in enumerate(faces):
        n, p = vector(normal), vector(point)
        if dot(n, d) > 0:
            ways.append((max(mp.mpf(0), dot(n, minus(p, x)) / dot(n, d)), face))
    return min(ways)


def holds(shape, x):
    match shape:
        case Unbounded():
            return True
        case Ball(center, radius):
            q = minus(x, vector(center))
            return dot(q, q) <= mp.mpf(radius) ** 2
        case HalfSpace(point, normal):
            return dot(minus(x, vector(point)), vector(normal)) <= 0
        case Slab(point, normal, thickness):
            return -mp.mpf(thickness) <= dot(minus(x, vector(point)), vector(normal)) <= 0
        case Box(lower, upper):
            return all(low <= v <= high for low, v, high in zip(lower, x, upper, strict=True))


def cross(x, y):
    return [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]


def turns(occluder, o, d, p, foot, h):
    """Return the angles about the light at which a shadow may begin or end along the ray: all there are.

    In the plane of light and ray a sphere is a circle and a disk a chord; the shadow turns where the light's way touches either,
    and where the ray itself meets them.
    """
    across = [x / h for x in minus(along(o, d, foot), p)]
    normal = cross(across, d)
    c, r = minus(vector(occluder.center), p), mp.mpf(occluder.radius)
    a, b, off = dot(c, across), dot(c, d), dot(c, normal)

    def angle(u, v):
        return mp.atan2(v, u)

    if isinstance(occluder, Sphere):
        square = r * r - off * off
        if square <= 0:
            return []
        middle, far = angle(a, b), mp.hypot(a, b)
        found = [] if far <= mp.sqrt(square) else [middle + s * mp.asin(mp.sqrt(square) / far) for s in (-1, 0, 1)]
        if square > (h - a) ** 2:
            found += [angle(h, b + s * mp.sqrt(square - (h - a) ** 2)) for s in (-1, 1)]
        return found
    n = vector(occluder.normal)
    u, v = dot(n, across), dot(n, d)
    steep = u * u + v * v
    if steep == 0:
        return []
    # The nearest point to the centre of the line in which the disk's plane meets that of light and ray, and half its chord.
    lean = off * dot(n, normal) / steep
    square = r * r - off * off - (off * dot(n, normal)) ** 2 / steep
    found = [] if v == 0 else [angle(h, (u * (a - h) + v * b + dot(n, normal) * off) / v)]
    if square > 0:
        half, steep = mp.sqrt(square), mp.sqrt(steep)
        x, y = a + lean * u, b + lean * v
        found += [angle(x + s * half * -v / steep, y + s * half * u / steep) for s in (-1, 0, 1)]
    return found


def pieces(inside, low, high, samples=400, turns=()):
    """Return the intervals of [low, high] where inside(t) holds, edges by bisection.

    turns  where it may begin or cease to hold: one asks between them too, so that nothing is too narrow to be met
    """
    marks = sorted({low, high, *(t for t in turns if low < t < high)})
    between = [(a + b) / 2 for a, b in pairwise(marks)]
    ts = sorted({*(low + (high - low) * k / samples for k in range(samples + 1)), *between})
    states = [inside(t) for t in ts]
    edges = [low] if states[0] else []
    for (t0, s0), (t1, s1) in pairwise(zip(ts, states, strict=True)):
        if s0 != s1:
            for _ in range(80):
                middle = (t0 + t1) / 2
                t0, t1 = (middle, t1) if inside(middle) == s0 else (t0, middle)
            edges.append(t1)
    if states[-1]:
        edges.append(high)
    return list(zip(edges[::2], edges[1::2], strict=True))


def integral(f, knots):
    """Return the integral of a positive function; mpmath's tolerance is absolute, so a small one is made about 1."""
    size = max(f(t) for t in knots)
    return size * mp.quad(lambda t: f(t) / size, knots) if size else mp.mpf(0)


def from_point(medium, ray, light, occluders=(), shape=None, reach=60):
    """Radiance of a point or spot light in the shape, which holds it; the ray ends at `reach` if it is endless."""
    with mp.workdps(28):
        shape = shape or Unbounded()
        o, d, p = vector(ray.origin), vector(ray.direction), vector(light.position)
        size = mp.sqrt(dot(d, d))
        d = [x / size for x in d]
        end = mp.mpf(min(float(ray.length), reach))
        foot = dot(minus(p, o), d)
        h = mp.sqrt(dot(q := minus(along(o, d, foot), p), q))
        sigma = mp.mpf(medium.sigma_a) + mp.mpf(medium.sigma_s)

        def place(theta):
            return foot + h * mp.tan(theta)

        def lit(theta):
            x = along(o, d, place(theta))
            return holds(shape, x) and aimed(light, x) > 0 and not any(hidden(o_, x, p) for o_ in occluders)

        low, high = mp.atan(-foot / h), mp.atan((end - foot) / h)
        entries = pieces(lambda th: holds(shape, along(o, d, place(th))), low, high)
        enter = place(entries[0][0]) if entries else mp.mpf(0)

        def f(theta):
            t = place(theta)
            x, r = along(o, d, t), h / mp.cos(theta)
            return mp.exp(-sigma * (t - enter + r)) * factor(medium.phase, -mp.sin(theta)) * aimed(light, x) / h

        total = mp.mpf(0)
        found = [theta for occluder in occluders for theta in turns(occluder, o, d, p, foot, h)]
        for start, stop in pieces(lit, low, high, turns=found):
            knots = []
            if isinstance(light, SpotLight) and light.falloff_start is not None:
                knots = pieces(lambda th: from_axis(light, along(o, d, place(th))) < light.falloff_start, start, stop)
            for left, right in pairwise(sorted({start, stop, *(k for pair in knots for k in pair)})):
                total += integral(f, mp.linspace(left, right, 4))
        return mp.mpf(medium.sigma_s) * mp.mpf(light.intensity) * total / (4 * mp.pi)


def from_direction(medium, ray, light, occluders=(), shape=None, reach=60):
    """Radiance of parallel light from outside of the shape."""
    with mp.workdps(28):
        o, d, v = vector(ray.origin), vector(ray.direction), vector(light.direction)
        sigma = mp.mpf(medium.sigma_a) + mp.mpf(medium.sigma_s)
        back = [-x for x in v]
        end = mp.mpf(min(float(ray.length), reach))

        low, high = (mp.mpf(0), end) if shape is None or isinstance(shape, Unbounded) else _chord(shape, o, d, end)
        if not high > low:
            return mp.mpf(0)

        def lit(t):
            x = along(o, d, t)
            return not any(hidden(o_, x, along(x, back, mp.mpf(1e4))) for o_ in occluders)

        def f(t):
            return mp.exp(-sigma * (t - low + way_out(shape, along(o, d, t), back)[0]))

        total = mp.mpf(0)
        for start, stop in pieces(lit, low, high):
            for face in range(-1, 6):
                alike = pieces(lambda t, face=face: way_out(shape, along(o, d, t), back)[1] == face, start, stop, 60)
                total += sum((integral(f, mp.linspace(*piece, 5)) for piece in alike), mp.mpf(0))
        mu = max(-1, min(1, -dot(d, v)))
        return mp.mpf(medium.sigma_s) * mp.mpf(light.irradiance) * factor(medium.phase, mu) / (4 * mp.pi) * total


def from_anywhere(medium, ray, light, shape):
    """Radiance of a point light inside or outside of the shape, for a ray that ends; 30 digits, cut where the exit face changes."""
    with mp.workdps(30):
        o, d, p = vector(ray.origin), vector(ray.direction), vector(light.position)
        foot = dot(minus(p, o), d) / dot(d, d)
        h = mp.sqrt(dot(q := minus(along(o, d, foot), p), q))
        size = mp.sqrt(dot(d, d))
        sigma = mp.mpf(medium.sigma_a) + mp.mpf(medium.sigma_s)
        low, high = _chord(shape, o, d, mp.mpf(float(ray.length)))
        if not high > low:
            return mp.mpf(0)
        enter = low

        def at(s):
            t = foot + h * mp.sinh(s) / size
            x = along(o, d, t)
            back = minus(p, x)
            r = mp.sqrt(dot(back, back))
            return t, back, r, way_out(shape, x, [v / r for v in back])

        def f(s):
            t, back, r, (way, _) = at(s)
            mu = dot(back, d) / (r * size)
            return mp.exp(-sigma * ((t - enter) * size + min(way, r))) * factor(medium.phase, mu) / r

        def face(s):
            _, _, r, (way, number) = at(s)
            return -1 if r < way else number

        first, last = mp.asinh((low - foot) * size / h), mp.asinh((high - foot) * size / h)
        cuts = [first + (last - first) * k / 150 for k in range(151)]
        knots = [first]
        for a, b in pairwise(cuts):
            if (before := face(a)) != face(b):
                for _ in range(70):
                    middle = (a + b) / 2
                    a, b = (middle, b) if face(middle) == before else (a, middle)
                knots.append(b)
        total = mp.mpf(0)
        for start, stop in pairwise([*knots, last]):
            total += integral(f, mp.linspace(start, stop, 5))
        return mp.mpf(medium.sigma_s) * mp.mpf(light.intensity) * total / (4 * mp.pi)


def _chord(shape, o, d, length):
    """Distances at which a line is in the shape, in units of |d|, within [0, length]."""
    if isinstance(shape, Ball):
        q = minus(o, vector(shape.center))
        a, b, c = dot(d, d), dot(q, d), dot(q, q) - mp.mpf(shape.radius) ** 2
        root = mp.sqrt(b * b - a * c) if b * b > a * c else mp.nan
        low, high = (-b - root) / a, (-b + root) / a
        return (max(low, 0), min(high, length)) if low < high else (mp.mpf(0), mp.mpf(0))
    match shape:
        case HalfSpace(point, normal):
            faces = [(normal, point)]
        case Slab(point, normal, thickness):
            faces = [(normal, vector(point))]
            n = vector(normal)
            faces.append(([-v for v in n], along(vector(point), n, -mp.mpf(thickness))))
        case Box(lower, upper):
            faces = [(e, upper) for e in np.eye(3)] + [(-e, lower) for e in np.eye(3)]
    low, high = mp.mpf(0), length
    for normal, point in faces:
        n, q = vector(normal), vector(point)
        room, speed = dot(n, minus(q, o)), dot(n, d)
        if speed > 0:
            high = min(high, room / speed)
        elif speed < 0:
            low = max(low, room / speed)
        elif room < 0:
            high = low
    return low, high
