"""A program over a pipe: right ones pass, wrong ones are named, and whatever one does, it is ended and the verdict says what."""

import os
import sys
import textwrap
import time
from pathlib import Path

import pytest

from fogproof.errors import InvalidInputError
from fogproof.pipe.check import Settings, check_program
from fogproof.pipe.process import Timeouts

QUICK = Timeouts(start=5.0, answer=1.0, end=0.3)
EXPONENTIAL = {
    "dimensions": 1,
    "medium": {"sigma_a": 1.0, "sigma_s": 0.0},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": "inf"},
}
GREETING = b'{"fogproof": 1, "type": "float64", "columns": ["x"]}\n'
# One that is right; SAMPLE and ANSWER are what the wrong ones replace.
SAMPLER = """
import array, io, json, math, os, sys, time
out, given = sys.stdout.buffer, sys.stdin.buffer
out.write(GREETING); out.flush()
answered = 0
while line := given.readline():
    request = json.loads(line)
    n, k = request["n"], request["columns"]
    rows = array.array("d", given.read(8 * n * k))
    answered += 1
    x = array.array("d", [-math.log1p(-u) for u in rows])
    ANSWER
    out.write(b'{"n": %d}\\n' % n); out.write(x.tobytes()); out.flush()
if isinstance(out, io.BytesIO):
    sys.stdout.buffer.write(out.getvalue())
"""


def program(tmp_path: Path, answer: str = "pass", greeting: bytes = GREETING, source: str = SAMPLER) -> list[str]:
    path = tmp_path / "program.py"
    body = textwrap.indent(textwrap.dedent(answer).strip(), "    ").strip()
    path.write_text(source.replace("ANSWER", body).replace("GREETING", repr(greeting)))
    return [sys.executable, "-S", "-E", str(path)]


def judged(command, spec=EXPONENTIAL, samples=20_000, **more):
    return check_program(command, spec, Settings(samples=samples, **more), QUICK)


def test_a_right_program_passes(tmp_path):
    outcome = judged(program(tmp_path))
    assert outcome.verdict.outcome == "not rejected", outcome.verdict
    assert outcome.notes == ()
    assert "--exec" in outcome.verdict.reproduce


HOSTILE = {
    "dies": (
        "if answered == 3: print('no memory left', file=sys.stderr); os._exit(7)",
        "dies",
        "exit code 7",
        "no memory left",
    ),
    "crashes": ("if answered == 2: os.kill(os.getpid(), 11)", "dies", "SIGSEGV"),
    "hangs": ("time.sleep(100)", "hangs", "gave no answer within 1 s"),
    "spins": ("while True: pass", "hangs", "gave no answer within 1 s"),
    "answers short": ("x = x[:-1]", "answers short", "was due", "took its answer for complete"),
    "float32": ("x = array.array('f', x)", "answers short", "exactly half: are they float32?"),
    "keeps its output": ("out = io.BytesIO()", "does not flush", "bytes more once its input had ended"),
    "answers too much": ("x.append(1.0)", "broken protocol", "more than it was asked for"),
    "announces less": ("n -= 1", "broken protocol", "announces"),
    "garbage": ("out.write(os.urandom(64) + b'\\n')", "broken protocol", "the line before its rows"),
    "text in between": ("print('sample', answered, flush=True)", "broken protocol", "'sample 1'"),
    "an error of its own": ('out.write(b\'{"error": "sigma_t is 0"}\\n\')', "reports an error", "says: sigma_t is 0"),
    "big-endian": ("x.byteswap()", "byte order", "writes big-endian"),
    "not a number": ("x = array.array('d', [math.nan] * n)", "not a number", "nan is not a point"),
    "closes its output": ("sys.stdout.flush(); os.close(1); time.sleep(100)", "dies", "closed its output and runs on"),
    "floods": (
        "while True: out.write(b'y' * 65536)",
        "broken protocol",
        "'yyyyy",
    ),
    "half a line": ("out.write(b'{\"n\": '); out.flush(); time.sleep(100)", "hangs", "gave no answer"),
    "deep": ("out.write(b'[' * 50000 + b'\\n')", "broken protocol", "[[["),
}


@pytest.mark.parametrize(
    ("answer", "told"), [("x.byteswap()", "reads and writes big-endian"), ("pass", "reads big-endian")]
)
@pytest.mark.parametrize("odd", ["math.nan", "[][0]"], ids=["goes on", "dies of nonsense"])
def test_who_reads_big_endian_numbers_is_told(tmp_path, answer, told, odd):
    right = "[-math.log1p(-u) for u in rows]"
    careful = f"[-math.log1p(-u) if 0 <= u < 1 else {odd} for u in (rows.byteswap() or rows)]"
    verdict = judged(program(tmp_path, answer, source=SAMPLER.replace(right, careful))).verdict
    if odd == "math.nan":
        assert verdict.cause == "byte order", verdict
        assert told in str(verdict)
    else:
        assert verdict.cause == "dies", verdict


@pytest.mark.parametrize("name", HOSTILE)
def test_what_a_program_does_wrong_is_said(tmp_path, name):
    answer, cause, *words = HOSTILE[name]
    own_end = Timeouts(start=5.0, answer=1.0, end=5.0) if cause in ("answers short", "does not flush") else QUICK
    outcome = check_program(program(tmp_path, answer), EXPONENTIAL, Settings(samples=20_000), own_end)
    assert outcome.verdict.outcome == "rejected"
    assert outcome.verdict.cause == cause, outcome.verdict
    for word in words:
        assert word in str(outcome.verdict)


@pytest.mark.parametrize(("more", "words"), [("goodbye!", "wrote 8 bytes more than it was asked for: 'goodbye!'"),
                                             ('{"n": 3}', "answered once more than it was asked")])  # fmt: skip
def test_what_comes_after_the_last_answer_is_too_much(tmp_path, more, words):
    outcome = judged(program(tmp_path, source=f"{SAMPLER}out.write(b'{more}')\n"))
    assert (outcome.verdict.outcome, outcome.verdict.cause) == ("rejected", "broken protocol")
    assert words in str(outcome.verdict)


GREETINGS = {
    b"": "wrote nothing",
    b"hello\n": "'hello' where its greeting was due",
    b"{}\n": "version None",
    b'{"fogproof": 2, "columns": ["x"]}\n': "version 2",
    b'{"fogproof": 1, "columns": ["pdf"]}\n': "without a column",
    b'{"fogproof": 1, "columns": ["x", "value"]}\n': "column 'value'",
    b'{"fogproof": 2, "fogproof": 1, "columns": ["x"]}\n': "its greeting, in which the key 'fogproof' stands twice",
    b'{"fogproof": 1, "columns": ["x", "x"]}\n': '2 columns "x"',
    b'{"fogproof": 1, "type": "int8", "columns": ["x"]}\n': "'int8'",
    b'{"fogproof": 1, "columns": ["value"]}\n': "the spec describes a sampler",
    b'{"fogproof": 1, "type": "float32", "columns": ["x"]}\n': "float32",
}


@pytest.mark.parametrize("greeting", GREETINGS)
def test_a_wrong_greeting_is_said(tmp_path, greeting):
    answer = "os._exit(0)" if greeting else "pass"
    spec = {**EXPONENTIAL, "precision": "float64"}
    outcome = check_program(program(tmp_path, answer, greeting), spec, Settings(), Timeouts(0.5, 0.5, 0.2))
    assert outcome.verdict.outcome == "rejected"
    assert GREETINGS[greeting] in str(outcome.verdict) or not greeting


def test_a_greeting_without_its_end_is_shown(tmp_path):
    command = program(tmp_path, "pass", GREETING.strip())
    verdict = check_program(command, EXPONENTIAL, Settings(), Timeouts(0.7, 0.5, 5.0)).verdict
    assert verdict.cause == "answers short", verdict
    assert '"columns": ["x"]}\' and no end of line came' in str(verdict)


def test_more_bytes_than_float32_has_are_questioned(tmp_path):
    greeting = b'{"fogproof": 1, "type": "float32", "columns": ["x"]}\n'
    answer = "n = request['n']; x = array.array('d', [0.5] * n)"
    verdict = judged(program(tmp_path, answer, greeting, SAMPLER.replace("8 * n * k", "4 * n * k"))).verdict
    assert "are its numbers float64?" in str(verdict)


def test_a_slow_program_is_not_said_to_keep_its_output(tmp_path):
    """It was still writing when time was up: what it wrote later says nothing of buffers."""
    answer = """
    out.write(b'{"n": %d}\\n' % n)
    for i in range(0, n, n // 40):
        out.write(x[i : i + n // 40].tobytes()); out.flush(); time.sleep(0.1)
    """
    verdict = check_program(program(tmp_path, answer), EXPONENTIAL, Settings(), Timeouts(5.0, 1.5, 0.3)).verdict
    assert verdict.cause == "hangs", verdict


def test_points_outside_the_domain_leave_nothing_to_be_asked(tmp_path):
    """Densities at no points are none, whatever shape a point has."""
    source = SAMPLER.replace(
        "[-math.log1p(-u) for u in rows]", "[2.0] * (3 if request['request'] == 'sample' else 1) * n"
    )
    greeting = b'{"fogproof": 1, "columns": ["x", "x", "x"], "answers": ["pdf"]}\n'
    verdict = judged(program(tmp_path, "pass", greeting, source), {"domain": "sphere", "dimensions": 2}).verdict
    assert verdict.cause == "outside the domain", verdict


def test_stderr_is_kept_at_both_ends_and_never_blocks(tmp_path):
    said = "first = answered == 1 and print('begin' + 'x' * 300_000 + 'end', file=sys.stderr)"
    outcome = judged(program(tmp_path, said))
    assert outcome.verdict.outcome == "not rejected"
    assert outcome.said.startswith("beginxxx")
    assert outcome.said.endswith("xxxend")
    assert len(outcome.said) < 5000


def test_a_program_that_ignores_the_end_of_its_input_is_killed_and_told_of(tmp_path):
    path = program(tmp_path)
    with open(path[-1], "a") as file:
        file.write("\ntime.sleep(1000)\n")
    started = time.monotonic()
    outcome = judged(path)
    assert outcome.verdict.outcome == "not rejected"
    assert "did not end within 0.3 s" in outcome.notes[0]
    assert time.monotonic() - started < 60


def test_a_program_that_ends_in_failure_does_not_pass(tmp_path):
    path = program(tmp_path)
    with open(path[-1], "a") as file:
        file.write("\nsys.exit('checksum is wrong')\n")
    verdict = judged(path).verdict
    assert verdict.outcome == "inconclusive"
    told = verdict.findings[-1].message
    assert "exit code 1" in told
    assert "checksum is wrong" in told


def test_a_verdict_that_says_it_has_no_note(tmp_path):
    assert judged(program(tmp_path, "os._exit(3)")).notes == ()


@pytest.mark.parametrize("leaving", ["", "os.setsid()"])
def test_children_end_with_their_program(tmp_path, leaving):
    """Those that stay in its group, and those that left it."""
    child = f"""
    if answered == 1 and os.fork() == 0:
        {leaving or "pass"}
        open({str(tmp_path / "child")!r}, "w").write(str(os.getpid()))
        time.sleep(1000)
    """
    outcome = judged(program(tmp_path, child))
    assert outcome.verdict.outcome == "not rejected", outcome.verdict
    pid = int((tmp_path / "child").read_text())
    deadline = time.monotonic() + 5
    while alive(pid) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not alive(pid)


def alive(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_a_program_in_text(tmp_path):
    """CSV, as long as somebody only tries."""
    source = """
    import sys, math, json
    print('{"fogproof": 1, "type": "text", "columns": ["x", "pdf"], "answers": ["pdf"]}', flush=True)
    while line := sys.stdin.readline():
        request = json.loads(line)
        print('{"n": %d}' % request["n"])
        for _ in range(request["n"]):
            value = float(sys.stdin.readline())
            t = value if request["request"] == "pdf" else -math.log1p(-value)
            p = math.exp(-t)
            print(p if request["request"] == "pdf" else f"{t!r},{p!r}")
        sys.stdout.flush()
    """
    outcome = judged(program(tmp_path, source=textwrap.dedent(source)))
    assert outcome.verdict.outcome == "not rejected", outcome.verdict
    assert "pdf against the reference" in str(outcome.verdict)
    wrong = textwrap.dedent(source).replace(",{p!r}", "")
    verdict = judged(program(tmp_path, source=wrong)).verdict
    assert "not 2 numbers between commas" in str(verdict)


def test_an_estimator_that_draws_its_own_numbers(tmp_path):
    answer = """
    import random
    rng = random.Random(request["seed"])
    mean = request["parameters"]["mean"]
    x = array.array("d", [mean + rng.random() - 0.5 for _ in range(n)])
    """
    greeting = b'{"fogproof": 1, "type": "float64", "columns": ["value"]}\n'
    command = program(tmp_path, answer, greeting)
    spec = {"reference": "$mean", "parameters": {"mean": 2.0}}
    assert judged(command, spec).verdict.outcome == "not rejected"
    assert judged(command, {**spec, "reference": 2.01}, 100_000).verdict.outcome == "rejected"
    slab = {"quantity": "slab_reflectance", "albedo": 0.0, "tau": 1.0, "mu0": 0.5}
    assert judged(command, {"quantity": slab, "parameters": {"mean": 0.3}}).verdict.outcome == "rejected"


def test_a_family_is_searched_over_one_pipe(tmp_path):
    """Wrong below sigma = 0.5, and it dies at 8: both are found, the simplest first."""
    answer = """
    sigma = request["parameters"]["sigma"]
    if sigma == 8: os._exit(3)
    x = array.array("d", [t / max(sigma, 0.5) for t in x])
    """
    command = program(tmp_path, answer)
    spec = {**EXPONENTIAL, "medium": {"sigma_a": "$sigma", "sigma_s": 0}}
    right = judged(command, {**spec, "family": {"sigma": [1, 2, 4]}}, 60_000).verdict
    assert right.outcome == "not rejected", right
    wrong = judged(command, {**spec, "family": {"sigma": [1, 0.25, 0.125]}}, 300_000).verdict
    assert "wrong at {'sigma': 0.25}" in str(wrong)
    dies = judged(command, {**spec, "family": {"sigma": [1, 8, 2]}}, 60_000).verdict
    assert "{'sigma': 8.0}" in str(dies)
    assert "exit code 3" in str(dies)


def test_random_bytes_are_never_an_accident(tmp_path):
    """Whatever a program writes, the end is a verdict with a sentence."""
    source = """
    import os, random, sys
    rng = random.Random(int(sys.argv[1]))
    kind = rng.choice([b"float64", b"text", b"float32"])
    parts = [b'{"fogproof": 1, "type": "%s", "columns": ["x"]}\\n' % kind, b'{"n": 16384}\\n',
             rng.randbytes(rng.randrange(400_000)), b"1.0\\n" * 16384, b"{", b"null\\n", b"\\n"]
    count = rng.randrange(6)
    written = b"".join(rng.choice(parts) for _ in range(count))
    if rng.random() < 0.7:
        written = parts[0] + written
    os.write(1, written[:65536]); os.write(1, written[65536:])
    if rng.random() < 0.5:
        sys.stdin.read()
    """
    command = program(tmp_path, source=textwrap.dedent(source))
    seed = int.from_bytes(os.urandom(4))
    for trial in range(12):
        verdict = check_program([*command, str(seed + trial)], EXPONENTIAL, Settings(), Timeouts(5, 0.3, 0.1)).verdict
        assert verdict.outcome == "rejected", seed + trial
        assert "the program" in str(verdict)


@pytest.mark.parametrize(("key", "value"), [("columns", ["x"]), ("type", "float32")])
def test_what_a_greeting_says_is_no_key_of_a_programs_spec(tmp_path, key, value):
    with pytest.raises(InvalidInputError, match=f"{key} is of files"):
        judged(program(tmp_path), {**EXPONENTIAL, key: value})
