"""Numbers as other languages print them: few digits are named as what they are, and other habits are refused with their fix."""

import re

import numpy as np
import pytest

import fogproof
from fogproof.checks.digits import digits_of, rounded
from fogproof.errors import FogproofError
from fogproof.pipe.blocks import from_lines
from fogproof.pipe.check import check_file
from tests.pipe.test_programs import SAMPLER, judged, program

PATHS = {
    "medium": {"sigma_a": 1.0, "sigma_s": 0.0},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": "inf"},
}
ISOTROPIC = {"domain": "sphere", "axis": [0, 0, 1], "phase": {"kind": "isotropic"}}


def values(n=500):
    return np.random.default_rng(3).exponential(1.0, n)


@pytest.mark.parametrize(
    ("printed", "words", "step"),
    [
        (lambda x: [float(f"{v:g}") for v in x], "6 digits", 5e-6),
        (lambda x: [float(f"{v:.3f}") for v in x], "3 decimals", 5e-4),
        (lambda x: np.float32(x), "single precision", 2.0**-24),
        (lambda x: np.float16(x), "half precision", 2.0**-11),
    ],
)
def test_digits_are_counted(printed, words, step):
    found = digits_of(np.asarray(printed(values()), dtype=float))
    assert words in found.words
    assert found.step(np.array([1.0]))[0] == pytest.approx(step)


@pytest.mark.parametrize(
    "numbers", [values(), np.arange(1.0, 50), np.array([0.5, 0.25]), np.empty(0), np.full(9, np.nan)]
)
def test_full_whole_and_few_numbers_tell_nothing(numbers):
    assert digits_of(numbers) is None


def test_only_what_rounding_explains_is_called_rounded():
    x = np.array([float(f"{v:g}") for v in values()])
    claimed = np.exp(-x)
    printed = np.array([float(f"{v:g}") for v in np.exp(-values())])
    assert rounded(lambda t: np.exp(-t), x, printed, claimed, x)
    wrong = np.array([float(f"{v:g}") for v in 1.001 * np.exp(-values())])
    assert not rounded(lambda t: np.exp(-t), x, wrong, claimed, x)


@pytest.mark.parametrize("format", ["%g", "%.3f"])
def test_few_digits_in_a_program_or_file_are_named(tmp_path, format):
    x = values(2000)
    path = tmp_path / "x.csv"
    np.savetxt(path, np.c_[x, np.exp(-x)], format, delimiter=",", header="x,pdf", comments="")
    outcome = check_file(path, PATHS)
    assert outcome.verdict.cause == "coarse numbers", outcome.verdict
    assert "%.17g" in str(outcome.verdict)
    assert "no number has more than" in outcome.notes[0]
    np.savetxt(path, np.c_[x, 1.01 * np.exp(-x)], format, delimiter=",", header="x,pdf", comments="")
    assert check_file(path, PATHS).verdict.cause == "wrong pdf returned"


@pytest.mark.parametrize(
    ("claimed", "words"),
    [
        (lambda p: np.log(p), "its logarithm is returned"),
        (lambda p: 1 / p, "one over it is returned"),
        (lambda p: 3 * p, "3 times it is returned"),
    ],
)
def test_what_is_returned_in_the_place_of_a_pdf_is_told(tmp_path, claimed, words):
    x = values(2000)
    np.save(tmp_path / "x.npy", np.c_[x, claimed(np.exp(-x))])
    told = str(check_file(tmp_path / "x.npy", {**PATHS, "columns": ["x", "pdf"]}).verdict)
    assert f"everywhere {words}" in told


@pytest.mark.parametrize("off", [1 + 1e-7, 1 + 1e-5])
def test_a_pdf_that_is_hardly_off_is_no_function_of_itself(off):
    verdict = fogproof.check_sampler(
        lambda u: fogproof.Draw(u[:, 0], pdf=np.full(len(u), off)),
        lambda x: np.ones(len(x)),
        fogproof.Interval(0, 1),
        dimensions=1,
        samples=2000,
    )
    assert verdict.cause == "wrong pdf returned"
    assert "everywhere" not in str(verdict)


def test_densities_alone_may_be_off_by_a_factor_or_be_logarithms(tmp_path):
    """The density 1 + x / 2 on the unit interval, and nothing that says so."""
    x = np.random.default_rng(5).random(40_000)
    x = 2 * (np.sqrt(1 + 1.25 * x) - 1)
    spec = {"domain": {"kind": "interval", "a": 0.0, "b": 1.0}, "columns": ["x", "pdf"]}

    def verdict(pdf):
        np.save(tmp_path / "x.npy", np.c_[x, pdf])
        return check_file(tmp_path / "x.npy", spec).verdict

    right = (1 + x / 2) / 1.25
    assert verdict(right).outcome == "not rejected"
    assert (verdict(2 * right).cause, verdict(2 * right).diagnosis[:25]) == (
        "normalisation",
        "the densities are 2 times",
    )
    assert verdict(np.log(right)).cause == "negative pdf"
    assert verdict((0.5 + x) / 1.0).cause == "wrong density or samples"


def test_directions_of_few_digits_lie_beside_the_sphere(tmp_path):
    x = np.random.default_rng(1).normal(size=(4000, 3))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    np.save(tmp_path / "x.npy", np.round(x, 3))
    assert check_file(tmp_path / "x.npy", ISOTROPIC).verdict.cause == "coarse numbers"
    np.save(tmp_path / "x.npy", np.round(1.01 * x, 3))
    assert check_file(tmp_path / "x.npy", ISOTROPIC).verdict.cause == "outside the domain"
    np.save(tmp_path / "x.npy", 1.001 * x)
    assert check_file(tmp_path / "x.npy", ISOTROPIC).verdict.cause == "outside the domain"


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        (b"1.5D-03,2.0D+00", "with e: 1.5e-3"),
        (b"0,5,1,25", "decimal mark is a point"),
        (b"1_000,2", "not grouped"),
        (b"1.#INF,2", "inf, -inf and nan"),
        (b"-nan(ind),2", "inf, -inf and nan"),
        (b"0x1.8p-4,2", "decimal"),
        (b"1.5;2", "separated by commas"),
        (b"1.5\t2", "separated by commas"),
        (b"1.5 2", "separated by commas"),
        (b"[1.5,2]", "without brackets"),
        (b"1.5", "between commas"),
    ],
)
def test_other_habits_of_printing_are_refused_with_the_fix(line, fix):
    with pytest.raises(ValueError, match=f"row 2 is .*{fix}"):
        from_lines([b"1,2", line], 2)


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("# x,pdf\n1.5,2\n", [[1.5, 2]]),
        ('"x","pdf"\r"1.5","2"\r', [[1.5, 2]]),
        ("x;pdf\n1.5;2\n", [[1.5, 2]]),
    ],
)
def test_files_of_other_programs_are_read(tmp_path, text, rows):
    from fogproof.pipe.files import read_rows

    (tmp_path / "x.csv").write_text(text, newline="")
    read, names = read_rows(tmp_path / "x.csv", 0, "float64")
    assert (read.tolist(), names) == (rows, ("x", "pdf"))


def test_a_structured_array_names_its_columns(tmp_path):
    from fogproof.pipe.files import read_rows

    np.save(tmp_path / "x.npy", np.rec.fromarrays([[1.5, 2.5], [1, 2]], names="x,pdf"))
    read, names = read_rows(tmp_path / "x.npy", 0, "float64")
    assert (read.tolist(), names) == ([[1.5, 1], [2.5, 2]], ("x", "pdf"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"x,pdf\n1_000,2\n", "not grouped"),
        (b"x;pdf\n0,5;1,25\n", "decimal mark is a point"),
        ("x,pdf\n1,2\n".encode("utf-16"), "save it as UTF-8"),
        (b'x\n"1\n2"\n', "without brackets or quotes"),
    ],
)
def test_files_that_cannot_be_read_say_why(tmp_path, text, words):
    (tmp_path / "x.csv").write_bytes(text)
    with pytest.raises(FogproofError, match=words):
        check_file(tmp_path / "x.csv", PATHS)


def test_beside_decimal_points_a_comma_is_none(tmp_path):
    """A row with a number too many is no habit of printing."""
    (tmp_path / "x.csv").write_text("x\n0.5\n1,2\n")
    with pytest.raises(FogproofError, match=r"row 2 is '1,2', not 1 numbers$"):
        check_file(tmp_path / "x.csv", PATHS)
    with pytest.raises(ValueError, match=r"row 2 is '1,2', not a number$"):
        from_lines([b"0.5", b"1,2"], 1)
    with pytest.raises(ValueError, match="decimal mark"):
        from_lines([b"0,5", b"1,2"], 1)


def test_what_numpy_says_of_a_file_is_not_cut_in_a_word(tmp_path):
    np.save(tmp_path / "x.npy", values())
    (tmp_path / "x.npy").write_bytes((tmp_path / "x.npy").read_bytes()[:999])
    with pytest.raises(FogproofError, match=r"only read \d+ elements"):
        check_file(tmp_path / "x.npy", PATHS)


def test_the_same_seed_gives_the_same_samples(tmp_path):
    own = {key: PATHS[key] for key in PATHS}
    source = SAMPLER.replace("array, io", "array, io, random").replace("for u in rows", "for u in map(draw, range(n))")
    drawn = source.replace(
        "    x = array", "    rng = random.Random(SEED); draw = lambda _: rng.random()\n    x = array"
    )
    right = judged(program(tmp_path, source=drawn.replace("SEED", 'request["seed"]')), own).verdict
    assert right.outcome == "not rejected", right
    wrong = judged(program(tmp_path, source=drawn.replace("SEED", "")), own).verdict
    assert (wrong.outcome, wrong.cause) == ("rejected", "hidden state"), wrong
    assert "function of its seed" in str(wrong)


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("if answered == 3: out.write(GREETING)", "greets again"),
        (
            "if answered == 3: out.write(b'{\"n\": %d}\\n' % n); out.write(x.tobytes())",
            r"\d+}' and what follows|answered once more|once too often",
        ),
        (
            "if answered == 3: out.write(b'{\"n\": %d}\\n' % n + x.tobytes()); out.flush(); time.sleep(0.05)",
            r"\d+}' and what follows|answered once more|once too often",
        ),
    ],
)
def test_a_second_greeting_and_an_answer_too_early_are_called_so(tmp_path, answer, words):
    verdict = judged(program(tmp_path, answer.replace("GREETING", 'b\'{"fogproof": 1, "columns": ["x"]}\\n\''))).verdict
    assert verdict.cause == "broken protocol", verdict
    assert re.search(words, str(verdict)), str(verdict)


def test_a_member_of_a_family_that_dies_is_said_to_die(tmp_path):
    spec = {**PATHS, "dimensions": 1, "family": {"g": [0.0, 1.0]}}
    verdict = judged(program(tmp_path, "if request['parameters']['g'] == 0: os._exit(7)"), spec).verdict
    assert verdict.cause == "dies"
    assert "ProgramError" not in str(verdict)


class _Holder:
    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return self.array


def uniform(u):
    return u[:, 0]


@pytest.mark.parametrize("hold", [_Holder, memoryview, np.asarray])
def test_single_precision_is_recognised_in_whatever_holds_it(hold):
    with pytest.raises(FogproofError, match='precision="float32"'):
        fogproof.check_sampler(
            lambda u: hold(np.float32(u[:, 0])), lambda x: np.ones(len(x)), fogproof.Interval(0, 1), dimensions=1
        )


def test_a_sampler_may_fill_the_same_buffer_in_every_call():
    buffer = np.empty(1 << 17)

    def sample(u):
        buffer[: len(u)] = u[:, 0]
        return buffer[: len(u)]

    verdict = fogproof.check_sampler(
        sample, lambda x: np.ones(len(x)), fogproof.Interval(0, 1), dimensions=1, samples=20_000
    )
    assert verdict.outcome == "not rejected", verdict


def test_a_mark_is_zero_or_one():
    with pytest.raises(FogproofError, match=r"valid must be 0 or 1, got 0\.5"):
        fogproof.check_sampler(
            lambda u: fogproof.Draw(u[:, 0], valid=np.full(len(u), 0.5)),
            lambda x: np.ones(len(x)),
            fogproof.Interval(0, 1),
            dimensions=1,
        )
