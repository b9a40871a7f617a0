"""The oracle as a process: a bad line costs that line alone, answers stay in order, equal questions become one call."""

import dataclasses
import io
import json
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest
from fuzz_oracle import flat, fuzz

from fogproof import oracle
from fogproof.errors import InvalidValueError
from fogproof.oracle import Limits, answer, answer_text, batches, serve
from fogproof.quantities import quantities

SKY = {"quantity": "plane_parallel_sky", "tau": 0.1, "mu_sun": 0.5, "mu_view": 0.9, "azimuth": 0}
AIRLIGHT = {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf"}
MEAN = {"quantity": "phase_mean_cosine", "phase": {"kind": "rayleigh"}}


def converse(*lines, chunk=1 << 16, end=b"\n", **limits):
    """Send lines, as bytes, text or requests, through the service; return its answers."""
    coded = [x if isinstance(x, bytes) else (x if isinstance(x, str) else json.dumps(x)).encode() for x in lines]
    source, out = io.BytesIO(b"\n".join(coded) + end), io.BytesIO()
    good = serve(lambda n: source.read(min(n, chunk)), out, limits=Limits(**limits))
    answers = [json.loads(line) for line in out.getvalue().splitlines()]
    assert good == all("value" in reply for reply in answers)
    return answers


BAD = {
    "shapes": ({**SKY, "tau": [0.1, 0.3], "mu_sun": [0.5, 0.4, 0.3]}, "invalid-value", "must broadcast"),
    "5000 digits": (json.dumps(AIRLIGHT).replace("0.5", "7" * 5000), "invalid-input", "too many digits"),
    "310 digits": ({**AIRLIGHT, "sigma_t": 10**310}, "invalid-value", "must be a number"),
    "300 levels": (json.dumps(AIRLIGHT).replace("0.5", "[" * 300 + "1" + "]" * 300), "invalid-input", "nested"),
    "990 levels": (json.dumps(AIRLIGHT).replace("0.5", "[" * 990 + "1" + "]" * 990), "invalid-input", "nested"),
    "50000 levels": ("[" * 50_000, "invalid-input", "nested"),
    "30 axes": (json.dumps(AIRLIGHT).replace("0.5", "[" * 30 + "1" + "]" * 30), "invalid-value", "at most 16 axes"),
    "too large": ({**SKY, "tau": [[0.1]] * 3000, "mu_view": [0.5] * 3000}, "too-large", "9000000 numbers"),
    "too large a table": (
        {"quantity": "airlight_table", "sigma_t": 1, "h": [1] * 300, "a": [0] * 300, "b": [1] * 300},
        "too-large",
        "27000000 numbers",
    ),
    "too many orders": ({"quantity": "ball_albedo_orders", "radius": 1, "count": 10**9}, "too-large", "1000000001"),
    "too many channels": (
        {
            "quantity": "coefficients",
            "medium": {"kind": "exponential", "sigma_0": 1, "rate": [0, 0, 1]},
            "x": [0, 0, 1],
            "w": [0, 0, 1],
            "channels": 10**40,
        },
        "too-large",
        f"{10**40} numbers",
    ),
    "NaN": ('{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": NaN}', "invalid-input", "not JSON"),
    "Infinity": ('{"quantity": "sun_colour", "air_mass": Infinity}', "invalid-input", 'string "inf"'),
    "1e999": ('{"quantity": "sun_colour", "air_mass": 1e999}', "invalid-input", "largest float64"),
    "a key twice": ('{"quantity": "sun_colour", "air_mass": 1, "air_mass": 2}', "invalid-input", "twice"),
    "UTF-16": (json.dumps(SKY).encode("utf-16"), "invalid-input", "not UTF-8"),
    "Latin-1": (b'{"quantity": "sky\xe9"}', "invalid-input", "not UTF-8"),
    "NUL": (b'{"quantity": "sky\x00"}', "invalid-input", "not valid JSON"),
    "a lone surrogate": ('{"quantity": "phase_pdf", "phase": {"kind": "\\ud800"}, "mu": 0}', "invalid-input", ""),
    "a long line": (b'{"quantity": "' + b"x" * 100_000 + b'"}', "too-large", "longer than 60000 bytes"),
    "no value": ({"quantity": "airlight_table", "sigma_t": 1, "h": [1], "a": [2], "b": [1]}, "unsupported", "no value"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_line_costs_itself_alone(name):
    line, code, message = BAD[name]
    for bad_first in (True, False):
        answers = converse(*([line, SKY] if bad_first else [SKY, line]), chunk=1000, bytes=60_000)
        bad, good = answers if bad_first else answers[::-1]
        assert bad["error"]["code"] == code, bad
        assert message in bad["error"]["message"]
        assert good["value"] > 0


def test_the_bounds_are_options():
    large = {**SKY, "tau": [0.1] * 11}
    assert converse(large, values=10)[0]["error"]["code"] == "too-large"
    assert len(converse(large, values=11)[0]["value"]) == 11
    with pytest.raises(InvalidValueError, match="values must be a number > 0"):
        Limits(values=0)


def codes(answers):
    """Return the code of each failure, None for an answer."""
    return [None if "value" in reply else reply["error"]["code"] for reply in answers]


def faulty(monkeypatch, function):
    """Put a function in place of that of one quantity."""
    known = quantities()["phase_mean_cosine"]
    broken = {**quantities(), known.name: dataclasses.replace(known, function=function)}
    for module in (oracle.answers, batches):
        monkeypatch.setattr(module, "quantities", lambda: broken)


def test_a_fault_of_ours_costs_one_answer_and_asks_for_a_report(monkeypatch):
    def fault(phase):
        raise ZeroDivisionError("oh")

    faulty(monkeypatch, fault)
    bad, good = converse({**MEAN, "id": 7}, SKY)
    assert (bad["error"]["code"], bad["id"]) == ("internal", 7)
    assert "please report" in bad["error"]["message"]
    assert good["value"] > 0


def test_memory_that_is_not_there_costs_one_answer(monkeypatch):
    faulty(monkeypatch, lambda phase: np.empty(2**50))
    assert codes(converse(MEAN, SKY)) == ["too-large", None]


def test_an_answer_that_takes_too_long_is_given_up(monkeypatch):
    faulty(monkeypatch, lambda phase: time.sleep(60))
    start = time.monotonic()
    assert codes(converse(MEAN, SKY, seconds=0.2)) == ["timeout", None]
    assert time.monotonic() - start < 30


def test_a_value_that_does_not_exist_is_no_answer(monkeypatch):
    faulty(monkeypatch, lambda phase: dataclasses.make_dataclass("Raw", ["value", "error", "method", "source"])(
        np.array([1.0, np.nan]), np.array([0.0, 0.0]), "", ""))  # fmt: skip
    error = converse(MEAN)[0]["error"]
    assert error["code"] == "unsupported"
    assert "at index [1]" in error["message"]


def test_negative_zero_is_zero():
    for request in ({**AIRLIGHT, "sigma_t": -0.0}, {**SKY, "tau": -0.0}):
        plain = {key: 0.0 if value == 0 else value for key, value in request.items()}
        assert converse(request) == converse(plain)
        assert "-0.0" not in json.dumps(converse(request))


def varied(request, rng):
    """Return a request with every float of its example moved a little, so that it stays a valid question."""
    changed = dict(request)
    for path, mark in quantities()[request["quantity"]].arrays.items():
        outer, _, inner = path.partition(".")
        if inner or mark.axes or outer not in changed:
            continue
        old = np.array([float(x) for x in np.ravel(changed[outer])])
        moved = np.where((old == np.round(old)) | ~np.isfinite(old), old, old * rng.uniform(0.9, 1.0))
        listed = [x if np.isfinite(x) else "inf" for x in moved.tolist()]
        changed[outer] = listed if isinstance(changed[outer], list) else listed[0]
    if "ray" in changed:
        changed["ray"] = {**changed["ray"], "origin": rng.uniform(-1, 0, 3).tolist()}
    return changed


def test_answers_together_are_those_alone():
    """Quadrature may look at all of a batch to choose its nodes, so that answers agree within their errors, not to the bit."""
    rng = np.random.default_rng()
    requests = []
    for name, quantity in quantities().items():
        if name == "radiance_by_ode":  # a second each
            continue
        requests += [{**varied({"quantity": name, **quantity.example}, rng), "id": f"{name} {i}"} for i in range(3)]
    rng.shuffle(requests)
    together = converse(*requests)
    assert [reply["id"] for reply in together] == [request["id"] for request in requests]
    for request, reply in zip(requests, together, strict=True):
        alone = answer(request)
        assert np.shape(reply["value"]) == alone["value"].shape, request
        value, error = (np.array([float(x) for x in flat(reply[key])]) for key in ("value", "error"))
        same = value == alone["value"].ravel()
        with np.errstate(invalid="ignore"):
            assert np.all(same | (np.abs(value - alone["value"].ravel()) <= error + alone["error"].ravel())), request
        assert {k: reply[k] for k in ("unit", "convention", "source")} == {
            k: alone[k] for k in ("unit", "convention", "source")
        }


def test_equal_questions_become_one_call(monkeypatch):
    calls = []
    known = quantities()["plane_parallel_sky"]

    def counted(**arguments):
        calls.append(np.shape(arguments["tau"]))
        return known.function(**arguments)

    counting = {**quantities(), known.name: dataclasses.replace(known, function=counted)}
    for module in (oracle.answers, batches):
        monkeypatch.setattr(module, "quantities", lambda: counting)
    answers = converse(*({**SKY, "tau": i / 100, "id": i} for i in range(200)))
    assert calls == [(200,)]
    assert [reply["id"] for reply in answers] == list(range(200))
    calls.clear()
    answers = converse(*({**SKY, "tau": -1 if i == 77 else i / 100} for i in range(200)))
    assert [i for i, code in enumerate(codes(answers)) if code] == [77]
    assert len(calls) < 20


def test_lines_in_pieces_blank_lines_and_a_byte_order_mark():
    text = b"\xef\xbb\xbf" + json.dumps(SKY).encode() + b"\r\n\n   \n" + json.dumps(SKY).encode()
    assert len(converse(text, chunk=7, end=b"")) == 2
    joined = converse(text + b"\n" + text, chunk=1, end=b"")
    assert codes(joined) == [None] * 4
    assert converse(b"", end=b"") == []


def test_a_text_separator_within_a_string_is_no_end_of_line():
    (reply,) = converse('{"quantity": "sun_colour", "air_mass": 1, "id": "\u2028\x85"}')
    assert reply["id"] == "\u2028\x85"


def test_a_single_request_obeys_the_same_rules():
    assert answer_text("[" * 400)["error"]["code"] == "invalid-input"


COMMAND = [sys.executable, "-c", "from fogproof.cli import main; main()", "oracle"]


def test_the_list_says_all_that_is_declared():
    run = subprocess.run([*COMMAND, "--list"], capture_output=True, text=True, check=True)
    listed = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row["quantity"] for row in listed] == list(quantities())
    assert all(row["unit"] and row["convention"] and row["source"] and row["example"] for row in listed)


@pytest.mark.parametrize("indent", [None, 1])
def test_a_file_holds_one_object_or_lines(indent, tmp_path):
    path = tmp_path / "requests.json"
    path.write_text(json.dumps(SKY, indent=indent) + ("\n" + json.dumps(SKY) if indent is None else ""))
    run = subprocess.run([*COMMAND, path], capture_output=True, text=True, check=True)
    assert len(run.stdout.splitlines()) == (1 if indent else 2)


def test_who_stops_reading_ends_the_service(tmp_path):
    path = tmp_path / "requests.jsonl"
    path.write_text((json.dumps(SKY) + "\n") * 5000)
    with subprocess.Popen([*COMMAND, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as oracle_process:
        oracle_process.stdout.readline()
        oracle_process.stdout.close()
        assert oracle_process.wait(timeout=60) == 141
        assert oracle_process.stderr.read() == b""


def test_fuzzed_lines_are_all_answered():
    outcomes = fuzz(600, seed=1, seconds=1.0)
    assert outcomes["internal"] == 0
    assert outcomes["answered"] > 100
    assert outcomes["invalid-input"] > 100


def test_what_overflows_while_it_is_read_is_no_warning():
    """Nothing but answers leaves the service: a rectangle too large for the squares of its edges, a direction too long."""
    scene = {
        "medium": {"sigma_a": 0.1, "sigma_s": 0.1},
        "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 1},
    }
    edges = {"kind": "rectangle", "corner": [1, 1, 1], "edge_u": [1e200, 0, 0], "edge_v": [0, 1e200, 0], "radiance": 1}
    long = {**scene, "ray": {**scene["ray"], "direction": [0, 1e200, 1e200]}}
    requests = [{"quantity": "single_scattering", **scene, "light": edges}, {"quantity": "transmittance", **long}]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "internal" not in codes(converse(*requests))


def test_only_what_json_takes_for_white_space_is_a_blank_line():
    out = io.BytesIO()
    assert serve(io.BytesIO(b" \t\r\n\n").read, out)
    assert out.getvalue() == b""
    assert not serve(io.BytesIO(b"\x0b\n \n\x0c").read, out)
    codes = [json.loads(line)["error"]["code"] for line in out.getvalue().splitlines()]
    assert codes == ["invalid-input", "invalid-input"]
