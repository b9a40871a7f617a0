"""Samples that are already there: right ones pass, wrong ones are named, in every format and with each kind of truth."""

import numpy as np
import pytest

from fogproof.errors import FogproofError
from fogproof.pipe.check import Settings, check_file
from fogproof.pipe.spec import spec_of

G = 0.7
DIRECTIONS = {"axis": [0, 0, 1], "phase": {"kind": "henyey-greenstein", "g": G}}
PATHS = {
    "medium": {"sigma_a": 0.5, "sigma_s": 0.0},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 3.0},
}


def directions(n, g=G, seed=None):
    u = np.random.default_rng(seed).random((n, 2))
    mu = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u[:, 0])) ** 2) / (2 * g)
    sine, phi = np.sqrt(1 - mu * mu), 2 * np.pi * u[:, 1]
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def density(x, g=G):
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]) ** 1.5)


def paths(n):
    return np.minimum(-np.log1p(-np.random.default_rng().random(n)) / 0.5, 3.0)


def written(path, array, header=""):
    if path.suffix == ".npy":
        np.save(path, array)
    elif path.suffix == ".csv":
        np.savetxt(path, array, delimiter=",", header=header, comments="")
    else:
        path.write_bytes(np.ascontiguousarray(array).tobytes())
    return path


@pytest.mark.parametrize("suffix", ["npy", "csv", "bin"])
def test_samples_against_the_oracle(tmp_path, suffix):
    path = tmp_path / f"samples.{suffix}"
    spec = {**DIRECTIONS, "columns": ["x", "x", "x"]} if suffix == "bin" else DIRECTIONS
    right = check_file(written(path, directions(20_000)), spec).verdict
    assert right.outcome == "not rejected", right
    wrong = check_file(written(path, directions(20_000, 0.75)), spec).verdict
    assert (wrong.outcome, wrong.cause) == ("rejected", "another parameter"), wrong
    assert wrong.reproduce.startswith("fogproof check /")


def test_numbers_of_another_type_or_of_few_digits_are_named(tmp_path):
    x = directions(4000)
    bare = {**DIRECTIONS, "columns": ["x", "x", "x"]}
    (tmp_path / "x.bin").write_bytes(x.tobytes())
    wide = check_file(tmp_path / "x.bin", {**bare, "type": "float32"}).verdict
    assert wide.cause == "number type", wide
    (tmp_path / "x.bin").write_bytes(x.astype(np.float32).tobytes())
    assert check_file(tmp_path / "x.bin", bare).verdict.cause == "number type"
    np.savetxt(
        tmp_path / "x.csv", np.column_stack([x, density(x)]), fmt="%g", delimiter=",", header="x,x,x,pdf", comments=""
    )
    few = check_file(tmp_path / "x.csv", {"domain": "sphere"}).verdict
    assert few.cause == "coarse numbers", few
    assert "%.17g" in str(few)


def test_few_rows_are_enough_to_begin_with(tmp_path):
    """Nothing is counted twice, and a short file is judged as far as it goes."""
    verdict = check_file(written(tmp_path / "x.npy", directions(400)), DIRECTIONS).verdict
    assert verdict.outcome != "rejected", verdict
    assert verdict.samples == 300
    flipped = check_file(written(tmp_path / "x.npy", -directions(400)), DIRECTIONS).verdict
    assert "the opposite direction" in str(flipped)
    with pytest.raises(FogproofError, match="at least 200"):
        check_file(written(tmp_path / "x.npy", directions(100)), DIRECTIONS)


def test_a_law_without_free_numbers_is_preferred_where_a_fitted_one_does_as_well(tmp_path):
    """A few hundred directions of -omega fit -g, and numbers near -g too: the sign is likely, the words tell of the others."""
    told = []
    for seed in range(16):
        flipped = -directions(400, seed=seed)
        told.append(check_file(written(tmp_path / "x.npy", flipped), DIRECTIONS, Settings(seed=seed)).verdict.cause)
    assert told.count("sign convention") >= 15, told


def test_an_atom_and_returned_densities(tmp_path):
    t = paths(30_000)
    p = np.where(t == 3, np.exp(-1.5), 0.5 * np.exp(-0.5 * t))
    rows = np.stack([t, p, t == 3], axis=-1)
    path = written(tmp_path / "t.csv", rows, "t,pdf,event")
    assert check_file(path, PATHS).verdict.outcome == "not rejected"
    rows[:, 1] = 0.5 * np.exp(-0.5 * t)
    assert check_file(written(path, rows, "t,pdf,event"), PATHS).verdict.cause == "wrong pdf returned"
    rows = rows[rows[:, 2] == 0]
    assert check_file(written(path, rows, "t,pdf,event"), PATHS).verdict.cause == "wrong probability of an atom"


def test_equal_samples_are_found(tmp_path):
    """Half of the samples written twice: a file is no excuse for repeats."""
    x = directions(10_000)
    verdict = check_file(written(tmp_path / "x.npy", np.concatenate([x, x])), DIRECTIONS).verdict
    assert verdict.outcome == "rejected"
    assert any(f.check == "repeated points" and f.outcome == "rejected" for f in verdict.findings)


def test_densities_of_the_samples_alone(tmp_path):
    """Without a law the identity of importance sampling judges: q / pdf averages to Q in every cell."""
    spec = {"domain": "sphere", "columns": ["x", "x", "x", "pdf"]}
    x = directions(60_000, 0.5)
    path = tmp_path / "x.npy"
    right = check_file(written(path, np.column_stack([x, density(x, 0.5)])), spec).verdict
    assert right.outcome == "not rejected", right
    for claimed in (density(x, 0.6), density(-x, 0.5), 1.05 * density(x, 0.5)):
        wrong = check_file(written(path, np.column_stack([x, claimed])), spec).verdict
        assert wrong.outcome == "rejected", wrong
    hole = np.where(x[:, 2] > 0.9, 0.0, density(x, 0.5))
    assert check_file(written(path, np.column_stack([x, hole])), spec).verdict.cause == "claimed hole"


def test_densities_on_a_line_without_end(tmp_path):
    t = -np.log1p(-np.random.default_rng().random(40_000))
    spec = {"domain": "half-line", "columns": ["x", "pdf"]}
    path = written(tmp_path / "t.npy", np.stack([t, np.exp(-t)], axis=-1))
    assert check_file(path, spec).verdict.outcome == "not rejected"
    path = written(path, np.stack([t, 1.2 * np.exp(-1.2 * t)], axis=-1))
    assert check_file(path, spec).verdict.outcome == "rejected"


def test_a_table_judges_no_more_samples_than_it_can(tmp_path):
    """Straight lines through a curved density are not the density."""
    x = np.linspace(0, 1, 41)
    np.savetxt(tmp_path / "pdf.csv", np.stack([x, 3 * x**2], axis=-1), delimiter=",")
    spec = {"domain": {"kind": "interval", "a": 0, "b": 1}, "table": str(tmp_path / "pdf.csv")}
    samples = np.random.default_rng().random(200_000) ** (1 / 3)
    outcome = check_file(written(tmp_path / "x.npy", samples), spec)
    assert outcome.verdict.outcome == "not rejected", outcome.verdict
    assert "is good enough to judge" in outcome.notes[0]
    assert outcome.verdict.samples < 140_000
    exact = check_file(tmp_path / "x.npy", {**spec, "exact": True}).verdict
    assert exact.outcome == "rejected"  # by its integral: the trapezoid rule is off by 3e-4
    wrong = check_file(written(tmp_path / "x.npy", samples**1.1), spec).verdict
    assert wrong.outcome == "rejected"
    np.savetxt(tmp_path / "pdf.csv", np.stack([x[::10], 3 * x[::10] ** 2], axis=-1), delimiter=",")
    with pytest.raises(FogproofError, match="too coarse"):
        check_file(tmp_path / "x.npy", spec)


def test_a_map_on_the_square(tmp_path):
    rng = np.random.default_rng()
    weights = rng.random((8, 16)) ** 2 + 0.01
    weights *= weights.size / weights.sum()
    np.save(tmp_path / "map.npy", weights)
    cell = rng.choice(weights.size, 30_000, p=weights.ravel() / weights.size)
    x = (np.stack([cell % 16, cell // 16], axis=-1) + rng.random((30_000, 2))) / (16, 8)
    spec = {"domain": "square", "table": str(tmp_path / "map.npy"), "interpolation": "constant"}
    assert check_file(written(tmp_path / "x.npy", x), spec).verdict.outcome == "not rejected"
    assert check_file(written(tmp_path / "x.npy", 1 - x), spec).verdict.outcome == "rejected"


def test_realisations(tmp_path):
    values = np.random.default_rng().random(5000)
    path = written(tmp_path / "values.npy", values)
    assert check_file(path, {"reference": 0.5, "bounds": [0, 1]}).verdict.outcome == "not rejected"
    assert check_file(path, {"reference": 0.55, "bounds": [0, 1]}).verdict.outcome == "rejected"


@pytest.mark.parametrize(
    ("array", "name", "cause"),
    [
        (lambda x: x.byteswap(), "x.npy", "byte order"),
        (lambda x: np.ascontiguousarray(x.T).reshape(-1, 3), "x.npy", "layout"),
        (lambda x: x.astype(np.float32), "x.bin", "number type"),
    ],
)
def test_what_is_written_wrongly_is_named(tmp_path, array, name, cause):
    path = written(tmp_path / name, array(directions(4000)))
    spec = {**DIRECTIONS, "columns": ["x", "x", "x"]}
    assert check_file(path, spec).verdict.cause == cause


BROKEN = {
    "x.npy": (
        b"",
        b"\x93NUMPY",
        b"\x93NUMPY\x01\x00\xff\xff",
        b"no array",
        b"\x93NUMPY\x01\x00\x10\x00{'descr': '|O'}\n",
    ),
    "x.csv": (b"", b"a,b,c\n1,2,3\n", b"1,2\n3\n", b"x,x,x\n", b"1,2,\xff\n", b"\n\n"),
    "x.bin": (b"", b"12345"),
    "x.exr": (b"",),
    "x": (b"",),
}


@pytest.mark.parametrize(("name", "content"), [(name, each) for name, all_ in BROKEN.items() for each in all_])
def test_broken_files_are_told_in_a_sentence(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FogproofError, match=name):
        check_file(tmp_path / name, {**DIRECTIONS, "columns": ["x", "x", "x"]})


def test_a_second_array_in_a_file_is_not_passed_over(tmp_path):
    with open(tmp_path / "x.npy", "wb") as file:
        np.save(file, directions(400))
        np.save(file, directions(400, 0.1))
    with pytest.raises(FogproofError, match="follow the array"):
        check_file(tmp_path / "x.npy", DIRECTIONS)


def test_columns_must_be_named_where_there_are_more(tmp_path):
    path = written(tmp_path / "x.npy", np.ones((500, 4)))
    with pytest.raises(FogproofError, match="name them all"):
        check_file(path, DIRECTIONS)
    with pytest.raises(FogproofError, match="has no densities"):
        check_file(written(path, directions(500)), {"domain": "sphere"})
    with pytest.raises(FogproofError, match="cannot read"):
        check_file(tmp_path / "nowhere.npy", DIRECTIONS, Settings(seed=1))
    with pytest.raises(FogproofError, match="transpose it"):
        check_file(written(path, directions(500).T), {**DIRECTIONS, "columns": ["x", "x", "x"]})
    with pytest.raises(FogproofError, match="2 columns pdf"):
        check_file(written(path, np.ones((500, 3))), {"domain": "line", "columns": ["x", "pdf", "pdf"]})


@pytest.mark.parametrize("row", [0, 19_999])
def test_no_row_is_too_early_to_be_looked_at(tmp_path, row):
    """The first rows set scales and are not counted; what every single sample promises, they promise too."""
    x = paths(20_000)
    x[row] = np.nan
    verdict = check_file(written(tmp_path / "x.npy", x), PATHS).verdict
    assert (verdict.outcome, verdict.cause) == ("rejected", "not a number"), verdict


def test_a_table_whose_integral_is_wrong_says_what_to_divide_by(tmp_path):
    x = np.linspace(0, 1, 41)
    np.savetxt(tmp_path / "pdf.csv", np.stack([x, 4 * x], axis=-1), delimiter=",")
    spec = {"domain": {"kind": "interval", "a": 0, "b": 1}, "table": str(tmp_path / "pdf.csv")}
    outcome = check_file(written(tmp_path / "x.npy", np.sqrt(np.random.default_rng().random(5000))), spec)
    assert outcome.verdict.outcome == "rejected"
    assert "integrate to 2 where 1 is due: divide them by 2" in outcome.notes[0]


def test_swapped_columns_are_named(tmp_path):
    x = np.linspace(0, 1, 41)
    np.savetxt(tmp_path / "pdf.csv", np.stack([2 - 2 * x, x], axis=-1), delimiter=",")
    spec = {"domain": {"kind": "interval", "a": 0, "b": 1}, "table": str(tmp_path / "pdf.csv")}
    samples = 1 - np.sqrt(np.random.default_rng().random(5000))
    with pytest.raises(FogproofError, match="must increase; its columns are swapped"):
        check_file(written(tmp_path / "x.npy", samples), spec)
    np.savetxt(tmp_path / "pdf.csv", np.stack([1 - x, 2 - 2 * x], axis=-1), delimiter=",")
    with pytest.raises(FogproofError) as refused:  # neither way do points increase
        check_file(tmp_path / "x.npy", spec)
    assert "columns are" not in str(refused.value)


@pytest.mark.parametrize("length", [1.0, 2.0])  # densities on either side of 1 lie outside of [0, 1], and inside [0, 2]
def test_swapped_columns_of_points_and_densities_are_named(tmp_path, length):
    s = 1.5 - np.sqrt(2.25 - 2 * np.random.default_rng().random(40_000))  # of the density 1.5 - s on [0, 1]
    path = written(tmp_path / "both.npy", np.stack([(1.5 - s) / length, s * length], axis=-1))
    spec = {"domain": {"kind": "interval", "a": 0, "b": length}}
    verdict = check_file(path, {**spec, "columns": ["x", "pdf"]}).verdict
    assert (verdict.outcome, verdict.cause) == ("rejected", "layout"), verdict
    right = check_file(path, {**spec, "columns": ["pdf", "x"]}, Settings(alpha=1e-7)).verdict
    assert right.outcome == "not rejected", right


@pytest.mark.parametrize(
    ("domain", "interpolation", "message"),
    [
        ("square", None, 'must be said of a table on the square.*interpolation = "constant"'),
        ("square", "linear", "constant on each cell, not linear"),
        ("sphere", "constant", "linear between its points, not constant"),
        ({"kind": "interval", "a": 0, "b": 1}, "constant", "linear between its points, not constant"),
        ("square", "nearest", "interpolation"),
        ("square", "Constant", "interpolation"),
        ("disk", "constant", "serves lines, the sphere and the square"),
    ],
)
def test_how_a_table_is_read_between_its_numbers_is_said_or_refused(tmp_path, domain, interpolation, message):
    np.save(tmp_path / "map.npy", np.ones((2, 2)))
    columns = {"square": 2, "disk": 2, "sphere": 3}.get(domain, 1) if isinstance(domain, str) else 1
    np.save(tmp_path / "x.npy", np.random.default_rng().random((2000, columns)))
    spec = {"domain": domain, "table": str(tmp_path / "map.npy"), "axis": [0, 0, 1]}
    spec |= {} if interpolation is None else {"interpolation": interpolation}
    with pytest.raises(FogproofError, match=message):
        check_file(tmp_path / "x.npy", spec)


@pytest.mark.parametrize("key", ["exact", "interpolation"])
def test_keys_of_tables_are_refused_without_one(key):
    with pytest.raises(FogproofError, match=f"{key} says something of a table"):
        spec_of({"domain": "sphere", key: True if key == "exact" else "linear"}, "spec")


def test_linear_is_meant_on_a_line(tmp_path):
    np.savetxt(tmp_path / "pdf.csv", [[0, 0], [1, 2]], delimiter=",")
    spec = {"domain": {"kind": "interval", "a": 0, "b": 1}, "table": str(tmp_path / "pdf.csv"), "exact": True}
    path = written(tmp_path / "x.npy", np.sqrt(np.random.default_rng().random(20_000)))
    for said in ({}, {"interpolation": "linear"}):
        assert check_file(path, {**spec, **said}, Settings(alpha=1e-7)).verdict.outcome == "not rejected"
